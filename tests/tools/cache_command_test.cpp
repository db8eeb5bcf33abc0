// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "cache_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

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
    EXPECT_FALSE(std::filesystem::exists(cache_));
    // What the next build goes on from is kept, once it took some seconds: on a busy machine.
    std::filesystem::remove(cache_ + ".partial");
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

  // What a pattern such as rock-*.topo gives once a field has changed.
  const json two = json::parse(run_morsel({"cache", "info", cache_, cache_, "--json"}).out);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1]["file"], cache_);
  EXPECT_EQ(two[1]["components"], components);
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
  EXPECT_NE(run_morsel({"cache", "info", scene_}).err.find("those of a JSON file or a scene"),
            std::string::npos);
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
