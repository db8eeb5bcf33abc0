// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/obj_groups.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "renderer/mesh/normals.h"
#include "renderer/mesh/obj_lines.h"

namespace morsel::render {
namespace {

// The file with normals that stand for groups.
class Rewriter {
 public:
  explicit Rewriter(std::int64_t normals) : normals_(normals) {}

  std::string rewrite(const std::filesystem::path& file) {
    std::ifstream in(file);
    for_each_obj_line(in, [&](std::size_t, std::string_view line) { add(line); });
    for (std::uint32_t group = 0; group < groups_; ++group) {
      const Imath::V3f n = group_normal(group);
      fmt::format_to(std::back_inserter(text_), "vn {:g} {:g} {:g}\n", n.x, n.y, n.z);
    }
    return std::move(text_);
  }

 private:
  void add(std::string_view line) {
    std::string_view rest = line;
    const std::string_view key = next_word(rest);
    if (key == "s") {
      const std::string_view name = next_word(rest);
      smooth_ = !(name.empty() || name == "off" || name == "0");
      if (smooth_) {
        const auto [known, is_new] = numbers_.try_emplace(std::string(name), groups_);
        if (is_new) ++groups_;
        group_ = known->second;
      }
      return;
    }
    std::string_view corner = next_word(rest);
    if (key != "f" || obj_corner_has_normal(corner)) {
      text_.append(line) += '\n';
      return;
    }
    if (!smooth_) group_ = groups_++;
    text_ += 'f';
    for (; !corner.empty(); corner = next_word(rest)) {
      // "vertex" or "vertex/texture", perhaps with slashes after it.
      const std::string_view vertex = corner.substr(0, corner.find('/'));
      std::string_view texture = corner.substr(std::min(vertex.size() + 1, corner.size()));
      texture = texture.substr(0, texture.find('/'));
      fmt::format_to(std::back_inserter(text_), " {}/{}/{}", vertex, texture,
                     normals_ + 1 + std::int64_t{group_});
    }
    text_ += '\n';
  }

  std::int64_t normals_;  // of the file's own
  std::string text_;
  std::map<std::string, std::uint32_t> numbers_;
  std::uint32_t groups_ = 0, group_ = 0;
  bool smooth_ = false;
};

// One file has another content; assimp finds the others, as libraries of materials, where they are.
class Replaced final : public Assimp::DefaultIOSystem {
 public:
  Replaced(std::string file, std::string content)
      : file_(std::move(file)), content_(std::move(content)) {}

  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (file != file_) return DefaultIOSystem::Open(file, mode);
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(content_.data()),
                                      content_.size());
  }

 private:
  std::string file_, content_;
};

}  // namespace

std::unique_ptr<Assimp::IOSystem> read_groups_as_normals(const std::filesystem::path& file,
                                                         const ObjNames& names) {
  return std::make_unique<Replaced>(file.string(), Rewriter(names.normals).rewrite(file));
}

}  // namespace morsel::render
