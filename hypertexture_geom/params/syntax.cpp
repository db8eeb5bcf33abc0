// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/params/syntax.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <vector>

namespace morsel::params {
namespace {

using nlohmann::json;

// Arrays and objects within one another that a document may have. Whoever walks a document does so
// by recursion, and names places by their whole path: both must stay small whatever a file holds.
constexpr int kMaxDocumentDepth = 256;

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' || c == '+' ||
         c == '-' || (c & 0x80) != 0;
}

std::string position_text(const std::string& text, std::size_t byte) {
  std::size_t line = 1, column = 1;
  for (std::size_t i = 0; i < byte && i < text.size(); ++i) {
    if (text[i] == '\n') {
      ++line;
      column = 1;
    } else if ((text[i] & 0xc0) != 0x80) {  // not one more byte of a character
      ++column;
    }
  }
  return fmt::format("line {}, column {}: ", line, column);
}

// In quotes, whatever bytes it has.
std::string in_quotes(const std::string& word) {
  const std::string start = word.size() > 40 ? word.substr(0, 37) + "..." : word;
  return json(start).dump(-1, ' ', false, json::error_handler_t::replace);
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

// What the parser waited for, by what it says of where it was.
std::string expected_by(std::string_view message) {
  constexpr std::string_view kEnd = "; expected end of input";
  if (message.size() >= kEnd.size() && message.substr(message.size() - kEnd.size()) == kEnd)
    return "nothing more, for the document has ended";
  const std::string_view what = message.substr(0, message.find(" - "));  // none of it the file's
  if (contains(what, "while parsing object key")) return "a key in double quotes";
  if (contains(what, "while parsing object separator")) return "':' after the key";
  if (contains(what, "while parsing object")) return "',' or '}'";
  if (contains(what, "while parsing array")) return "',' or ']'";
  return "a value: a number, true, false, null, \"text\" in double quotes, [...] or {...}";
}

// What stands where the parser gave up, and from where to where.
struct Found {
  std::size_t begin, end;
};

// `last` is the last byte that was read.
Found found_at(const std::string& text, std::size_t last, bool bad_word) {
  Found found{last, last + 1};
  if (text[last] == '"' && last > 0 && !bad_word) {  // a whole string: from its opening quote on
    const auto escaped = [&](std::size_t i) {
      std::size_t slashes = 0;
      while (slashes < i && text[i - 1 - slashes] == '\\') ++slashes;
      return slashes % 2 == 1;
    };
    do --found.begin;
    while (found.begin > 0 && (text[found.begin] != '"' || escaped(found.begin)));
    return found;
  }
  // The byte that makes a word a bad one may stand behind it.
  if (bad_word && !is_word(text[last]) && last > 0 && is_word(text[last - 1])) --found.begin;
  if (!is_word(text[found.begin])) return found;
  while (found.begin > 0 && is_word(text[found.begin - 1])) --found.begin;
  found.end = found.begin;
  while (found.end < text.size() && is_word(text[found.end])) ++found.end;
  return found;
}

// `read` bytes were read when the parser said `message`.
std::string explain(const std::string& text, std::size_t read, const std::string& message) {
  const std::string expected = expected_by(message);
  // What follows is of the file: it may hold anything.
  const std::string what = message.substr(0, message.find("; last read"));
  // Newer versions of the parser have a message of their own for a text without anything.
  if (contains(what, "unexpected end of input") || text.empty())
    return position_text(text, text.size()) + "the file ends, expected " + expected;
  if (read == 0) return what;  // cannot be: the parser has read something
  const std::size_t last = std::min(read, text.size()) - 1;
  const bool bad_word = contains(what, "invalid literal");

  if (const std::size_t at = what.find(" - invalid "); at != std::string::npos && !bad_word) {
    if (contains(what, "control character U+000A"))
      return position_text(text, last) + "the line ends within a text: a '\"' is missing";
    return position_text(text, last) + what.substr(at + 3);
  }
  const Found found = found_at(text, last, bad_word);
  const std::string position = position_text(text, found.begin);
  std::string word = text.substr(found.begin, found.end - found.begin);
  if (contains(what, "number overflow"))
    return position + in_quotes(word) + " is too large a number";

  if (word == "}" || word == "]") {
    const std::size_t before =
        found.begin == 0 ? std::string::npos : text.find_last_not_of(" \t\r\n", found.begin - 1);
    if (before != std::string::npos && text[before] == ',')
      return position_text(text, before) + fmt::format("a ',' before '{}' is one too many", word);
  }
  if (word.size() >= 2 && word.front() == '"') word = word.substr(1, word.size() - 2);
  const bool mark =
      word.size() == 1 && !is_word(word[0]) && static_cast<unsigned char>(word[0]) > ' ';
  return position +
         fmt::format("found {}, expected {}", mark ? "'" + word + "'" : in_quotes(word), expected);
}

// Iterator over a text that says how far the parser has read.
struct Cursor {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  const char* at;
  const char** read;

  reference operator*() const { return *at; }
  Cursor& operator++() {
    *read = ++at;
    return *this;
  }
  Cursor operator++(int) {
    const Cursor before = *this;
    ++*this;
    return before;
  }
  bool operator==(const Cursor& other) const { return at == other.at; }
  bool operator!=(const Cursor& other) const { return at != other.at; }
};

class Checker : public json::json_sax_t {
 public:
  explicit Checker(const std::string& text) : text_(text), read_(text.data()) {}

  std::string check() {
    const char* end = text_.data() + text_.size();
    json::sax_parse(Cursor{read_, &read_}, Cursor{end, &read_}, this, json::input_format_t::json,
                    true, true);
    return problem_;
  }

  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(json::number_integer_t /*value*/) override { return true; }
  bool number_unsigned(json::number_unsigned_t /*value*/) override { return true; }
  bool number_float(json::number_float_t /*value*/, const std::string& /*text*/) override {
    return true;
  }
  bool string(std::string& /*value*/) override { return true; }
  bool binary(json::binary_t& /*value*/) override { return true; }

  bool start_object(std::size_t /*size*/) override {
    keys_.emplace_back();
    return deeper();
  }
  bool end_object() override {
    keys_.pop_back();
    --depth_;
    return true;
  }
  bool start_array(std::size_t /*size*/) override { return deeper(); }
  bool end_array() override {
    --depth_;
    return true;
  }
  // The second of two equal keys would otherwise win silently.
  bool key(std::string& name) override {
    if (keys_.back().insert(name).second) return true;
    const Found found = found_at(text_, bytes_read() - 1, false);
    return refuse(found.begin,
                  fmt::format("the key {} appears twice in one object", in_quotes(name)));
  }
  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const json::exception& error) override {
    problem_ = explain(text_, position, error.what());
    return false;
  }

 private:
  std::size_t bytes_read() const { return static_cast<std::size_t>(read_ - text_.data()); }

  bool deeper() {
    if (++depth_ <= kMaxDocumentDepth) return true;
    return refuse(
        bytes_read() - 1,
        fmt::format("nested too deeply: at most {} arrays and objects may hold one another",
                    kMaxDocumentDepth));
  }

  bool refuse(std::size_t byte, const std::string& why) {
    problem_ = position_text(text_, byte) + why;
    return false;
  }

  const std::string& text_;
  const char* read_;
  int depth_ = 0;
  std::vector<std::set<std::string>> keys_;  // of the objects that are open
  std::string problem_;
};

}  // namespace

std::string syntax_problem(const std::string& text) { return Checker(text).check(); }

}  // namespace morsel::params
