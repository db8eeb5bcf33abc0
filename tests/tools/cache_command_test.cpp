// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

class CacheCommandTest : public ::testing::Test {
 protected:
  CommandResult build(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"cache", "build", scene_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_morsel(arguments);
  }

  TemporaryFolder folder_;
  std::string scene_ = folder_.write("scene.json", kCommandScene).string();
  std::string cache_ = (folder_ / "my.topo").string();
};

TEST_F(CacheCommandTest, BuildsOnlyWhatIsMissingOrStale) {
  const CommandResult first = build();
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_NE(first.out.find("built, was missing"), std::string::npos) << first.out;
  const CommandResult second = build();
  EXPECT_EQ(second.code, 0);
  EXPECT_NE(second.out.find("up to date"), std::string::npos) << second.out;
  const CommandResult forced = build({"--force"});
  EXPECT_NE(forced.out.find("built, was forced"), std::string::npos) << forced.out;
  // A changed field gets another file.
  build({"--set", "geometries.rock.field.modulations.0.seed=4"});
  EXPECT_EQ(folder_.count_files(), 3u);

  ASSERT_EQ(build({"-o", cache_}).code, 0);
  const CommandResult other =
      build({"-o", cache_, "--set", "geometries.rock.field.modulations.0.seed=4"});
  EXPECT_NE(other.out.find("built, was stale"), std::string::npos) << other.out;
}

TEST_F(CacheCommandTest, InterruptInTheMiddleExitsWith130AndLeavesNothing) {
  const std::string scene = MORSEL_SOURCE_DIR "/scenes/figures/table1_l3.json";
  for (const int signal : {SIGINT, SIGTERM}) {
    CommandOptions options;
    options.then = [signal](int pid, const std::filesystem::path& err) {
      for (int i = 0; i < 600 && read_text(err).find("labelling") == std::string::npos; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
      ::kill(pid, signal);
    };
    const CommandResult result =
        run_morsel({"cache", "build", scene, "-o", cache_, "--threads", "2"}, options);
    EXPECT_EQ(result.code, 130) << result.err;
    EXPECT_EQ(folder_.count_files(), 1u);  // the scene
  }
}

TEST_F(CacheCommandTest, OutputsThatAreNoFilesAreRefused) {
  ASSERT_EQ(::mkfifo(cache_.c_str(), 0600), 0);
  const CommandResult result = build({"-o", cache_, "--force"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find(cache_), std::string::npos) << result.err;
  EXPECT_TRUE(std::filesystem::is_fifo(cache_));
}

TEST_F(CacheCommandTest, MaxDepthChangesTheFingerprint) {
  const json a = json::parse(build({"--json"}).out),
             b = json::parse(build({"--json", "--max-depth", "9"}).out);
  EXPECT_NE(a[0]["field_hash"], b[0]["field_hash"]);
  EXPECT_LE(b[0]["octree"]["depth"], 9);
  EXPECT_EQ(a[0]["geometry"], "rock");
  EXPECT_EQ(a[0]["built"], true);
}

TEST_F(CacheCommandTest, InfoHasTheKeysThatOthersRelyOn) {
  ASSERT_EQ(build({"-o", cache_}).code, 0);
  const CommandResult result = run_morsel({"cache", "info", cache_, "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const json info = json::parse(result.out);  // one document and nothing else
  for (const char* key :
       {"components", "components_bounds", "certified", "unresolved_cells", "engine",
        "critical_points", "kept", "field_hash", "seconds", "bytes", "octree"})
    EXPECT_TRUE(info.contains(key)) << key;
  for (const char* key : {"maxima", "saddles2", "saddles1", "minima"})
    EXPECT_TRUE(info["critical_points"].contains(key)) << key;
  EXPECT_TRUE(info["octree"].contains("leaves"));
  EXPECT_TRUE(info["octree"].contains("depth"));
  EXPECT_EQ(info["bytes"], std::filesystem::file_size(cache_));
  EXPECT_EQ(info["kept"], 1);
  const int components = info["components"];
  EXPECT_EQ(components, 5);
  EXPECT_EQ(info["components_bounds"], json({components, components}));

  const json all =
      json::parse(run_morsel({"cache", "info", cache_, "--json", "--keep", "all"}).out);
  EXPECT_EQ(all["kept"], components);
  const CommandResult text = run_morsel({"cache", "info", cache_});
  EXPECT_NE(text.out.find("octree.leaves"), std::string::npos) << text.out;
}

TEST_F(CacheCommandTest, EnginesAndTheirAudit) {
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
TEST_F(CacheCommandTest, EnginesThatDisagreeFailAndNameThePlace) {
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
TEST_F(CacheCommandTest, EnginesThatCannotBeComparedFailAndLeaveCertifiedLabels) {
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
TEST_F(CacheCommandTest, PerturbationResolvesCurvesOfCriticalPoints) {
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
TEST_F(CacheCommandTest, PlainDensitiesAreAuditedWithoutWarnings) {
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

TEST_F(CacheCommandTest, MorseLabelsAreNotUndecidedBecauseTheyAreNotCertified) {
  const CommandResult morse = build({"--engine", "morse", "-o", cache_});
  EXPECT_EQ(morse.code, 0) << morse.err;
  EXPECT_EQ(morse.err.find("undecided"), std::string::npos) << morse.err;
  EXPECT_NE(morse.out.find("NOT certified"), std::string::npos) << morse.out;
  EXPECT_EQ(run_morsel({"cache", "info", cache_}).code, 0);
}

TEST_F(CacheCommandTest, ExportsCriticalPoints) {
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

TEST_F(CacheCommandTest, ComparesMethods) {
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
}

TEST_F(CacheCommandTest, ComparisonWarnsWhereTheBoxCutsTheSolid) {
  const CommandResult result =
      run_morsel({"cache", "compare", scene_, "--engine", "morse", "--set",
                  "geometries.rock.bounds={\"min\": [-2.5, -2.5, -2.5], \"max\": [0, 2.5, 2.5]}"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.err.find("\"rock\": its surface reaches its bounds near (0, "),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.out.find("no: the box cuts the solid"), std::string::npos) << result.out;
}

TEST_F(CacheCommandTest, ASurfaceThatIsCutIsAWarningWithThePlace) {
  const std::vector<std::string> cut{"cache", "build", scene_, "--set",
                                     "geometries.rock.bounds={\"min\": [-2.5, -2.5, -2.5], "
                                     "\"max\": [0, 2.5, 2.5]}"};
  for (int n = 0; n < 2; ++n) {  // whether it is built or was there
    const CommandResult result = run_morsel(cut);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.err.find("\"rock\": its surface reaches its bounds near (0, "),
              std::string::npos)
        << result.err;
  }
  EXPECT_EQ(build().err.find("reaches its bounds"), std::string::npos);
}

TEST_F(CacheCommandTest, ASolidOutOfBoundsIsAWarningWithThePlace) {
  const auto warned = [&](const json& field, const json& bounds) {
    const CommandResult result = build({"--set", "geometries.rock.field=" + field.dump(), "--set",
                                        "geometries.rock.bounds=" + bounds.dump()});
    EXPECT_EQ(result.code, 0) << result.err;
    return result.err;
  };
  const json ball{{"type", "sphere"}, {"radius", 0.5}};
  json other = ball;
  other["center"] = {3, 0, 0};
  const json both{{"type", "union"}, {"densities", {ball, other}}};
  const json about{{"min", {-1, -1, -1}}, {"max", {1, 1, 1}}};
  // All of it, and no more than a piece.
  std::string err = warned({{"density", ball}}, {{"min", {2, 2, 2}}, {"max", {3, 3, 3}}});
  EXPECT_NE(err.find("\"rock\": there is no solid within its bounds"), std::string::npos) << err;
  EXPECT_NE(err.find("there is some at ("), std::string::npos) << err;
  err = warned({{"density", both}}, about);
  EXPECT_NE(err.find("\"rock\": a piece of its solid is outside its bounds"), std::string::npos)
      << err;
  EXPECT_NE(err.find("there is some at ("), std::string::npos) << err;
  EXPECT_NE(err.find("at (2.9"), std::string::npos) << err;
  // Nothing anywhere.
  const json none{{"density", ball}, {"modulations", {{{"type", "scale_offset"}, {"offset", -1}}}}};
  err = warned(none, about);
  EXPECT_NE(err.find("there is no solid within its bounds"), std::string::npos) << err;
  // All is well.
  EXPECT_EQ(warned({{"density", ball}}, about).find("bounds"), std::string::npos);
  EXPECT_EQ(build().err.find("bounds"), std::string::npos);
}

TEST_F(CacheCommandTest, DamagedCachesFailAndAreNamed) {
  EXPECT_EQ(run_morsel({"cache", "info", cache_}).code, 1);
  ASSERT_EQ(build({"-o", cache_}).code, 0);
  std::filesystem::resize_file(cache_, std::filesystem::file_size(cache_) / 2);
  const CommandResult info = run_morsel({"cache", "info", cache_, "--json"});
  EXPECT_EQ(info.code, 1);
  EXPECT_EQ(info.out, "");
  EXPECT_NE(info.err.find(cache_), std::string::npos) << info.err;
  const CommandResult render =
      run_morsel({"render", scene_, "--cache", cache_, "-o", (folder_ / "a.exr").string()});
  EXPECT_EQ(render.code, 1);
  EXPECT_NE(render.err.find(cache_), std::string::npos) << render.err;
  EXPECT_EQ(folder_.count_files(), 2u);

  // A file that may be anything is replaced only on demand.
  EXPECT_EQ(build({"-o", cache_}).code, 1);
  EXPECT_EQ(build({"-o", cache_, "--force"}).code, 0);
  EXPECT_EQ(run_morsel({"cache", "info", cache_}).code, 0);
}

TEST_F(CacheCommandTest, DamagedCachesOfOurOwnNamingAreRebuilt) {
  const json built = json::parse(build({"--json"}).out);
  std::filesystem::resize_file(built[0]["file"].get<std::string>(), 100);
  const CommandResult again = build();
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_NE(again.out.find("built, was damaged"), std::string::npos) << again.out;
}

TEST_F(CacheCommandTest, UnwritableFilesFailBeforeTheWork) {
  folder_.write("wall", "");
  const CommandResult result = build({"-o", (folder_ / "wall/my.topo").string(), "-q"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("wall/my.topo"), std::string::npos) << result.err;
  EXPECT_EQ(folder_.count_files(), 2u);
}

TEST_F(CacheCommandTest, VerifyProvesACacheAgain) {
  ASSERT_EQ(build({"-o", cache_}).code, 0);
  const CommandResult sample = run_morsel({"cache", "verify", cache_, scene_, "--samples", "200"});
  EXPECT_EQ(sample.code, 0) << sample.err;
  EXPECT_NE(sample.out.find("passed: 200 of"), std::string::npos) << sample.out;
  const CommandResult full = run_morsel({"cache", "verify", cache_, scene_, "--full", "--json"});
  ASSERT_EQ(full.code, 0) << full.err;
  const json report = json::parse(full.out);
  EXPECT_EQ(report["passed"], true);
  EXPECT_EQ(report["cells_proved"], report["leaves"]);
  EXPECT_EQ(report["geometry"], "rock");
  // Of another field: named, not proved.
  const CommandResult other = run_morsel(
      {"cache", "verify", cache_, scene_, "--set", "geometries.rock.field.modulations.0.seed=4"});
  EXPECT_EQ(other.code, 1);
  EXPECT_NE(other.err.find("fingerprint"), std::string::npos) << other.err;
  EXPECT_EQ(run_morsel({"cache", "verify", cache_, scene_, "--geometry", "none"}).code, 2);
}

TEST_F(CacheCommandTest, InfoListsComponentsByVolume) {
  ASSERT_EQ(build({"-o", cache_}).code, 0);
  const CommandResult all = run_morsel({"cache", "info", cache_, "--components", "3"});
  ASSERT_EQ(all.code, 0) << all.err;
  EXPECT_NE(all.out.find("volume (certified bounds)"), std::string::npos) << all.out;
  EXPECT_NE(all.out.find("2 more"), std::string::npos) << all.out;
  const json info = json::parse(run_morsel({"cache", "info", cache_, "--json"}).out);
  double last = 1e300;
  for (const json& row : info["component_table"]) {
    EXPECT_LE(row["volume"][0], row["volume"][1]);
    const double middle = row["volume"][0].get<double>() + row["volume"][1].get<double>();
    EXPECT_LE(middle, last);
    last = middle;
  }
}

TEST_F(CacheCommandTest, TooLittleMemoryIsAFailureThatSaysSo) {
  const CommandResult result = build({"-o", cache_, "--max-memory", "1e-5", "-q"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("memory"), std::string::npos) << result.err;
  EXPECT_EQ(folder_.count_files(), 1u);  // the scene
}

TEST_F(CacheCommandTest, ProgressStaysOnStderrInTheFormAskedFor) {
  const CommandResult plain = build({"--force"});
  EXPECT_EQ(plain.err.find('\r'), std::string::npos);  // no bar into a file
  EXPECT_NE(plain.err.find("100 %"), std::string::npos) << plain.err;
  const CommandResult lines = build({"--force", "--progress", "json"});
  std::istringstream err(lines.err);
  std::string line;
  double last = -1;
  while (std::getline(err, line)) last = json::parse(line)["fraction"].get<double>();
  EXPECT_EQ(last, 1.0);
  EXPECT_EQ(build({"--force", "--quiet"}).err, "");
  EXPECT_EQ(build({"--force", "--progress", "none"}).err, "");
}

}  // namespace
}  // namespace morsel::test
