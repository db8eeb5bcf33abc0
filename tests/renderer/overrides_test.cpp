// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/overrides.h"

#include <gtest/gtest.h>

#include "renderer/scene/scene_json.h"
#include "scene_files.h"
#include "tests/temporary_folder.h"

namespace morsel::render {
namespace {

using nlohmann::json;
using test::TemporaryFolder;

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const params::InputError& e) {
    return e.what();
  }
  return "";
}

json applied(const std::string& document, const std::string& text) {
  json root = json::parse(document);
  apply_override(root, parse_override(text), {"file", ""});
  return root;
}

TEST(Overrides, ValueIsJsonElseText) {
  EXPECT_EQ(parse_override("a.b=16").value, json(16));
  EXPECT_EQ(parse_override("a.b=[1, 2.5]").value, json({1, 2.5}));
  EXPECT_EQ(parse_override("a.b=true").value, json(true));
  EXPECT_EQ(parse_override("a.b=all").value, json("all"));
  EXPECT_EQ(parse_override("a.b=\"16\"").value, json("16"));
  EXPECT_EQ(parse_override("a.b=").value, json(""));
  EXPECT_EQ(parse_override("a.b=x=y").value, json("x=y"));
  EXPECT_EQ(parse_override("a.b=x=y").path, "a.b");
}

TEST(Overrides, PathsWithoutValueOrPartsAreRefused) {
  for (const char* text : {"a.b", "=3", "a..b=3", ".a=3", "a.=3"}) {
    const std::string error = error_of([&] { parse_override(text); });
    EXPECT_NE(error.find(std::string("--set ") + text), std::string::npos) << text << ": " << error;
  }
}

// A name in Latin-1, for one: it could not even be quoted in a message.
TEST(Overrides, WhatIsNotUtf8IsRefused) {
  for (const char* text : {"a.b=\xe9t\xe9.obj", "\xff=3"}) {
    const std::string error = error_of([&] { parse_override(text); });
    EXPECT_NE(error.find("must be UTF-8"), std::string::npos) << error;
  }
  EXPECT_EQ(parse_override("a.b=\xc3\xa9t\xc3\xa9.obj").value, json("\xc3\xa9t\xc3\xa9.obj"));
}

TEST(Overrides, ReachObjectsAndElementsByIndexAndByName) {
  EXPECT_EQ(applied(R"({"render": {"spp": 4}})", "render.spp=16")["render"]["spp"], 16);
  const char* list = R"({"g": [{"name": "a", "x": 1}, {"name": "b", "x": 2}]})";
  EXPECT_EQ(applied(list, "g.1.x=5")["g"][1]["x"], 5);
  EXPECT_EQ(applied(list, "g.a.x=5")["g"][0]["x"], 5);
  EXPECT_EQ(applied(R"({"r": [3, 4]})", "r.1=9")["r"], json({3, 9}));
}

TEST(Overrides, ANameThatLooksLikeAnIndexIsAName) {
  EXPECT_EQ(applied(R"({"g": [{"name": "1"}, {"name": "0"}]})", "g.0.x=5")["g"][1]["x"], 5);
}

TEST(Overrides, MakeWhatTheFileDoesNotHave) {
  EXPECT_EQ(applied("{}", "render.spp=16"), json::parse(R"({"render": {"spp": 16}})"));
}

TEST(Overrides, UnknownElementsNameTheNearest) {
  const char* list = R"({"geometries": [{"name": "rock"}, {"name": "floor"}]})";
  const std::string error = error_of([&] { applied(list, "geometries.rocky.keep=all"); });
  for (const char* part :
       {"file", "/geometries", "\"rocky\"", "did you mean \"rock\"", "rock, floor", "--set"})
    EXPECT_NE(error.find(part), std::string::npos) << part << " in " << error;
  EXPECT_NE(error_of([&] { applied(list, "geometries.2.keep=all"); }).find("array of 2"),
            std::string::npos);
}

TEST(Overrides, PathsIntoNumbersAreRefused) {
  const std::string error =
      error_of([&] { applied(R"({"render": {"spp": 4}})", "render.spp.x=1"); });
  EXPECT_NE(error.find("/render/spp: is 4"), std::string::npos) << error;
}

TEST(Overrides, ErrorsOfTheReaderNameTheOverride) {
  const TemporaryFolder folder;
  const auto file = folder.write("scene.json", test::kSmallScene);
  const auto load = [&](const std::string& text) {
    return error_of([&] {
      const SceneDocument document(file, {parse_override(text)});
      read_hypertexture(document, find_hypertexture(document, "rock"));
    });
  };
  EXPECT_EQ(load("geometries.rock.keep=all"), "");
  const std::string bad_value = load("geometries.rock.keep=everything");
  EXPECT_NE(bad_value.find("/geometries/0/keep"), std::string::npos) << bad_value;
  EXPECT_NE(bad_value.find("(set by --set geometries.rock.keep=everything)"), std::string::npos)
      << bad_value;
  // About something within the value that was set.
  const std::string inside = load("geometries.rock.field.density={\"type\": \"cube\"}");
  EXPECT_NE(inside.find("--set geometries.rock.field.density"), std::string::npos) << inside;
  const std::string section = load("rendr.spp=4");
  EXPECT_NE(section.find("did you mean \"render\""), std::string::npos) << section;
  EXPECT_NE(section.find("--set rendr.spp=4"), std::string::npos) << section;
  // About something else: the override is innocent.
  const auto broken = folder.write("broken.json", R"({"morsel": 1, "lamps": []})");
  const std::string other =
      error_of([&] { SceneDocument(broken, {parse_override("render.spp=4")}); });
  EXPECT_NE(other.find("/lamps"), std::string::npos) << other;
  EXPECT_EQ(other.find("--set"), std::string::npos) << other;
}

}  // namespace
}  // namespace morsel::render
