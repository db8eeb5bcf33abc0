// SPDX-License-Identifier: Apache-2.0
// Nothing is lost or half-written: programs that are killed at random instants, several that write
// the same file at once, and disks that are full.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <limits>
#include <random>
#include <thread>

#include "command_scene.h"
#include "run_command.h"
#include "small_disk.h"

namespace morsel::test {
namespace {

constexpr int kKills = 30;

class CrashTest : public ::testing::Test {
 protected:
  CrashTest() { folder_.write("scene.json", kCommandScene); }

  CommandOptions here() const {
    CommandOptions options;
    options.folder = folder_.path();
    return options;
  }
  CommandResult run(const std::vector<std::string>& arguments) const {
    return run_morsel(arguments, here());
  }
  // The shortest of a few runs: what other work does to one of them must not put kills after the
  // end of the rest.
  double seconds(const std::vector<std::string>& arguments, const char* output) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      std::filesystem::remove(folder_ / output);
      const auto start = std::chrono::steady_clock::now();
      EXPECT_EQ(run(arguments).code, 0);
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      shortest = std::min(shortest, took.count());
    }
    return shortest;
  }
  // Whether it was killed before its end.
  bool run_and_kill(const std::vector<std::string>& arguments, double after) const {
    CommandOptions options = here();
    options.then = [after](int pid, const std::filesystem::path&) {
      std::this_thread::sleep_for(std::chrono::duration<double>(after));
      ::kill(pid, SIGKILL);
    };
    return run_morsel(arguments, options).code == 128 + SIGKILL;
  }

  TemporaryFolder folder_;
  std::mt19937 random_{7};
};

const std::vector<std::string> kBuild{"cache", "build",   "scene.json", "--engine",
                                      "both",  "--quiet", "-o",         "a.topo"};
const std::vector<std::string> kRender{"render", "scene.json", "--spp", "64",   "--cache",
                                       "a.topo", "--quiet",    "-o",    "a.exr"};

TEST_F(CrashTest, KilledBuildsLeaveNoCacheOrAGoodOne) {
  const double whole = seconds(kBuild, "a.topo");
  const std::string before = run({"cache", "info", "a.topo", "--json"}).out;
  int killed = 0;
  for (int i = 0; i < kKills; ++i) {
    // Every other time there is a cache of another field to be replaced.
    std::filesystem::remove(folder_ / "a.topo");
    const bool stale = i % 2 == 0;
    if (stale) {
      std::vector<std::string> other = kBuild;
      other.insert(other.end(), {"--set", "geometries.rock.field.density.radius=0.9"});
      ASSERT_EQ(run(other).code, 0);
    }
    const double after = std::uniform_real_distribution<double>(0.0, 1.1)(random_) * whole;
    killed += run_and_kill(kBuild, after);
    if (stale || std::filesystem::exists(folder_ / "a.topo")) {
      EXPECT_EQ(run({"cache", "info", "a.topo"}).code, 0) << "killed after " << after << " s";
    }
    const CommandResult again = run(kBuild);
    ASSERT_EQ(again.code, 0) << "killed after " << after << " s: " << again.err;
    EXPECT_EQ(run({"cache", "verify", "a.topo", "scene.json"}).code, 0);
  }
  EXPECT_GT(killed, kKills / 4);
  EXPECT_FALSE(before.empty());
  RecordProperty("killed", killed);
}

TEST_F(CrashTest, KilledRendersLeaveTheOldPictureOrTheNewOne) {
  ASSERT_EQ(run(kBuild).code, 0);
  const double whole = seconds(kRender, "a.exr");
  const std::string good = exr_pixels(folder_ / "a.exr");
  std::vector<std::string> old_render = kRender;
  old_render[3] = "3";
  ASSERT_EQ(run(old_render).code, 0);
  const std::string old_exr = read_text(folder_ / "a.exr"), old_png = read_text(folder_ / "a.png");
  ASSERT_NE(exr_pixels(folder_ / "a.exr"), good);
  int killed = 0;
  for (int i = 0; i < kKills; ++i) {
    folder_.write("a.exr", old_exr);
    folder_.write("a.png", old_png);
    // Pictures are written at the end: most kills are there.
    const double after =
        std::uniform_real_distribution<double>(i % 3 ? 0.8 : 0.0, 1.1)(random_) * whole;
    killed += run_and_kill(kRender, after);
    const std::string exr = read_text(folder_ / "a.exr");
    EXPECT_TRUE(exr == old_exr || exr_pixels(folder_ / "a.exr") == good)
        << "killed after " << after << " s";
    const std::string png = read_text(folder_ / "a.png");
    EXPECT_NE(png.find("IEND"), std::string::npos) << "killed after " << after << " s";
  }
  EXPECT_GT(killed, kKills / 4);
  RecordProperty("killed", killed);
}

// Each writes a file of its own and renames it: the last one wins, and any of them is right.
TEST_F(CrashTest, SeveralBuildersOfOneCache) {
  std::vector<CommandResult> results(6);
  std::vector<std::thread> builders;
  for (CommandResult& result : results) builders.emplace_back([&] { result = run(kBuild); });
  for (std::thread& builder : builders) builder.join();
  for (const CommandResult& result : results) EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(run({"cache", "verify", "a.topo", "scene.json"}).code, 0);
  EXPECT_EQ(folder_.count_files(), 2u);  // the scene, the cache, and nothing temporary
}

TEST_F(CrashTest, FullDisksKeepWhatWasThere) {
  ASSERT_EQ(run(kBuild).code, 0);
  ASSERT_EQ(run(kRender).code, 0);
  const std::string cache = read_text(folder_ / "a.topo"), exr = read_text(folder_ / "a.exr");
  CommandOptions full = here();
  for (const std::uint64_t limit : {1u, 100u, 1000u, 4000u}) {
    full.file_limit = limit;
    std::vector<std::string> build = kBuild;
    build.emplace_back("--force");
    const CommandResult built = run_morsel(build, full);
    EXPECT_EQ(built.code, 1) << limit;
    // Messages go to a file as well.
    const bool readable = limit >= 1000;
    if (readable) {
      EXPECT_NE(built.err.find("a.topo"), std::string::npos) << built.err;
    }
    const CommandResult rendered = run_morsel(kRender, full);
    EXPECT_EQ(rendered.code, 1) << limit;
    if (readable) {
      EXPECT_NE(rendered.err.find("a.exr"), std::string::npos) << rendered.err;
    }
    EXPECT_EQ(read_text(folder_ / "a.topo"), cache) << limit;
    EXPECT_EQ(read_text(folder_ / "a.exr"), exr) << limit;
    EXPECT_EQ(folder_.count_files(), 5u) << limit;  // scene, cache, bricks, EXR, PNG
  }
}

// A disk that has no room left, not only a file that may not grow.
TEST_F(CrashTest, ADiskWithoutRoomKeepsWhatWasThere) {
  const SmallDisk disk(folder_.path(), 4u << 20);
  if (!disk.mounted()) GTEST_SKIP() << "mounting a file system takes root or user name spaces";
  folder_.write("scene.json", kCommandScene);
  ASSERT_EQ(run(kBuild).code, 0);
  ASSERT_EQ(run(kRender).code, 0);
  const std::string cache = read_text(folder_ / "a.topo"), png = read_text(folder_ / "a.png");
  const std::string pixels = exr_pixels(folder_ / "a.exr");
  std::vector<std::string> build = kBuild;
  build.emplace_back("--force");
  int failures = 0;
  for (const std::size_t room : {0u, 4096u, 8192u, 16384u, 32768u}) {
    disk.fill_but(room);
    const auto expect_kept = [&](const CommandResult& result, const char* file) {
      if (result.code != 0) {
        EXPECT_EQ(result.code, 1) << room;
        EXPECT_NE(result.err.find(file), std::string::npos) << result.err;
        EXPECT_NE(result.err.find("No space left"), std::string::npos) << result.err;
        ++failures;
        EXPECT_TRUE(read_text(folder_ / "a.topo") == cache) << room;
        // There may be room for the one picture and not for the other.
        EXPECT_TRUE(exr_pixels(folder_ / "a.exr") == pixels) << room;
        EXPECT_TRUE(read_text(folder_ / "a.png") == png) << room;
      }
      EXPECT_EQ(folder_.count_files(), 6u) << room;  // scene, cache, bricks, EXR, PNG, filler
    };
    expect_kept(run_morsel(build, here()), "a.topo");
    if (failures == 0) break;  // there was room: what follows would tell nothing
    expect_kept(run_morsel(kRender, here()), room < 32768 ? "a.exr" : "a.");
  }
  EXPECT_GE(failures, 4);
  disk.clear();
  EXPECT_EQ(run(build).code, 0);
  EXPECT_EQ(run(kRender).code, 0);
  EXPECT_TRUE(exr_pixels(folder_ / "a.exr") == pixels);
}

}  // namespace
}  // namespace morsel::test
