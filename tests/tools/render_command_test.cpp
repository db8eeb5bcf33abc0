// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

class RenderCommandTest : public ::testing::Test {
 protected:
  CommandResult render(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"render", "scene.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    CommandOptions options;
    options.folder = folder_.path();
    return run_morsel(arguments, options);
  }

  bool exists(const char* name) const { return std::filesystem::exists(folder_ / name); }

  TemporaryFolder folder_;
  std::filesystem::path scene_ = folder_.write("scene.json", kCommandScene);
};

TEST_F(RenderCommandTest, WritesPictureAndPreviewAndNamesThem) {
  const CommandResult result = render();
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.out, "scene.exr\nscene.png\n");
  EXPECT_TRUE(exists("scene.exr"));
  EXPECT_TRUE(exists("scene.png"));
  EXPECT_EQ(folder_.count_files(), 5u);  // the scene, two pictures, the cache, its bricks
  EXPECT_EQ(read_text(folder_ / "scene.exr").substr(0, 4), "\x76\x2f\x31\x01");
  EXPECT_EQ(read_text(folder_ / "scene.png").substr(1, 3), "PNG");
}

TEST_F(RenderCommandTest, NamesOfOutputsAreTheUsers) {
  ASSERT_EQ(render({"-o", "a.exr", "--no-png"}).code, 0);
  EXPECT_TRUE(exists("a.exr"));
  EXPECT_FALSE(exists("a.png"));
  ASSERT_EQ(render({"-o", "b.exr", "--png", "c.png", "--cache", "d.topo"}).code, 0);
  EXPECT_TRUE(exists("c.png"));
  EXPECT_TRUE(exists("d.topo"));
}

// A surface so bright that its light overflows: black in the picture, said on stderr, listed in the
// statistics; an error when that was asked for.
TEST_F(RenderCommandTest, SamplesThatAreNotFiniteAreReportedOrStopTheRender) {
  json scene = json::parse(kCommandScene);
  std::string image = "PF\n1 1\n-1.0\n";
  const float hot[3] = {3e38f, 1.0f, 1.0f};
  image.append(reinterpret_cast<const char*>(hot), sizeof hot);
  folder_.write("hot.pfm", image);
  scene["textures"] = json::parse(R"([{"name": "hot", "type": "image", "file": "hot.pfm"}])");
  scene["materials"].push_back(json::parse(
      R"({"name": "hot", "type": "principled", "emission": 1000, "emission_texture": "hot"})"));
  scene["instances"][1]["material"] = "hot";
  folder_.write("scene.json", scene.dump());

  const CommandResult whole = render({"--stats", "json"});
  ASSERT_EQ(whole.code, 0) << whole.err;
  EXPECT_NE(whole.err.find("not finite: pixel "), std::string::npos) << whole.err;
  const json samples = json::parse(whole.out)["samples"];
  ASSERT_GT(samples["non_finite"], 0);
  ASSERT_FALSE(samples["non_finite_places"].empty());
  for (const json& place : samples["non_finite_places"]) {
    EXPECT_LT(place["pixel"][0], 32);
    EXPECT_LE(place["bounce"], 3);
  }

  const CommandResult stopped = render({"--stop-at-nan"});
  EXPECT_EQ(stopped.code, 1);
  EXPECT_NE(stopped.err.find("after bounce"), std::string::npos) << stopped.err;
}

TEST_F(RenderCommandTest, StatisticsAreOneDocument) {
  const CommandResult result =
      render({"--stats", "json", "--spp", "3", "--crop", "4,5,20,15", "--threads", "2"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json statistics = json::parse(result.out);
  EXPECT_EQ(statistics["spp"], 3);
  EXPECT_EQ(statistics["window"], json({4, 5, 20, 15}));
  EXPECT_EQ(statistics["samples"]["total"], 16 * 10 * 3);
  EXPECT_EQ(statistics["samples"]["non_finite"], 0);
  EXPECT_EQ(statistics["rays"]["camera"], 16 * 10 * 3);
  std::uint64_t counted = 0;
  for (const json& n : statistics["rays"]["cost"]["camera"]["histogram"])
    counted += n.get<std::uint64_t>();
  EXPECT_EQ(counted, 16 * 10 * 3);
  EXPECT_GT(statistics["rays"]["cost"]["camera"]["evaluations"], 0);
  EXPECT_EQ(statistics["rays"]["cost"]["camera"]["filter_calls"], 0);
  EXPECT_EQ(statistics["end"], "done");
  EXPECT_GT(statistics["memory"]["peak"], 1000000);
  EXPECT_GT(statistics["efficiency"]["per_second"], 0.0);
  EXPECT_EQ(statistics["efficiency"]["threads"], 2);
  EXPECT_TRUE(statistics["texture_cache"].empty());
  EXPECT_EQ(statistics["hypertextures"][0]["geometry"], "rock");
  EXPECT_EQ(statistics["hypertextures"][0]["cache_built"], true);
  EXPECT_EQ(statistics["hypertextures"][0]["kept"], 1);

  ASSERT_EQ(render({"--stats", "json:stats.json", "--keep", "all"}).code, 0);
  const json file = json::parse(read_text(folder_ / "stats.json"));
  EXPECT_EQ(file["hypertextures"][0]["cache_built"], false);
  EXPECT_EQ(file["hypertextures"][0]["kept"], file["hypertextures"][0]["components"]);
  EXPECT_NE(render({"--stats", "text"}).out.find("samples"), std::string::npos);
}

TEST_F(RenderCommandTest, PixelsDependNeitherOnThreadsNorOnStreams) {
  ASSERT_EQ(render({"-o", "a.exr", "--threads", "1", "--quiet"}).code, 0);
  ASSERT_EQ(render({"-o", "b.exr", "--threads", "2", "--progress", "json"}).code, 0);
  EXPECT_EQ(read_text(folder_ / "a.png"), read_text(folder_ / "b.png"));
  ASSERT_EQ(render({"-o", "c.exr", "--seed", "5"}).code, 0);
  EXPECT_NE(read_text(folder_ / "a.png"), read_text(folder_ / "c.png"));
}

TEST_F(RenderCommandTest, ProgressIsOfAllThatTakesLong) {
  const CommandResult result = render({"--progress", "json"});
  ASSERT_EQ(result.code, 0) << result.err;
  for (const char* phase : {"topology: labelling", "surface: bricks", "rendering"})
    EXPECT_NE(result.err.find("\"phase\":\"" + std::string(phase) + "\""), std::string::npos)
        << phase << '\n'
        << result.err;
}

// What is read is what was made: the same picture, without the phase that makes it.
TEST_F(RenderCommandTest, BricksAreKeptForTheNextRender) {
  const auto bricks_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--stats", "json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = render(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    return json::parse(result.out)["hypertextures"][0]["bricks_read"].get<bool>();
  };
  EXPECT_FALSE(bricks_of({"-o", "a.exr", "--max-brick-file", "0"}));
  EXPECT_FALSE(bricks_of({"-o", "b.exr"}));
  EXPECT_TRUE(bricks_of({"-o", "c.exr"}));
  EXPECT_FALSE(bricks_of({"--max-brick-file", "0"}));
  EXPECT_FALSE(bricks_of({"--max-brick-file", "0.000001", "--keep", "all"}));
  EXPECT_FALSE(bricks_of({"--keep", "all"}));
  EXPECT_TRUE(bricks_of({"--keep", "all"}));
  EXPECT_EQ(read_text(folder_ / "a.png"), read_text(folder_ / "b.png"));
  EXPECT_EQ(read_text(folder_ / "a.png"), read_text(folder_ / "c.png"));
  const CommandResult again = render({"--progress", "json"});
  EXPECT_EQ(again.err.find("surface: bricks"), std::string::npos) << again.err;

  // Two caches whose names differ in what looks like an extension.
  EXPECT_FALSE(bricks_of({"--cache", "rock.v1"}));
  EXPECT_FALSE(bricks_of({"--cache", "rock.v2"}));
  EXPECT_TRUE(bricks_of({"--cache", "rock.v1"}));

  // Damaged ones are told and made anew.
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
    if (entry.path().extension() == ".bricks") std::filesystem::resize_file(entry.path(), 1000);
  const CommandResult damaged = render({"-o", "d.exr"});
  EXPECT_EQ(damaged.code, 0);
  EXPECT_NE(damaged.err.find(".bricks: truncated"), std::string::npos) << damaged.err;
  EXPECT_EQ(read_text(folder_ / "a.png"), read_text(folder_ / "d.png"));
}

TEST_F(RenderCommandTest, CheckReportsEveryProblemAndRendersNothing) {
  EXPECT_EQ(render({"--check"}).out, "scene.json: valid\n");
  const CommandResult bad = render({"--check", "--spp", "0", "--keep", "most"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_NE(bad.out.find("/render/spp"), std::string::npos) << bad.out;
  EXPECT_NE(bad.out.find("/geometries/0/keep"), std::string::npos) << bad.out;
  EXPECT_EQ(folder_.count_files(), 1u);

  const CommandResult command =
      run_morsel({"scene", "check", scene_.string(), "--set", "camera.fov=3", "--json"});
  EXPECT_EQ(command.code, 2);
  const json document = json::parse(command.out);
  EXPECT_EQ(document["valid"], false);
  EXPECT_EQ(document["problems"].size(), 1u);
}

TEST_F(RenderCommandTest, ImagesThatAreNoneAreFoundByTheCheck) {
  folder_.write("sky.exr", "not an image");
  const CommandResult result = render({"--check", "--set", "lights.0.file=sky.exr"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.out.find("/lights/0/file"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("sky.exr"), std::string::npos) << result.out;
}

TEST_F(RenderCommandTest, OutputsThatCannotBeWrittenFailFirst) {
  const CommandResult result = render({"-o", "gone/a.exr"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("gone/a.exr"), std::string::npos) << result.err;
  const CommandResult folder = render({"-o", "gone/"});
  EXPECT_EQ(folder.code, 1);
  EXPECT_NE(folder.err.find("-o gone/: no such folder; make it first"), std::string::npos)
      << folder.err;
  // A scene that is missing is wrong usage, whatever the disk is like.
  const CommandResult scene = render({"second.json", "-o", "gone/"});
  EXPECT_EQ(scene.code, 2);
  EXPECT_NE(scene.err.find("second.json"), std::string::npos) << scene.err;
  EXPECT_EQ(folder_.count_files(), 1u);
}

TEST_F(RenderCommandTest, CacheForSeveralHypertexturesIsRefused) {
  const CommandResult result = render(
      {"--cache", "a.topo", "--set",
       R"(geometries.floor={"name": "floor", "type": "hypertexture", "field": {"density": {"type": "sphere"}}})"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("geometries.NAME.cache"), std::string::npos) << result.err;
}

TEST_F(RenderCommandTest, SeveralScenesGoIntoOneFolder) {
  folder_.write("other/scene2.json", kCommandScene);
  std::filesystem::create_directory(folder_ / "out");
  const CommandResult good = render({"other/scene2.json", "-o", "out/", "--stats", "json:s.json"});
  ASSERT_EQ(good.code, 0) << good.err;
  EXPECT_EQ(good.out, "out/scene.exr\nout/scene.png\nout/scene2.exr\nout/scene2.png\n");
  EXPECT_EQ(exr_pixels(folder_ / "out/scene.exr"), exr_pixels(folder_ / "out/scene2.exr"));
  const json statistics = json::parse(read_text(folder_ / "s.json"));
  ASSERT_EQ(statistics.size(), 2u);
  EXPECT_EQ(statistics[1]["scene"], "other/scene2.json");

  EXPECT_EQ(render({"other/scene2.json", "-o", "a.exr"}).code, 2);
  EXPECT_EQ(render({"other/scene2.json", "--cache", "a.topo"}).code, 2);
  // The same name twice.
  folder_.write("other/scene.json", kCommandScene);
  const CommandResult same = render({"other/scene.json"});
  EXPECT_EQ(same.code, 2);
  EXPECT_NE(same.err.find("would both write scene.exr"), std::string::npos) << same.err;
}

// One that fails does not keep the others from being rendered, and is not forgotten.
TEST_F(RenderCommandTest, AFailureAmongSeveralScenesIsTheExitCode) {
  json bad = json::parse(kCommandScene);
  bad["geometries"][0]["cache"] = "wrong.topo";
  folder_.write("bad.json", bad.dump());
  folder_.write("wrong.topo", "not a cache");
  const CommandResult result =
      run_morsel({"render", "bad.json", "scene.json"}, {.folder = folder_.path()});
  EXPECT_EQ(result.code, 1) << result.err;
  EXPECT_NE(result.err.find("wrong.topo"), std::string::npos) << result.err;
  EXPECT_EQ(result.out, "scene.exr\nscene.png\n");
  EXPECT_FALSE(exists("bad.exr"));
}

TEST_F(RenderCommandTest, EnvironmentsAreFoundBesideTheScene) {
  const std::filesystem::path assets = std::filesystem::path(MORSEL_SOURCE_DIR) / "scenes/assets";
  folder_.write("deep/scene3.json", kCommandScene);
  std::filesystem::create_directory(folder_ / "deep/sky");
  std::filesystem::copy_file(assets / "studio.exr", folder_ / "deep/sky/studio.exr");
  const CommandResult result = run_morsel(
      {"render", "deep/scene3.json", "--set", "lights.0.file=sky/studio.exr", "--spp", "1"},
      {.folder = folder_.path()});
  EXPECT_EQ(result.code, 0) << result.err;
}

TEST_F(RenderCommandTest, TimeLimitEndsARenderThatIsDone) {
  const CommandResult good =
      render({"--spp", "1000000", "--time-limit", "0.2s", "--stats", "json"});
  ASSERT_EQ(good.code, 0) << good.err;
  const json statistics = json::parse(good.out);
  EXPECT_EQ(statistics["end"], "time_limit");
  EXPECT_GE(statistics["samples"]["total"], 32 * 24);
  EXPECT_LT(statistics["samples"]["total"], 32 * 24 * 1000000ull);
  EXPECT_NE(good.err.find("time is up"), std::string::npos) << good.err;
}

TEST_F(RenderCommandTest, WrongValuesOfFlagsNameTheChoices) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--time-limit", "soon"}, "90s, 15m or 1.5h"},
      {{"--time-limit", "0"}, "90s, 15m or 1.5h"},
      {{"--time-limit", "5d"}, "90s, 15m or 1.5h"},
      {{"--shard", "2/2"}, "counted from 0"},
      {{"--shard", "1"}, "INDEX/COUNT"},
      {{"--shard", "0/3"}, "2 samples a pixel"},
      {{"--checkpoint-interval", "0%"}, "2%"},
      {{"--checkpoint-interval", "often"}, "90s, 15m or 1.5h"},
      {{"--checkpoint", "a.exr"}, "files of their own"},
      {{"--resume"}, "--checkpoint"},
      {{"--preview", "a.jpg"}, "tev:HOST:PORT"},
      {{"--preview", "tev:here:many"}, "tev:HOST:PORT"},
      {{"--debug-pixel", "1"}, "x,y"},
      {{"--debug-pixel", "32,0"}, "32 x 24"},
      {{"--solver", "fastest"}, "model"},
      {{"--membership", "maybe"}, "streamline"},
  };
  for (const auto& [flags, words] : cases) {
    const CommandResult result = render(flags);
    EXPECT_EQ(result.code, 2) << flags[0] << ": " << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(flags[0]), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(exists("scene.exr"));
  }
}

TEST_F(RenderCommandTest, SolversAndMembershipsShowTheSamePicture) {
  ASSERT_EQ(render({"-o", "a.exr", "--spp", "1"}).code, 0);
  ASSERT_EQ(render({"-o", "b.exr", "--spp", "1", "--solver", "segment"}).code, 0);
  ASSERT_EQ(render({"-o", "c.exr", "--spp", "1", "--keep", "all"}).code, 0);
  EXPECT_NE(exr_pixels(folder_ / "a.exr"), exr_pixels(folder_ / "c.exr"));
}

TEST_F(RenderCommandTest, DebugPixelListsSamplesAndRays) {
  const CommandResult result = render({"--debug-pixel", "16,12", "--spp", "3"});
  ASSERT_EQ(result.code, 0) << result.err;
  for (const char* words : {"sample 0: at 16.", "sample 2: at 16.", "hits rock (grey) at ",
                            "component ", "  camera ray from 0 0 6 ", "mean of 3 samples",
                            ", hits rock at a distance of ", ", hits nothing\n"})
    EXPECT_NE(result.out.find(words), std::string::npos) << words << "\n" << result.out;
  EXPECT_FALSE(exists("scene.exr"));
}

TEST_F(RenderCommandTest, DebugPixelSaysWhatBecameOfShadowRays) {
  const auto lit_by = [&](const std::string& light, const char* pixel,
                          const std::vector<std::string>& more = {}) {
    std::vector<std::string> flags{"--debug-pixel",           pixel, "--spp", "1", "--set",
                                   "lights=[{" + light + "}]"};
    flags.insert(flags.end(), more.begin(), more.end());
    const CommandResult result = render(flags);
    EXPECT_EQ(result.code, 0) << result.err;
    return result.out;
  };
  const auto has = [](const std::string& text, const char* words) {
    return text.find(words) != std::string::npos;
  };
  // The rock from the front, and the floor in its shadow.
  const std::string front = R"("type": "point", "intensity": 9, "position": [0, 0, 6])",
                    above = R"("type": "point", "intensity": 9, "position": [0, 9, 0])",
                    sun = R"("type": "distant", "irradiance": 1, "direction": [0, 0, -1])";
  for (const std::string& light : {front, sun}) {
    const std::string out = lit_by(light, "16,12");
    EXPECT_TRUE(has(out, "  shadow ray ") && has(out, ", reaches its light\n")) << out;
  }
  const std::string below = lit_by(above, "16,22");
  EXPECT_TRUE(has(below, ", is blocked by rock at a distance of ")) << below;
  EXPECT_FALSE(has(below, "reaches its light")) << below;
  // Half of the light comes through a veil, all of it is asked for.
  const std::string veil =
      R"(materials=[{"name": "grey", "type": "diffuse"},
                    {"name": "veil", "type": "principled", "opacity": 0.5}])";
  const std::string veiled = lit_by(front, "16,12",
                                    {"--set", veil, "--set",
                                     R"(instances=[{"geometry": "rock", "material": "grey"},
                     {"geometry": "floor", "name": "veil", "material": "veil",
                      "rotate": [90, 0, 0], "translate": [0, 0, 4], "visible_to_camera": false}])"});
  EXPECT_TRUE(has(veiled, ", meets nothing solid\n")) << veiled;
  EXPECT_TRUE(has(veiled, "  cut-out ray ") && has(veiled, ", hits veil at a distance of "))
      << veiled;
  EXPECT_TRUE(has(veiled, ", reaches its light\n")) << veiled;
}

TEST_F(RenderCommandTest, FullDisksAreFailuresThatLeaveNothing) {
  ASSERT_EQ(run_morsel({"cache", "build", scene_.string()}).code, 0);
  CommandOptions options;
  options.folder = folder_.path();
  options.file_limit = 2000;
  const CommandResult result =
      run_morsel({"render", "scene.json", "--checkpoint", "a.checkpoint", "-q"}, options);
  EXPECT_EQ(result.code, 1) << result.err;
  EXPECT_NE(result.err.find("scene.exr"), std::string::npos) << result.err;
  EXPECT_EQ(folder_.count_files(), 2u);
}

TEST_F(RenderCommandTest, FoldersThatAreReadOnlyAreFoundFirst) {
  const std::filesystem::path locked = folder_ / "locked";
  std::filesystem::create_directory(locked);
  using std::filesystem::perms;
  std::filesystem::permissions(locked, perms::owner_read | perms::owner_exec | perms::group_read |
                                           perms::group_exec | perms::others_read |
                                           perms::others_exec);
  std::filesystem::permissions(folder_.path(), perms::all);
  CommandOptions options;
  options.folder = folder_.path();
  options.unprivileged = true;
  // Where "/" itself is closed to other users (a chroot made by root), they can run nothing.
  constexpr int kCannotRun = 127;
  const CommandResult help = run_morsel({"field", "--help"}, options);
  if (help.code == kCannotRun) GTEST_SKIP() << "another user can run no program here";
  // Else the renders below would fail for another reason.
  ASSERT_EQ(help.code, 0);
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"-o", "locked/a.exr"},
                                             {"--checkpoint", "locked/a.checkpoint"},
                                             {"--preview", "locked/a.png"},
                                             {"--stats", "json:locked/s.json"}}) {
    std::vector<std::string> arguments{"render", "scene.json"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const CommandResult result = run_morsel(arguments, options);
    EXPECT_EQ(result.code, 1) << flags[0];
    EXPECT_NE(result.err.find("locked/"), std::string::npos) << result.err;
    EXPECT_EQ(folder_.count_files(), 1u);
  }
}

// Even root may not write there, whatever its rights say.
TEST_F(RenderCommandTest, PlacesThatTakeNoFilesAreFoundFirst) {
  CommandOptions options;
  options.folder = folder_.path();
  const std::string long_name(250, 'x');
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"-o", "/proc/a.exr"},
                                             {"--png", "/proc/a.png"},
                                             {"--checkpoint", "/proc/a.checkpoint"},
                                             {"--preview", "/proc/a.png"},
                                             {"--stats", "json:/proc/s.json"},
                                             {"-o", long_name + "/a.exr"},
                                             {"-o", long_name + ".exr"}}) {
    std::vector<std::string> arguments{"render", "scene.json", "--progress", "plain"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const CommandResult result = run_morsel(arguments, options);
    EXPECT_EQ(result.code, 1) << flags[1];
    EXPECT_NE(result.err.find(": cannot write: "), std::string::npos) << result.err;
    EXPECT_EQ(result.err.find("rendering"), std::string::npos) << result.err;
    EXPECT_EQ(folder_.count_files(), 1u);
  }
}

TEST_F(RenderCommandTest, ASceneWithoutLightSaysSo) {
  const std::vector<std::string> dark{"--set", "lights=[]"};
  const CommandResult result = render(dark);
  EXPECT_EQ(result.code, 0) << result.err;
  const std::size_t at = result.err.find("nothing shines");
  EXPECT_NE(at, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("nothing shines", at + 1), std::string::npos) << result.err;
  EXPECT_EQ(render({}).err.find("nothing shines"), std::string::npos);
}

}  // namespace
}  // namespace morsel::test
