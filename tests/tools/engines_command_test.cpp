// SPDX-License-Identifier: Apache-2.0
// The engines of `morsel cache build`, their audit, what is exported of them, and comparisons.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "cache_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

using EnginesCommandTest = CacheCommandTest;

TEST_F(EnginesCommandTest, EnginesAndTheirAudit) {
  const json both = json::parse(build({"--engine", "both", "--json", "-o", cache_}).out)[0];
  EXPECT_EQ(both["engine"], "both");
  EXPECT_EQ(both["certified"], true);
  EXPECT_EQ(both["morse"]["audit"]["agreed"], true);
  EXPECT_EQ(both["morse"]["audit"]["verdict"], "agreed");
  EXPECT_EQ(both["morse"]["audit"]["euler_compared_with"], json({"octree", "mesh"}));
  EXPECT_EQ(both["morse"]["sets"], both["components"]);
  // An audit with the mesh serves who asks for less, and not the other way round.
  const std::string small = (folder_ / "small.topo").string();
  const std::vector<std::string> octree{"--engine", "both", "--audit-euler", "octree", "-o"};
  const auto by_octree = [&](const std::string& file) {
    std::vector<std::string> arguments = octree;
    arguments.push_back(file);
    return build(arguments);
  };
  EXPECT_NE(by_octree(cache_).out.find("up to date"), std::string::npos);
  const CommandResult less = by_octree(small);
  EXPECT_NE(less.out.find("Euler characteristics by octree,"), std::string::npos) << less.out;
  // The row of the paper's table 1.
  EXPECT_NE(less.out.find(fmt::format("critical points: {} maxima, {} 2-saddles, ",
                                      both["critical_points"]["maxima"].get<int>(),
                                      both["critical_points"]["saddles2"].get<int>())),
            std::string::npos)
      << less.out;
  const CommandResult more = build({"--engine", "both", "--audit-euler", "mesh", "-o", small});
  EXPECT_NE(more.out.find("audited without the mesh"), std::string::npos) << more.out;
  EXPECT_NE(more.out.find("by octree and mesh"), std::string::npos) << more.out;
  EXPECT_GE(both["critical_points"]["maxima"], both["components"]);
  int maxima = 0;
  for (const json& c : both["component_table"]) maxima += c["maxima"].get<int>();
  EXPECT_EQ(both["critical_points"]["maxima"], maxima);
  // What is there serves whoever asks for certified labels, but not for the Morse engine's.
  EXPECT_NE(build({"-o", cache_}).out.find("up to date"), std::string::npos);
  const CommandResult morse = build({"--engine", "morse", "-o", cache_});
  EXPECT_NE(morse.out.find("made by the engine \"both\""), std::string::npos) << morse.out;
  EXPECT_NE(morse.out.find("NOT certified"), std::string::npos) << morse.out;
  const json info = json::parse(run_morsel({"cache", "info", cache_, "--json"}).out);
  EXPECT_EQ(info["components"], both["components"]);
  EXPECT_EQ(info["critical_points"], both["critical_points"]);
  const CommandResult guess = build({"--engine", "guess"});
  EXPECT_EQ(guess.code, 2);
  EXPECT_NE(guess.err.find("certified, morse, both"), std::string::npos) << guess.err;
  // The comparators make no labels; the error says where they are.
  for (const std::string& grid : {std::string("voxel"), std::string("mesh")}) {
    const CommandResult result = build({"--engine", grid, "--resolution", "64"});
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.err.find("cache compare SCENE --engine " + grid + " --resolution N"),
              std::string::npos)
        << result.err;
  }
}

// Three balls, and a perturbation so large that the Morse engine sees another field.
TEST_F(EnginesCommandTest, EnginesThatDisagreeFailAndNameThePlace) {
  const std::string scene =
      folder_
          .write("balls.json",
                 R"({"morsel": 1, "geometries": [{"name": "balls", "type": "hypertexture",
                     "field": {"density": {"type": "metaballs", "level": 0.6, "balls": [
                       {"center": [-0.8, 0, 0], "radius": 1.4, "weight": 1},
                       {"center": [0.8, 0, 0], "radius": 1.4, "weight": 1},
                       {"center": [0, 2.6, 0.5], "radius": 1, "weight": 0.7}]}}}]})")
          .string();
  const auto both = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"cache", "build", scene, "--engine", "both", "-o", cache_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_morsel(arguments);
  };
  const CommandResult wrong = both({"--perturb", "0.3"});
  EXPECT_EQ(wrong.code, 1) << wrong.out;
  EXPECT_NE(wrong.err.find("balls: the certified and the Morse engine disagree"), std::string::npos)
      << wrong.err;
  EXPECT_NE(wrong.err.find("at ("), std::string::npos) << wrong.err;
  EXPECT_NE(wrong.err.find("0.3"), std::string::npos) << wrong.err;
  EXPECT_FALSE(std::filesystem::exists(cache_));
  const CommandResult right = both({});
  EXPECT_EQ(right.code, 0) << right.err;
  EXPECT_NE(right.out.find("engines agree"), std::string::npos) << right.out;
}

// What could not be compared is a failure, and the cache says of itself no more than is true.
TEST_F(EnginesCommandTest, EnginesThatCannotBeComparedFailAndLeaveCertifiedLabels) {
  const std::string cut =
      "geometries.rock.bounds={\"min\": [-2.5, -2.5, -2.5], \"max\": [0, 2.5, 2.5]}";
  for (int n = 0; n < 2; ++n) {  // whether it is built or was there
    const CommandResult both = build({"--engine", "both", "-o", cache_, "--set", cut});
    EXPECT_EQ(both.code, 1) << both.out;
    EXPECT_NE(both.err.find("rock: the engines could not be compared"), std::string::npos)
        << both.err;
    EXPECT_NE(both.err.find("cuts the solid near (0"), std::string::npos) << both.err;
    EXPECT_NE(both.out.find("engines NOT compared"), std::string::npos) << both.out;
    EXPECT_EQ(both.out.find("up to date") != std::string::npos, n == 1) << both.out;
  }
  const json info = json::parse(run_morsel({"cache", "info", cache_, "--json"}).out);
  EXPECT_EQ(info["engine"], "certified");
  EXPECT_EQ(info["morse"]["audit"]["verdict"], "not compared");
  // Certified labels are what it holds, and critical points to look at.
  const CommandResult plain = build({"-o", cache_, "--set", cut});
  EXPECT_EQ(plain.code, 0) << plain.err;
  EXPECT_NE(plain.out.find("up to date"), std::string::npos) << plain.out;
  const std::string csv = (folder_ / "a.csv").string();
  EXPECT_EQ(run_morsel({"cache", "export", cache_, "--csv", "-o", csv}).code, 0);
}

// The ridge of a torus is a curve of critical points; the remedy that the documentation names.
TEST_F(EnginesCommandTest, PerturbationResolvesCurvesOfCriticalPoints) {
  const std::string torus =
      folder_
          .write("torus.json",
                 R"({"morsel": 1, "geometries": [{"name": "ring", "type": "hypertexture",
                     "field": {"density": {"type": "torus", "major_radius": 1, "minor_radius": 0.4, "smoothing": 0.1}}}]})")
          .string();
  const auto both = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"cache", "build", torus, "--engine", "both", "-o", cache_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_morsel(arguments);
  };
  const CommandResult plain = both({});
  EXPECT_EQ(plain.code, 1) << plain.out;
  EXPECT_NE(plain.err.find("perturb"), std::string::npos) << plain.err;
  const CommandResult perturbed = both({"--perturb", "1e-2"});
  EXPECT_EQ(perturbed.code, 0) << perturbed.err;
  EXPECT_NE(perturbed.out.find("engines agree"), std::string::npos) << perturbed.out;
  EXPECT_NE(both({"--perturb", "1e-2"}).out.find("up to date"), std::string::npos);
  const CommandResult again = both({"--perturb", "2e-2"});
  EXPECT_NE(again.out.find("made with the perturbation 0.01"), std::string::npos) << again.out;
}

// Sound fields with derived bounds and no noise: nothing to warn of.
TEST_F(EnginesCommandTest, PlainDensitiesAreAuditedWithoutWarnings) {
  const std::string box =
      folder_
          .write("box.json",
                 R"({"morsel": 1, "geometries": [{"name": "box", "type": "hypertexture",
                     "field": {"density": {"type": "rounded_box", "half_size": [1, 0.7, 0.5], "rounding": 0.2}}}]})")
          .string();
  const CommandResult both = run_morsel(
      {"cache", "build", box, "--engine", "both", "--perturb", "1e-2", "--quiet", "-o", cache_});
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_EQ(both.err, "");
  EXPECT_NE(both.out.find("engines agree"), std::string::npos) << both.out;
}

TEST_F(EnginesCommandTest, MorseLabelsAreNotUndecidedBecauseTheyAreNotCertified) {
  const CommandResult morse = build({"--engine", "morse", "-o", cache_});
  EXPECT_EQ(morse.code, 0) << morse.err;
  EXPECT_EQ(morse.err.find("undecided"), std::string::npos) << morse.err;
  EXPECT_NE(morse.out.find("NOT certified"), std::string::npos) << morse.out;
  EXPECT_EQ(run_morsel({"cache", "info", cache_}).code, 0);
}

TEST_F(EnginesCommandTest, ExportsCriticalPoints) {
  ASSERT_EQ(build({"-o", cache_}).code, 0);
  const std::string csv = (folder_ / "a.csv").string(), vtp = (folder_ / "a.vtp").string(),
                    svg = (folder_ / "a.svg").string();
  const CommandResult none = run_morsel({"cache", "export", cache_, "--csv", "-o", csv});
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.err.find("--engine both"), std::string::npos) << none.err;
  EXPECT_FALSE(std::filesystem::exists(csv));
  const json both = json::parse(build({"--engine", "both", "--json", "-o", cache_}).out)[0];
  ASSERT_EQ(run_morsel({"cache", "export", cache_, "--csv", "-o", csv}).code, 0);
  ASSERT_EQ(run_morsel({"cache", "export", cache_, "--vtp", "-o", vtp}).code, 0);
  ASSERT_EQ(run_morsel({"cache", "export", cache_, "--svg", "--axis", "x", "-o", svg}).code, 0);
  EXPECT_EQ(run_morsel({"cache", "export", cache_, "-o", svg}).code, 2);
  EXPECT_EQ(run_morsel({"cache", "export", cache_, "--svg", "--csv", "-o", svg}).code, 2);

  std::ifstream table(csv);
  std::string line;
  std::map<std::string, int> types;
  while (std::getline(table, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 13) << line;
    const std::size_t comma = line.find(',') + 1;
    ++types[line.substr(comma, line.find(',', comma) - comma)];
  }
  EXPECT_EQ(types["maximum"], both["critical_points"]["maxima"]);
  EXPECT_EQ(types["2-saddle"], both["critical_points"]["saddles2"]);
  const auto text = [](const std::string& file) {
    std::ifstream in(file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_NE(text(vtp).find(fmt::format("NumberOfLines=\"{}\"", 2 * types["2-saddle"])),
            std::string::npos);
  EXPECT_NE(text(svg).find("</svg>"), std::string::npos);

  // Balls of 6 rings of 12 and two poles; tubes only where there are separatrices.
  const auto vertices = [&](const std::string& parts) {
    const std::string ply = (folder_ / "a.ply").string();
    EXPECT_EQ(run_morsel({"cache", "export", cache_, "--ply", "--parts", parts, "-o", ply}).code,
              0);
    const std::string content = text(ply), key = "element vertex ";
    return std::stoi(content.substr(content.find(key) + key.size()));
  };
  const int maxima = vertices("maxima"), saddles = vertices("saddles");
  EXPECT_EQ(maxima, 74 * types["maximum"]);
  EXPECT_EQ(saddles, 74 * types["2-saddle"]);
  const int tubes = vertices("separatrices");
  EXPECT_GE(tubes, 2 * 16 * types["2-saddle"]);
  EXPECT_EQ(vertices("maxima,saddles,separatrices"), maxima + saddles + tubes);
  EXPECT_EQ(run_morsel({"cache", "export", cache_, "--ply", "--parts", "ridges", "-o", csv}).code,
            2);
}

TEST_F(EnginesCommandTest, ComparesMethods) {
  const CommandResult result =
      run_morsel({"cache", "compare", scene_, "--resolution", "16,64", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json rows = json::parse(result.out);
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[0]["engine"], "certified");
  EXPECT_EQ(rows[0]["certified"], true);
  EXPECT_EQ(rows[1]["components"], rows[0]["components"]);
  for (std::size_t i = 2; i < 6; ++i) EXPECT_EQ(rows[i]["certified"], false);
  for (const json& row : rows) EXPECT_GE(row["seconds"].get<double>(), 0.0);
  EXPECT_EQ(result.err.find("is cut there"), std::string::npos) << result.err;
  EXPECT_EQ(run_morsel({"cache", "compare", scene_, "--resolution", "1"}).code, 2);
  // A list does not swallow the scene behind it.
  const CommandResult behind = run_morsel(
      {"cache", "compare", "--engine", "voxel", "--resolution", "16", scene_, "--threads", "1"});
  EXPECT_EQ(behind.code, 0) << behind.err;
}

// The first row of scenes/figures/README.md's table 1. The other rows take too long for here.
TEST_F(EnginesCommandTest, TheTableOfThePaperHasThatFirstRow) {
  const CommandResult result =
      run_morsel({"cache", "compare", MORSEL_SOURCE_DIR "/scenes/figures/table1_l1.json",
                  "--engine", "certified,morse", "--json", "--progress", "none"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json rows = json::parse(result.out);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["components"], 84);
  EXPECT_EQ(rows[0]["certified"], true);
  EXPECT_EQ(rows[1]["components"], 84);
  EXPECT_EQ(rows[1]["maxima"], 231);
  EXPECT_EQ(rows[1]["saddles2"], 242);
  EXPECT_EQ(rows[1]["lost_ascents"], 0);
  EXPECT_EQ(rows[1]["unresolved_boxes"], 0);
  // What is counted is proved; which boxes are split on the way may hang on the last bit of sums
  // that other vector units add in another order.
  EXPECT_NEAR(rows[1]["boxes"].get<double>(), 274073, 274);
}

TEST_F(EnginesCommandTest, ComparisonWarnsWhereTheBoxCutsTheSolid) {
  const CommandResult result =
      run_morsel({"cache", "compare", scene_, "--engine", "morse", "--set",
                  "geometries.rock.bounds={\"min\": [-2.5, -2.5, -2.5], \"max\": [0, 2.5, 2.5]}"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.err.find("\"rock\": its surface reaches its bounds near (0, "),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.out.find("no: the box cuts the solid"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace morsel::test
