// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/gltf_accessor.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>

namespace morsel::render {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

// The bytes of an accessor: element i begins at data + i * stride.
struct View {
  const unsigned char* data = nullptr;
  std::size_t stride = 0;
  std::size_t count = 0;
  int component_type = 0;
};

std::size_t component_size(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

template <class T>
const T& element(const std::vector<T>& all, int index, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= all.size())
    throw GltfError(fmt::format("{} {} does not exist; there are {}", what, index, all.size()));
  return all[static_cast<std::size_t>(index)];
}

View view_of(const tinygltf::Model& model, int index, int type, std::size_t components,
             const char* kind) {
  const tinygltf::Accessor& accessor = element(model.accessors, index, "accessor");
  if (accessor.sparse.isSparse)
    throw GltfError(fmt::format("accessor {} is sparse, which is not supported", index));
  if (accessor.type != type) throw GltfError(fmt::format("accessor {} must be {}", index, kind));
  const std::size_t size = component_size(accessor.componentType);
  if (size == 0)
    throw GltfError(fmt::format("accessor {} has component type {}, which {} cannot have", index,
                                accessor.componentType, kind));
  const tinygltf::BufferView& view = element(model.bufferViews, accessor.bufferView, "bufferView");
  const tinygltf::Buffer& buffer = element(model.buffers, view.buffer, "buffer");

  const std::size_t element_size = size * components;
  const std::size_t stride = view.byteStride != 0 ? view.byteStride : element_size;
  if (stride < element_size)
    throw GltfError(fmt::format("bufferView {} has a stride of {} bytes for elements of {}",
                                accessor.bufferView, stride, element_size));
  // Subtractions only, so that no sum of hostile numbers can wrap around.
  const std::size_t available = buffer.data.size();
  const bool view_fits =
      view.byteOffset <= available && view.byteLength <= available - view.byteOffset;
  const bool offset_fits = accessor.byteOffset <= view.byteLength;
  const std::size_t bytes = offset_fits ? view.byteLength - accessor.byteOffset : 0;
  const std::size_t room = bytes < element_size ? 0 : (bytes - element_size) / stride + 1;
  if (!view_fits || !offset_fits || accessor.count > room)
    throw GltfError(fmt::format("accessor {} reaches beyond its buffer", index));

  View result;
  result.data = buffer.data.data() + view.byteOffset + accessor.byteOffset;
  result.stride = stride;
  result.count = accessor.count;
  result.component_type = accessor.componentType;
  return result;
}

template <class T>
T load(const unsigned char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

}  // namespace

std::vector<Imath::V3f> read_vectors3(const tinygltf::Model& model, int accessor) {
  const View view = view_of(model, accessor, TINYGLTF_TYPE_VEC3, 3, "a vector of 3 floats");
  if (view.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT)
    throw GltfError(fmt::format("accessor {} must be a vector of 3 floats", accessor));
  std::vector<Imath::V3f> values(view.count);
  for (std::size_t i = 0; i < view.count; ++i)
    for (int c = 0; c < 3; ++c) values[i][c] = load<float>(view.data + i * view.stride + 4 * c);
  return values;
}

std::vector<Imath::V2f> read_vectors2(const tinygltf::Model& model, int accessor) {
  const View view = view_of(model, accessor, TINYGLTF_TYPE_VEC2, 2, "a vector of 2 numbers");
  std::vector<Imath::V2f> values(view.count);
  for (std::size_t i = 0; i < view.count; ++i) {
    const unsigned char* at = view.data + i * view.stride;
    for (int c = 0; c < 2; ++c) {
      switch (view.component_type) {
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
          values[i][c] = load<float>(at + 4 * c);
          break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
          values[i][c] = static_cast<float>(at[c]) / 255.0f;
          break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
          values[i][c] = static_cast<float>(load<std::uint16_t>(at + 2 * c)) / 65535.0f;
          break;
        default:
          throw GltfError(fmt::format("accessor {} has 32-bit texture coordinates", accessor));
      }
    }
  }
  return values;
}

std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int accessor) {
  const View view = view_of(model, accessor, TINYGLTF_TYPE_SCALAR, 1, "a scalar");
  std::vector<std::uint32_t> values(view.count);
  for (std::size_t i = 0; i < view.count; ++i) {
    const unsigned char* at = view.data + i * view.stride;
    switch (view.component_type) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        values[i] = *at;
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        values[i] = load<std::uint16_t>(at);
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        values[i] = load<std::uint32_t>(at);
        break;
      default:
        throw GltfError(
            fmt::format("accessor {} has indices that are not unsigned integers", accessor));
    }
  }
  return values;
}

}  // namespace morsel::render
