// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/ply_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/mesh/mesh_file.h"

namespace morsel::render {
namespace {

// Types by the two names that each goes by.
struct Type {
  std::string_view name, other_name;
  std::size_t bytes;
  bool is_integer, is_signed;
};
constexpr Type kTypes[] = {
    {"char", "int8", 1, true, true},      {"uchar", "uint8", 1, true, false},
    {"short", "int16", 2, true, true},    {"ushort", "uint16", 2, true, false},
    {"int", "int32", 4, true, true},      {"uint", "uint32", 4, true, false},
    {"float", "float32", 4, false, true}, {"double", "float64", 8, false, true}};

struct Property {
  std::string name;
  const Type* type = nullptr;
  const Type* count = nullptr;  // of a list
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
enum class Format { kText, kLittle, kBig };

constexpr std::uint64_t kMost = 0x7fffffff;  // elements, and entries of a list
constexpr std::string_view kBlank = " \t\r\v\f";

std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return rest = {};
  const std::size_t end = std::min(rest.find_first_of(kBlank, begin), rest.size());
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

class Checker {
 public:
  explicit Checker(const std::filesystem::path& file) : file_(file.string()) {
    std::ifstream in(file, std::ios::binary);
    text_.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    rest_ = text_;
  }

  void check() {
    if (next_line() != "ply") fail_line("a PLY file begins with \"ply\"");
    bool has_format = false;
    for (std::string_view line = next_line(); line != "end_header"; line = next_line()) {
      const std::string_view key = next_word(line);
      if (key == "format") {
        read_format(line);
        has_format = true;
      } else if (key == "element") {
        read_element(line);
      } else if (key == "property") {
        read_property(line);
      } else if (!key.empty() && key != "comment" && key != "obj_info") {
        fail_line(
            fmt::format("\"{}\" is none of format, element, property, comment, end_header", key));
      }
    }
    if (!has_format) fail_line("the header has no format");
    check_vertices();
    for (const Element& element : elements_) read_values(element);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw MeshError(file_ + ": " + what); }
  [[noreturn]] void fail_line(const std::string& what) const {
    fail(fmt::format("line {}: {}", line_, what));
  }

  // Without what ends it.
  std::string_view next_line() {
    ++line_;
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) fail_line("the file ends within its header");
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    while (!line.empty() && kBlank.find(line.back()) != std::string_view::npos)
      line.remove_suffix(1);
    return line;
  }

  void read_format(std::string_view line) {
    const std::string_view name = next_word(line), version = next_word(line);
    if (name == "ascii")
      format_ = Format::kText;
    else if (name == "binary_little_endian")
      format_ = Format::kLittle;
    else if (name == "binary_big_endian")
      format_ = Format::kBig;
    else
      fail_line(fmt::format(
          "format \"{}\"; formats: ascii, binary_little_endian, binary_big_endian", name));
    if (version != "1.0")
      fail_line(fmt::format("version \"{}\" of the format; only 1.0 is known", version));
  }

  void read_element(std::string_view line) {
    Element element;
    element.name = next_word(line);
    const std::string_view count = next_word(line);
    const auto [end, error] =
        std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (element.name.empty() || error != std::errc() || end != count.data() + count.size() ||
        element.count > kMost || !next_word(line).empty())
      fail_line("an element has a name and a count of at most 2^31 - 1");
    for (const Element& other : elements_)
      if (other.name == element.name) fail_line(fmt::format("a second element {}", element.name));
    elements_.push_back(std::move(element));
  }

  const Type* type_of(std::string_view word) const {
    for (const Type& type : kTypes)
      if (word == type.name || word == type.other_name) return &type;
    fail_line(fmt::format(
        "\"{}\" is not a type; types: char uchar short ushort int uint float double", word));
  }

  void read_property(std::string_view line) {
    if (elements_.empty()) fail_line("a property of no element");
    Property property;
    std::string_view word = next_word(line);
    if (word == "list") {
      property.count = type_of(next_word(line));
      if (!property.count->is_integer) fail_line("the length of a list is an integer");
      word = next_word(line);
    }
    property.type = type_of(word);
    property.name = next_word(line);
    if (property.name.empty() || !next_word(line).empty())
      fail_line(
          "a property has a type and a name: property TYPE NAME, property list TYPE TYPE NAME");
    for (const Property& other : elements_.back().properties)
      if (other.name == property.name)
        fail_line(fmt::format("a second property {}", property.name));
    elements_.back().properties.push_back(std::move(property));
  }

  void check_vertices() {
    bool found = false;
    for (const Element& element : elements_) {
      if (element.count > 0 && element.properties.empty())
        fail(fmt::format("element {} has no properties", element.name));
      if (element.name != "vertex") continue;
      found = true;
      vertices_ = element.count;
      for (const char* name : {"x", "y", "z"})
        if (std::none_of(element.properties.begin(), element.properties.end(),
                         [&](const Property& p) { return p.name == name && p.count == nullptr; }))
          fail(fmt::format("vertices have no {}", name));
    }
    if (!found) fail("no element vertex");
  }

  void read_values(const Element& element) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      const auto fail_here = [&](const std::string& what) {
        fail(fmt::format("{} {} of {}: {}", element.name, i, element.count, what));
      };
      std::string_view line;
      if (format_ == Format::kText) line = next_filled_line();
      for (const Property& property : element.properties) {
        double length = 1.0;
        const bool corners = property.count != nullptr && element.name == "face" &&
                             (property.name == "vertex_indices" || property.name == "vertex_index");
        if (corners && !property.type->is_integer) fail_here("vertices are named by integers");
        if (property.count != nullptr && !(read(line, *property.count, length) && length >= 0.0 &&
                                           length <= static_cast<double>(kMost)))
          fail_here(fmt::format("{} has no length", property.name));
        for (double k = 0.0; k < length; ++k) {
          double value = 0.0;
          if (!read(line, *property.type, value))
            fail_here(fmt::format("{} is not there, or not a number of type {}", property.name,
                                  property.type->name));
          if (corners && !(value >= 0.0 && value < static_cast<double>(vertices_)))
            fail_here(fmt::format("names vertex {}, but there are {}", value, vertices_));
        }
      }
    }
  }

  // Assimp has one element on each line, and no use for empty ones.
  std::string_view next_filled_line() {
    while (!rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      const std::string_view line = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      if (line.find_first_not_of(kBlank) != std::string_view::npos) return line;
    }
    return {};
  }

  bool read(std::string_view& line, const Type& type, double& value) {
    if (format_ == Format::kText) return read_word(next_word(line), type, value);
    if (rest_.size() < type.bytes) return false;
    unsigned char bytes[8];
    std::memcpy(bytes, rest_.data(), type.bytes);
    rest_.remove_prefix(type.bytes);
    if (format_ == Format::kBig) std::reverse(bytes, bytes + type.bytes);
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < type.bytes; ++i) bits |= std::uint64_t{bytes[i]} << (8 * i);
    if (!type.is_integer)
      value = type.bytes == 4 ? double{std::bit_cast<float>(static_cast<std::uint32_t>(bits))}
                              : std::bit_cast<double>(bits);
    else if (type.is_signed && (bits >> (8 * type.bytes - 1)) != 0)
      value = static_cast<double>(bits) - std::ldexp(1.0, static_cast<int>(8 * type.bytes));
    else
      value = static_cast<double>(bits);
    return true;
  }

  static bool read_word(std::string_view word, const Type& type, double& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc() || end != word.data() + word.size()) return false;
    return !type.is_integer || value == std::floor(value);
  }

  std::string file_, text_;
  std::string_view rest_;
  std::size_t line_ = 0;
  Format format_ = Format::kText;
  std::vector<Element> elements_;
  std::uint64_t vertices_ = 0;
};

}  // namespace

void check_ply(const std::filesystem::path& file) { Checker(file).check(); }

}  // namespace morsel::render
