// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/obj_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include "renderer/mesh/mesh_file.h"

namespace morsel::render {
namespace {

constexpr std::string_view kBlank = " \t\r";

// The next word of `rest`, which it is taken off; empty at the end.
std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return rest = {};
  const std::size_t end = std::min(rest.find_first_of(kBlank, begin), rest.size());
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

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

}  // namespace

void check_obj_numbers(const std::filesystem::path& file) {
  std::ifstream in(file);
  bool continues = false;  // the line before ended in a backslash and held numbers
  std::string text;
  for (std::size_t number = 1; std::getline(in, text); ++number) {
    std::string_view rest = text;
    if (const std::size_t comment = rest.find('#'); comment != std::string_view::npos)
      rest = rest.substr(0, comment);
    if (!continues) {
      const std::string_view key = next_word(rest);
      if (key != "v" && key != "vn" && key != "vt") continue;
    }
    continues = false;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      if (word == "\\") {
        continues = true;
      } else if (!is_finite_number(word)) {
        throw MeshError(
            fmt::format("{}: line {}: \"{}\" is not a finite number", file.string(), number, word));
      }
    }
  }
}

}  // namespace morsel::render
