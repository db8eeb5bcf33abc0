// SPDX-License-Identifier: Apache-2.0
// What is said of a file that is no JSON: where, what was found, what was expected; once.
#include "hypertexture_geom/params/syntax.h"

#include <gtest/gtest.h>

#include <random>

#include "hypertexture_geom/params/json_reader.h"

namespace morsel::params {
namespace {

TEST(Syntax, SaysWhereAndWhatAndWhatElse) {
  const std::string value =
      "expected a value: a number, true, false, null, \"text\" in double quotes, [...] or {...}";
  const std::pair<const char*, std::string> cases[] = {
      {"{\n  \"a\": 1\n  \"b\": 2\n}", "line 3, column 3: found \"b\", expected ',' or '}'"},
      {"{\"a\": [1 2]}", "line 1, column 10: found \"2\", expected ',' or ']'"},
      {"{\"a\": [1, 2\n}", "line 2, column 1: found '}', expected ',' or ']'"},
      {"{\"a\" 1}", "line 1, column 6: found \"1\", expected ':' after the key"},
      {"{\"a\":}", "line 1, column 6: found '}', " + value},
      {"{\"a\": 1,\n}", "line 1, column 8: a ',' before '}' is one too many"},
      {"[1,\n 2,\n]", "line 2, column 3: a ',' before ']' is one too many"},
      {"{name: 1}", "line 1, column 2: found \"name\", expected a key in double quotes"},
      {"{'name': 1}", "line 1, column 2: found ''', expected a key in double quotes"},
      {"{\"a\": True}", "line 1, column 7: found \"True\", " + value},
      {"{\"a\": tru}", "line 1, column 7: found \"tru\", " + value},
      {"{\"a\": NaN}", "line 1, column 7: found \"NaN\", " + value},
      {"{\"a\": -Infinity}", "line 1, column 8: invalid number; expected digit after '-'"},
      {"{\"a\": 1.}", "line 1, column 9: invalid number; expected digit after '.'"},
      {"{\"a\": 1e999}", "line 1, column 7: \"1e999\" is too large a number"},
      {"{\"a\": \"text\n}", "line 1, column 12: the line ends within a text: a '\"' is missing"},
      {"{\"a\": \"text", "line 1, column 11: invalid string: missing closing quote"},
      {"{\"a\": \"\\q\"}", "line 1, column 9: invalid string: forbidden character after backslash"},
      {"{\"a\": \"\xff\"}", "line 1, column 8: invalid string: ill-formed UTF-8 byte"},
      {"{\"a\": [1, 2", "line 1, column 12: the file ends, expected ',' or ']'"},
      {"", "line 1, column 1: the file ends, " + value},
      {"{} {}", "line 1, column 4: found '{', expected nothing more, for the document has ended"},
      {"{\"a\": 1, \"b\": 2,\n \"a\": 3}",
       "line 2, column 2: the key \"a\" appears twice in one object"},
      // Columns count characters, not bytes; typographic quotes are shown as they are.
      {"{\"\xc3\xa9\xc3\xa9\" 1}", "line 1, column 7: found \"1\", expected ':' after the key"},
      {"{\xe2\x80\x9c"
       "a\xe2\x80\x9d: 1}",
       "line 1, column 2: found \"\xe2\x80\x9c"
       "a\xe2\x80\x9d\", expected a key in double quotes"},
      // What the file holds is not taken for what the parser says.
      {"{\"a\": 1 \"; expected end of input - invalid literal\": 2}",
       "line 1, column 9: found \"; expected end of input - invalid lit...\", expected ',' or "
       "'}'"},
  };
  for (const auto& [text, problem] : cases) EXPECT_EQ(syntax_problem(text), problem) << text;
}

TEST(Syntax, ErrorsNameTheFileAndNothingTwice) {
  try {
    parse_text("{\n\"a\" 1}", "scene.json");
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "scene.json: line 2, column 5: found \"1\", expected ':' after the key");
  }
}

TEST(Syntax, AcceptsWhatIsRight) {
  for (const char* text :
       {"1", "null", " [] ", "{\"a\": {\"a\": 1}, \"b\": [{\"a\": 1}, {\"a\": 2}]}",
        "// a comment\n{ /* another */ \"a\": -1.5e3 }\n", "\xef\xbb\xbf{}", "\"\\u00e9\\\"\""}) {
    EXPECT_EQ(syntax_problem(text), "") << text;
    EXPECT_NO_THROW(parse_text(text, "file"));
  }
}

// Whatever a file holds, either both accept it or something is said, and never of a place beyond.
TEST(Syntax, AgreesWithTheParserAboutDamagedText) {
  const std::string whole =
      "{ \"name\": \"a\\\"b\\u00e9\", // c\n \"list\": [1, -2.5e3, true, null, {\"x\": [[]]}],\n"
      " /* d */ \"object\": { \"k\": \"v\" } }";
  ASSERT_EQ(syntax_problem(whole), "");
  const std::string bytes = std::string("{}[]\",:\\/*-.e0t\n\t ax\xc3\xff") + '\0';
  std::mt19937 random(1);
  int accepted = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string text = whole;
    const std::size_t at = random() % text.size();
    const int kind = static_cast<int>(random() % 3);
    if (kind == 0)
      text[at] = bytes[random() % bytes.size()];
    else if (kind == 1)
      text.erase(at, 1 + random() % 3);
    else
      text.resize(at);
    const std::string problem = syntax_problem(text);
    const bool parses = nlohmann::json::accept(text, true);
    // Keys that appear twice are the parser's to accept, not ours.
    EXPECT_TRUE(problem.empty() == parses || problem.find("twice") != std::string::npos)
        << text << '\n'
        << problem;
    EXPECT_EQ(problem.find("json.exception"), std::string::npos) << problem;
    accepted += problem.empty();
  }
  EXPECT_GT(accepted, 100);
  EXPECT_LT(accepted, 4000);
}

}  // namespace
}  // namespace morsel::params
