// SPDX-License-Identifier: Apache-2.0
// Flags that no other test uses: each does what it says.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

class FlagEffectsTest : public ::testing::Test {
 protected:
  FlagEffectsTest() { folder_.write("scene.json", kCommandScene); }

  CommandResult run(const std::vector<std::string>& arguments) const {
    CommandOptions options;
    options.folder = folder_.path();
    return run_morsel(arguments, options);
  }
  bool exists(const char* name) const { return std::filesystem::exists(folder_ / name); }

  TemporaryFolder folder_;
};

TEST_F(FlagEffectsTest, BenchTopologyComparesLabelsWithEvaluation) {
  const CommandResult result = run(
      {"bench", "topology", "scene.json", "--geometry", "rock", "--resolution", "20", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json info = json::parse(result.out);
  EXPECT_EQ(info["geometry"], "rock");
  EXPECT_EQ(info["resolution"], 32);  // rounded up to a multiple of 16
  EXPECT_EQ(info["components"], 5);
  EXPECT_EQ(info["certified"], true);
  // A ball of about radius 1 in a box of side 5 or a little more.
  EXPECT_GT(info["positive_voxels"], 32 * 32 * 32 / 100);
  EXPECT_LT(info["positive_voxels"], 32 * 32 * 32 / 5);
  EXPECT_NEAR(info["labels_vs_evaluation"].get<double>(),
              info["label_seconds"].get<double>() / info["evaluate_seconds"].get<double>(), 1e-6);
  EXPECT_EQ(run({"bench", "topology", "scene.json", "--geometry", "floor"}).code, 2);
}

TEST_F(FlagEffectsTest, MergeWritesThePreviewWhereItIsTold) {
  ASSERT_EQ(run({"render", "scene.json", "--shard", "0/2", "-o", "part_0.exr"}).code, 0);
  ASSERT_EQ(run({"render", "scene.json", "--shard", "1/2", "-o", "part_1.exr"}).code, 0);
  const CommandResult named =
      run({"merge", "part_0.exr", "part_1.exr", "-o", "a.exr", "--png", "view.png"});
  EXPECT_EQ(named.out, "a.exr\nview.png\n") << named.err;
  EXPECT_EQ(read_text(folder_ / "view.png").substr(1, 3), "PNG");
  EXPECT_FALSE(exists("a.png"));
  const CommandResult none = run({"merge", "part_0.exr", "part_1.exr", "-o", "b.exr", "--no-png"});
  EXPECT_EQ(none.out, "b.exr\n") << none.err;
  EXPECT_FALSE(exists("b.png"));
  EXPECT_EQ(run({"merge", "part_0.exr", "-o", "c.exr", "--png", "c.png", "--no-png"}).code, 2);
}

// Either there is a denoised layer or it is said why not.
TEST_F(FlagEffectsTest, DenoiseWritesALayerOrSaysThatItCannot) {
  const CommandResult result = run({"render", "scene.json", "--denoise", "-o", "a.exr"});
  ASSERT_EQ(result.code, 0) << result.err;
  const bool layer = read_text(folder_ / "a.exr").find("denoised.R") != std::string::npos;
  const bool warned = result.err.find("no Open Image Denoise") != std::string::npos;
  EXPECT_NE(layer, warned) << result.err;
  const std::string help = run({"render", "--help"}).out;
  EXPECT_EQ(help.find("This build has no Open Image Denoise") != std::string::npos, warned);
  ASSERT_EQ(run({"render", "scene.json", "-o", "b.exr"}).code, 0);
  EXPECT_EQ(read_text(folder_ / "b.exr").find("denoised.R"), std::string::npos);
}

TEST_F(FlagEffectsTest, ExportsHaveTheSizeTheyAreTold) {
  ASSERT_EQ(run({"cache", "build", "scene.json", "--engine", "both", "-o", "rock.topo", "-q"}).code,
            0);
  const auto exported = [&](std::vector<std::string> flags, const char* file) {
    flags.insert(flags.begin(), {"cache", "export"});
    flags.insert(flags.end(), {"rock.topo", "-o", file});
    const CommandResult result = run(flags);
    EXPECT_EQ(result.code, 0) << result.err;
    return read_text(folder_ / file);
  };
  // The longer side is what was asked for.
  const std::string svg = exported({"--svg", "--pixels", "321"}, "a.svg");
  const std::size_t tag = svg.find("<svg");
  const std::string head = svg.substr(tag, svg.find('>', tag) - tag);
  EXPECT_TRUE(head.find("width=\"321\"") != std::string::npos ||
              head.find("height=\"321\"") != std::string::npos)
      << head;
  // As many triangles, elsewhere. A list does not swallow the file behind it.
  const std::string thin = exported({"--ply", "--radius", "0.01", "--parts", "maxima"}, "a.ply"),
                    thick = exported({"--ply", "--radius", "0.05", "--parts", "maxima"}, "b.ply"),
                    again = exported({"--ply", "--radius", "0.01", "--parts", "maxima"}, "c.ply");
  EXPECT_EQ(thin, again);
  EXPECT_NE(thin, thick);
  EXPECT_EQ(run({"cache", "export", "rock.topo", "--ply", "--radius", "0", "-o", "d.ply"}).code, 2);
}

TEST_F(FlagEffectsTest, VerifyDrawsOtherCellsWithAnotherSeed) {
  ASSERT_EQ(run({"cache", "build", "scene.json", "-o", "rock.topo", "-q"}).code, 0);
  const auto proved = [&](const char* seed) {
    const CommandResult result = run({"cache", "verify", "rock.topo", "scene.json", "--samples",
                                      "40", "--seed", seed, "--json", "-q"});
    EXPECT_EQ(result.code, 0) << result.err;
    const json info = json::parse(result.out);
    return std::pair(info["cells_proved"].get<int>(), info["faces_proved"].get<int>());
  };
  EXPECT_EQ(proved("1"), proved("1"));
  const std::set<std::pair<int, int>> draws{proved("1"), proved("2"), proved("3"), proved("4")};
  EXPECT_GT(draws.size(), 1u);
}

}  // namespace
}  // namespace morsel::test
