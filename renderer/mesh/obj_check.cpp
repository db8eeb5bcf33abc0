// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/obj_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>
#include <system_error>

#include "renderer/mesh/mesh_file.h"
#include "renderer/mesh/obj_lines.h"

namespace morsel::render {
namespace {

bool is_finite_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);  // from_chars knows no plus sign
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return false;
  // Out of range may be too small, which is as good as zero: then there is a negative exponent.
  if (error == std::errc::result_out_of_range) {
    const std::size_t exponent = word.find_first_of("eE");
    return exponent != std::string_view::npos && word.substr(exponent + 1, 1) == "-";
  }
  return error == std::errc() && std::isfinite(value);
}

class Checker {
 public:
  explicit Checker(const std::filesystem::path& file) : file_(file) {}

  ObjNames check() {
    std::ifstream in(file_);
    for_each_obj_line(in, [&](std::size_t number, std::string_view line) {
      line_ = number;
      check_line(line);
    });
    names_.normals = kinds_[2].count;
    names_.smoothing_groups = groups_ && facets_without_normals_;
    return std::move(names_);
  }

 private:
  struct Kind {
    const char* name;
    std::int64_t count = 0;
  };

  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    throw MeshError(fmt::format("{}: line {}: {}", file_.string(), line, what));
  }

  void check_line(std::string_view rest) {
    const std::string_view key = next_word(rest);
    if (key == "v") {
      check_numbers(rest, key, 3);
      ++kinds_[0].count;
    } else if (key == "vt") {
      check_numbers(rest, key, 1);
      ++kinds_[1].count;
    } else if (key == "vn") {
      check_numbers(rest, key, 3);
      ++kinds_[2].count;
    } else if (key == "f" || key == "l" || key == "p") {
      std::string_view word = next_word(rest);
      if (word.empty()) fail(line_, fmt::format("{} names no vertex", key));
      if (key == "f" && !obj_corner_has_normal(word)) facets_without_normals_ = true;
      for (; !word.empty(); word = next_word(rest)) check_corner(word);
    } else if (key == "s") {
      groups_ = true;
    } else if (key == "mtllib") {
      note(rest, names_.libraries);
    } else if (key == "usemtl") {
      note(rest, names_.materials);
    }
  }

  void check_numbers(std::string_view rest, std::string_view key, int least) const {
    int count = 0;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++count)
      if (!is_finite_number(word)) fail(line_, fmt::format("\"{}\" is not a finite number", word));
    if (count < least)
      fail(line_, fmt::format("{} has {} numbers, but needs {}", key, count, least));
  }

  // "vertex", "vertex/texture", "vertex//normal" or "vertex/texture/normal".
  void check_corner(std::string_view corner) {
    std::string_view rest = corner;
    for (const Kind& kind : kinds_) {
      const std::string_view word = rest.substr(0, rest.find('/'));
      if (!word.empty() || &kind == kinds_) check_index(word, corner, kind);
      if (word.size() == rest.size()) return;
      rest.remove_prefix(word.size() + 1);
    }
    fail(line_, fmt::format("\"{}\" has too many slashes", corner));
  }

  void check_index(std::string_view word, std::string_view corner, const Kind& kind) const {
    std::int64_t index = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
    if (error != std::errc() || end != word.data() + word.size())
      fail(line_, fmt::format("\"{}\" is not a corner: vertex/texture/normal", corner));
    if (index == 0) fail(line_, fmt::format("\"{}\": indices count from 1", corner));
    if (index < -kind.count || index > kind.count)  // negative ones count backwards from here
      fail(line_, fmt::format("there is no {} {}; the file has {} before this line", kind.name,
                              index, kind.count));
  }

  static void note(std::string_view rest, std::vector<std::string>& names) {
    const std::size_t begin = rest.find_first_not_of(kObjBlank);
    if (begin == std::string_view::npos) return;
    const std::string name(rest.substr(begin, rest.find_last_not_of(kObjBlank) + 1 - begin));
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }

  const std::filesystem::path& file_;
  std::size_t line_ = 0;
  bool groups_ = false, facets_without_normals_ = false;
  Kind kinds_[3] = {{.name = "vertex"}, {.name = "texture coordinate"}, {.name = "normal"}};
  ObjNames names_;
};

}  // namespace

ObjNames check_obj(const std::filesystem::path& file) { return Checker(file).check(); }

}  // namespace morsel::render
