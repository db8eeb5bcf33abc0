// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/gltf_accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <utility>

namespace morsel::render {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

// Elements that an accessor may have without any bytes behind them (zeros, but for sparse ones).
constexpr std::size_t kMostZeros = std::size_t{1} << 26;

// What an accessor may hold: its type and the components of an element.
struct Kind {
  int type;
  std::size_t components;
  const char* name;
};
constexpr Kind kVectors3{TINYGLTF_TYPE_VEC3, 3, "a vector of 3 numbers"};
constexpr Kind kVectors4{TINYGLTF_TYPE_VEC4, 4, "a vector of 4 numbers"};
constexpr Kind kVectors2{TINYGLTF_TYPE_VEC2, 2, "a vector of 2 numbers"};
constexpr Kind kScalars{TINYGLTF_TYPE_SCALAR, 1, "a scalar"};

// Element i begins at data + i * stride.
struct View {
  const unsigned char* data = nullptr;
  std::size_t stride = 0;
};

std::size_t component_size(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
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

// `count` elements of `element_size` bytes in a bufferView. `what` names them in messages.
View view_of(const tinygltf::Model& model, int buffer_view, std::size_t offset, std::size_t count,
             std::size_t element_size, bool may_stride, const std::string& what) {
  const tinygltf::BufferView& view = element(model.bufferViews, buffer_view, "bufferView");
  const tinygltf::Buffer& buffer = element(model.buffers, view.buffer, "buffer");
  const std::size_t stride = may_stride && view.byteStride != 0 ? view.byteStride : element_size;
  if (stride < element_size)
    throw GltfError(fmt::format("bufferView {} has a stride of {} bytes for elements of {}",
                                buffer_view, stride, element_size));
  // Subtractions only, so that no sum of hostile numbers can wrap around.
  const std::size_t available = buffer.data.size();
  if (view.byteOffset > available || view.byteLength > available - view.byteOffset)
    throw GltfError(
        fmt::format("{} reaches beyond its buffer: bufferView {} has {} bytes from byte {} on, "
                    "buffer {} has {}",
                    what, buffer_view, view.byteLength, view.byteOffset, view.buffer, available));
  const std::size_t bytes = offset <= view.byteLength ? view.byteLength - offset : 0;
  const std::size_t room = bytes < element_size ? 0 : (bytes - element_size) / stride + 1;
  if (count > room)
    throw GltfError(
        fmt::format("{} reaches beyond its buffer: {} elements of {} bytes, but bufferView {} has "
                    "room for {} from byte {} on",
                    what, count, element_size, buffer_view, room, offset));
  return {buffer.data.data() + view.byteOffset + offset, stride};
}

template <class T>
T load(const unsigned char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

// A component as a number; of `normalized` integers a share of their range.
double component(const unsigned char* at, int type, bool normalized) {
  const auto scaled = [&](double value, double range) {
    return normalized ? std::max(value / range, -1.0) : value;
  };
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return scaled(load<std::int8_t>(at), 127.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return scaled(*at, 255.0);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return scaled(load<std::int16_t>(at), 32767.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return scaled(load<std::uint16_t>(at), 65535.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<std::uint32_t>(at);
    default:
      return double{load<float>(at)};
  }
}

// Where sparse values go; checked to be in range and in order.
std::vector<std::size_t> sparse_places(const tinygltf::Model& model, int index,
                                       const tinygltf::Accessor& accessor) {
  const auto& from = accessor.sparse.indices;
  const std::size_t size = component_size(from.componentType);
  if (from.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      from.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      from.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    throw GltfError(fmt::format("accessor {} has sparse indices of component type {}", index,
                                from.componentType));
  // Signed in some versions of tinygltf and unsigned in others.
  const auto negative = [](auto value) { return std::cmp_less(value, 0); };
  if (negative(accessor.sparse.count) || negative(from.byteOffset) ||
      negative(accessor.sparse.values.byteOffset))
    throw GltfError(fmt::format("accessor {}: a sparse count or offset is negative", index));
  const auto count = static_cast<std::size_t>(accessor.sparse.count);
  const View view = view_of(model, from.bufferView, static_cast<std::size_t>(from.byteOffset),
                            count, size, false, fmt::format("accessor {}, sparse indices,", index));
  std::vector<std::size_t> places(count);
  for (std::size_t i = 0; i < count; ++i) {
    places[i] =
        static_cast<std::size_t>(component(view.data + i * view.stride, from.componentType, false));
    if (places[i] >= accessor.count || (i > 0 && places[i] <= places[i - 1]))
      throw GltfError(
          fmt::format("accessor {}: sparse index {} is {}; they must increase and be below {}",
                      index, i, places[i], accessor.count));
  }
  return places;
}

// All components of all elements, one after the other.
std::vector<double> read_numbers(const tinygltf::Model& model, int index, const Kind& kind,
                                 bool always_normalized = false) {
  const tinygltf::Accessor& accessor = element(model.accessors, index, "accessor");
  if (accessor.type != kind.type)
    throw GltfError(fmt::format("accessor {} must be {}", index, kind.name));
  const std::size_t size = component_size(accessor.componentType);
  if (size == 0)
    throw GltfError(fmt::format("accessor {} has component type {}, which {} cannot have", index,
                                accessor.componentType, kind.name));
  const bool normalized = accessor.normalized || always_normalized;
  std::vector<double> values;
  const auto copy = [&](const View& view, std::size_t from, std::size_t to) {
    for (std::size_t c = 0; c < kind.components; ++c)
      values[to * kind.components + c] =
          component(view.data + from * view.stride + c * size, accessor.componentType, normalized);
  };
  if (accessor.bufferView >= 0) {
    const View view = view_of(model, accessor.bufferView, accessor.byteOffset, accessor.count,
                              size * kind.components, true, fmt::format("accessor {}", index));
    values.resize(accessor.count * kind.components);
    for (std::size_t i = 0; i < accessor.count; ++i) copy(view, i, i);
  } else {
    if (accessor.count > kMostZeros)
      throw GltfError(fmt::format("accessor {} has {} elements and no bufferView; at most {}",
                                  index, accessor.count, kMostZeros));
    values.resize(accessor.count * kind.components);
  }
  if (accessor.sparse.isSparse) {
    const std::vector<std::size_t> places = sparse_places(model, index, accessor);
    const View view =
        view_of(model, accessor.sparse.values.bufferView,
                static_cast<std::size_t>(accessor.sparse.values.byteOffset), places.size(),
                size * kind.components, false, fmt::format("accessor {}, sparse values,", index));
    for (std::size_t i = 0; i < places.size(); ++i) copy(view, i, places[i]);
  }
  return values;
}

template <class Vector>
std::vector<Vector> as_vectors(const std::vector<double>& numbers, std::size_t components) {
  std::vector<Vector> vectors(numbers.size() / components);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    for (unsigned c = 0; c < Vector::dimensions(); ++c)
      vectors[i][static_cast<int>(c)] = static_cast<float>(numbers[i * components + c]);
  return vectors;
}

}  // namespace

std::vector<Imath::V3f> read_vectors3(const tinygltf::Model& model, int accessor) {
  return as_vectors<Imath::V3f>(read_numbers(model, accessor, kVectors3), 3);
}

std::vector<Imath::V2f> read_vectors2(const tinygltf::Model& model, int accessor) {
  // Integers are shares here; only KHR_mesh_quantization, which says so itself, has others.
  const bool shares = std::find(model.extensionsUsed.begin(), model.extensionsUsed.end(),
                                "KHR_mesh_quantization") == model.extensionsUsed.end();
  return as_vectors<Imath::V2f>(read_numbers(model, accessor, kVectors2, shares), 2);
}

std::vector<Imath::V3f> read_colors(const tinygltf::Model& model, int accessor,
                                    std::vector<float>& alphas) {
  const bool alpha = element(model.accessors, accessor, "accessor").type == TINYGLTF_TYPE_VEC4;
  const Kind& kind = alpha ? kVectors4 : kVectors3;
  const std::vector<double> numbers = read_numbers(model, accessor, kind, true);
  if (alpha)
    for (std::size_t i = 3; i < numbers.size(); i += 4)
      alphas.push_back(static_cast<float>(numbers[i]));
  return as_vectors<Imath::V3f>(numbers, kind.components);
}

std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int accessor) {
  const int type = element(model.accessors, accessor, "accessor").componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    throw GltfError(
        fmt::format("accessor {} has indices that are not unsigned integers", accessor));
  const std::vector<double> numbers = read_numbers(model, accessor, kScalars);
  std::vector<std::uint32_t> indices(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    indices[i] = static_cast<std::uint32_t>(numbers[i]);
  return indices;
}

}  // namespace morsel::render
