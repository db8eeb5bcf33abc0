// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace morsel::test {

// Puts together small glTF files: accessors are added with their data, the rest is JSON.
class GltfFile {
 public:
  static constexpr int kByte = 5121, kShort = 5123, kInt = 5125, kFloat = 5126;

  GltfFile() {
    json["asset"]["version"] = "2.0";
    json["scenes"] = {{{"nodes", {0}}}};
    json["nodes"] = {{{"mesh", 0}}};
  }

  template <class T>
  int add_accessor(const std::vector<T>& values, int component_type, const char* type,
                   std::size_t components) {
    while (data_.size() % 4 != 0) data_ += '\0';
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", values.size() * sizeof(T)}});
    data_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component_type},
                                 {"type", type},
                                 {"count", values.size() / components}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  // A unit square of four vertices in the plane z = 0, as the file's only mesh.
  template <class Index = std::uint16_t>
  void add_square(int index_type = kShort) {
    const int position =
        add_accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, kFloat, "VEC3", 3);
    const int indices = add_accessor<Index>({0, 1, 2, 0, 2, 3}, index_type, "SCALAR", 1);
    json["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}}}}}};
  }

  nlohmann::json& primitive() { return json["meshes"][0]["primitives"][0]; }

  std::filesystem::path write_gltf(const TemporaryFolder& folder) {
    folder.write("mesh.bin", data_);
    json["buffers"] = {{{"uri", "mesh.bin"}, {"byteLength", data_.size()}}};
    return folder.write("mesh.gltf", json.dump());
  }

  std::filesystem::path write_glb(const TemporaryFolder& folder) {
    json["buffers"] = {{{"byteLength", data_.size()}}};
    std::string text = json.dump();
    while (text.size() % 4 != 0) text += ' ';
    std::string data = data_;
    while (data.size() % 4 != 0) data += '\0';
    std::string file = "glTF";
    append(file, 2);
    append(file, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + data.size()));
    append(file, static_cast<std::uint32_t>(text.size()));
    file += "JSON" + text;
    append(file, static_cast<std::uint32_t>(data.size()));
    file += std::string("BIN\0", 4) + data;
    return folder.write("mesh.glb", file);
  }

  nlohmann::json json;

 private:
  static void append(std::string& to, std::uint32_t value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  std::string data_;
};

}  // namespace morsel::test
