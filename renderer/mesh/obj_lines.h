// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <istream>
#include <string>
#include <string_view>

// The lines of OBJ files.
namespace morsel::render {

inline constexpr std::string_view kObjBlank = " \t\r";

// The next word of `rest`, which it is taken off; empty at the end.
inline std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(kObjBlank);
  if (begin == std::string_view::npos) return rest = {};
  const std::size_t end = std::min(rest.find_first_of(kObjBlank, begin), rest.size());
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

// "vertex//normal" or "vertex/texture/normal".
inline bool obj_corner_has_normal(std::string_view corner) {
  const std::size_t first = corner.find('/');
  if (first == std::string_view::npos) return false;
  const std::size_t second = corner.find('/', first + 1);
  return second != std::string_view::npos && second + 1 < corner.size();
}

// Calls use(number of the first line, text) without comments, with lines that go on in the next put
// together.
template <class Use>
void for_each_obj_line(std::istream& in, Use&& use) {
  std::string text, joined;
  std::size_t first = 1;
  for (std::size_t number = 1; std::getline(in, text); ++number) {
    if (joined.empty()) first = number;
    if (const std::size_t comment = text.find('#'); comment != std::string::npos)
      text.erase(comment);
    while (!text.empty() && kObjBlank.find(text.back()) != std::string_view::npos) text.pop_back();
    if (!text.empty() && text.back() == '\\') {
      text.back() = ' ';
      joined += text;
      continue;
    }
    joined += text;
    use(first, std::string_view(joined));
    joined.clear();
  }
  if (!joined.empty()) use(first, std::string_view(joined));
}

}  // namespace morsel::render
