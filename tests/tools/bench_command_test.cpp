// SPDX-License-Identifier: Apache-2.0
// What the benchmark says, not how fast it is.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

class BenchCommandTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string rock_ = folder_.write("rock.json", kCommandScene).string();
};

TEST_F(BenchCommandTest, HasTheKeysThatOthersRelyOn) {
  const CommandResult result =
      run_morsel({"bench", rock_, "--error", "0.01", "--resolution", "64", "--repetitions", "1",
                  "--render-width", "32", "--render-spp", "2", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json info = json::parse(result.out);  // one document and nothing else
  const json& v = info["vs_mesh"];
  for (const char* kind : {"primary", "incoherent", "shadow"}) {
    EXPECT_GT(v[kind], 0.0) << kind;
    EXPECT_GT(v["rays"][kind], 0) << kind;
  }
  EXPECT_GT(v["memory"], 0.0);
  EXPECT_GT(v["ready_time"], 0.0);
  EXPECT_GT(v["error"], 0.0);
  EXPECT_LE(v["mesh"]["error_bound"], v["error"]);
  // The two surfaces are the same: few rays graze so closely that they tell them apart.
  EXPECT_LT(v["differs"]["primary"]["one_hits"], 0.05);
  EXPECT_LT(v["differs"]["primary"]["far_apart"], 0.05);
  EXPECT_GT(v["hits"]["primary"], 0.05);
  EXPECT_EQ(v["rays"]["primary"], 64 * 64);
  // A camera ray a sample at least; and rays are some of the render, but not all.
  EXPECT_GE(info["renderer"]["rays"], 32 * 24 * 2);
  // So short a render's time, less that of building its scene, may come out as anything.
  EXPECT_TRUE(info["renderer_efficiency"].is_number());
  EXPECT_GT(info["renderer"]["replay_seconds"], 0.0);
  // A solver that evaluates nothing would not be one.
  for (const char* solver : {"sphere", "segment", "model"})
    ASSERT_TRUE(info["evaluations_per_ray"].contains(solver)) << solver;
  EXPECT_GT(info["evaluations_per_ray"]["sphere"], info["evaluations_per_ray"]["model"]);
  for (const auto& [solver, count] : info["evaluations_per_ray"].items())
    EXPECT_GT(count, 0.0) << solver;
}

TEST_F(BenchCommandTest, AMeshSceneHasItsRenderMeasured) {
  const std::string scene = folder_
                                .write("meshes.json",
                                       R"({"morsel": 1, "camera": {"position": [0, 1, 4]},
                     "render": {"resolution": [64, 48]},
                     "materials": [{"name": "m", "type": "diffuse"}],
                     "geometries": [{"name": "ball", "type": "sphere", "radius": 1}],
                     "instances": [{"name": "ball", "geometry": "ball", "material": "m"}],
                     "lights": [{"type": "environment"}]})")
                                .string();
  const CommandResult result = run_morsel({"bench", scene, "--repetitions", "1", "--render-width",
                                           "32", "--render-spp", "2", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json info = json::parse(result.out);
  EXPECT_FALSE(info.contains("vs_mesh"));
  EXPECT_GE(info["renderer"]["rays"], 32 * 24 * 2);
  EXPECT_GT(info["renderer_efficiency"], 0.0);
  EXPECT_EQ(run_morsel({"bench", scene, "--geometry", "ball"}).code, 2);
}

TEST_F(BenchCommandTest, NothingToMeasureIsAnError) {
  const CommandResult result =
      run_morsel({"bench", rock_, "--set", "geometries.rock.keep=volume:1000"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("nothing is kept"), std::string::npos) << result.err;
  EXPECT_EQ(run_morsel({"bench", rock_, "--error", "2"}).code, 2);
  EXPECT_EQ(run_morsel({"bench"}).code, 2);
}

// How often `part` is in `text`.
int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

TEST_F(BenchCommandTest, ThePageIsCompleteInItself) {
  const std::string page_file = (folder_ / "bench.html").string();
  const CommandResult result =
      run_morsel({"bench", rock_, "--error", "0.02", "--resolution", "32", "--repetitions", "1",
                  "--render-width", "32", "--render-spp", "4", "--scaling", "--layers", "2",
                  "--mixed", "--html", page_file, "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json info = json::parse(result.out);
  ASSERT_EQ(info["layers"].size(), 2u);
  EXPECT_EQ(info["layers"][1]["layers"], 2);
  EXPECT_GT(info["layers"][1]["components"], info["layers"][0]["components"]);
  EXPECT_GT(info["layers"][0]["evaluations_per_ray"], 0.0);
  ASSERT_FALSE(info["scaling"].empty());
  EXPECT_EQ(info["scaling"][0]["threads"], 1);
  EXPECT_EQ(info["scaling"][0]["speedup"], 1.0);

  const std::string page = read_text(page_file);
  EXPECT_EQ(page.rfind("<!DOCTYPE html>", 0), 0u);
  EXPECT_EQ(count_of(page, "<svg class=\"plot\""), 5);
  EXPECT_EQ(count_of(page, "<svg"), count_of(page, "</svg>"));
  EXPECT_EQ(count_of(page, "<rect"), 6);      // a bar for each ratio
  EXPECT_EQ(count_of(page, "<polyline"), 4);  // speed-up and ideal, labels, evaluations
  for (const char* bad : {"http://", "https://", "<script", "<link", ">nan<", ">inf<"})
    EXPECT_EQ(page.find(bad), std::string::npos) << bad;
  // Pictures are in it: the base64 of a PNG's first bytes.
  EXPECT_EQ(count_of(page, "src=\"data:image/png;base64,iVBORw0KGgo"), 2);
  EXPECT_EQ(count_of(page, "src="), 2);
  // The bars say what the document says.
  char value[32];
  std::snprintf(value, sizeof value, ">%.3g</text>", info["vs_mesh"]["primary"].get<double>());
  EXPECT_NE(page.find(value), std::string::npos) << value;
}

// Voxels, a mesh of them, critical points and certified labels, in numbers and in the page.
TEST_F(BenchCommandTest, ThePageComparesTheEnginesOfTopology) {
  const std::string page_file = (folder_ / "engines.html").string();
  const CommandResult result =
      run_morsel({"bench", "--engines", "16,64", rock_, "--error", "0.02", "--resolution", "16",
                  "--repetitions", "1", "--render-width", "16", "--render-spp", "1", "--html",
                  page_file, "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json rows = json::parse(result.out)["engines"];
  ASSERT_EQ(rows.size(), 6u);
  const std::string page = read_text(page_file);
  EXPECT_EQ(count_of(page, "<svg class=\"plot\""), 3);    // ratios, components, seconds
  EXPECT_EQ(count_of(page, "<polyline"), 8);              // four methods, twice
  EXPECT_EQ(count_of(page, "<circle"), 2 * (2 + 2 + 4));  // levels have two ends
  for (const json& row : rows) {
    const std::string engine = row["engine"];
    EXPECT_EQ(row["certified"], engine == "certified") << engine;
    const std::string resolution =
        row.contains("resolution") ? std::to_string(row["resolution"].get<int>()) : "";
    // The table says what was counted.
    EXPECT_NE(page.find("<tr><td>" + engine + "</td><td class=\"n\">" + resolution +
                        "</td><td class=\"n\">" + row["components"].dump() + "</td><td>" +
                        (engine == "certified" ? "yes" : "no") + "</td>"),
              std::string::npos)
        << engine;
    EXPECT_EQ(count_of(page, ">" + engine + "</text>"), 2) << engine;
  }
  // Both proofs agree; what coarse grids say need not.
  EXPECT_EQ(rows[0]["components"], rows[1]["components"]);
  // A level is level: the certified line has one height.
  const std::size_t line = page.find("<polyline");
  const std::string points = page.substr(line, page.find("fill", line) - line);
  const std::size_t first = points.find(','), second = points.find(',', first + 1);
  EXPECT_EQ(points.substr(first, points.find(' ', first) - first),
            points.substr(second, points.find(' ', second) - second))
      << points;
  EXPECT_EQ(run_morsel({"bench", rock_, "--engines", "1"}).code, 2);
  const CommandResult text =
      run_morsel({"bench", rock_, "--engines", "16", "--error", "0.02", "--resolution", "16",
                  "--repetitions", "1", "--render-width", "16", "--render-spp", "1"});
  EXPECT_NE(text.out.find("voxel 16^3: "), std::string::npos) << text.out;
  EXPECT_NE(text.out.find(" components, certified, "), std::string::npos) << text.out;
}

// The scene's render against that of the same surface as triangles: the same picture.
TEST_F(BenchCommandTest, AMixedSceneIsComparedWithMeshesAlone) {
  const std::vector<std::string> small = {"--error",        "0.002", "--resolution", "16",
                                          "--repetitions",  "1",     "--render-spp", "16",
                                          "--render-width", "32",    "--mixed",      "--json"};
  std::vector<std::string> arguments = {"bench", rock_, "--set",
                                        "instances.0.detached_material=grey"};
  arguments.insert(arguments.end(), small.begin(), small.end());
  const CommandResult result = run_morsel(arguments);
  ASSERT_EQ(result.code, 0) << result.err;
  const json mixed = json::parse(result.out)["mixed"];
  EXPECT_EQ(mixed["hypertextures"], 1);
  EXPECT_GT(mixed["triangles"], 1000);
  EXPECT_GT(mixed["ratio"], 0.0);
  const double ours = mixed["mean_luminance"]["mixed"], theirs = mixed["mean_luminance"]["mesh"];
  EXPECT_GT(ours, 0.1);
  EXPECT_NEAR(ours, theirs, 0.02 * theirs);
  // Without what is compared, an error.
  EXPECT_EQ(run_morsel({"bench", folder_.write("ball.json", kBallScene).string(), "--mixed"}).code,
            2);
}

// What a browser makes of the page: it has all plots, and it can read the pictures.
TEST_F(BenchCommandTest, ABrowserShowsThePage) {
  if (std::system("command -v chromium >/dev/null") != 0) GTEST_SKIP() << "no chromium here";
  const std::filesystem::path page = folder_ / "bench.html";
  ASSERT_EQ(run_morsel({"bench", rock_, "--error", "0.02", "--resolution", "16", "--repetitions",
                        "1", "--render-width", "16", "--render-spp", "1", "--scaling", "--mixed",
                        "--engines", "16,32", "--html", page.string()})
                .code,
            0);
  // Written out by the page itself once all is loaded: what is drawn, and how large.
  std::string text = read_text(page);
  const std::size_t end = text.find("</body>");
  ASSERT_NE(end, std::string::npos);
  text.insert(end, R"(<script>window.onload = () => { document.title = "shown:"
    + [...document.querySelectorAll("svg.plot")].filter(s => s.getBBox().width > 100).length + ":"
    + [...document.images].map(i => i.naturalWidth + "x" + i.naturalHeight).join(","); };</script>)");
  const std::string probe = folder_.write("probe.html", text).string(),
                    shown = (folder_ / "shown.html").string();
  const std::string command = "HOME='" + folder_.path().string() +
                              "' timeout 240 chromium --headless --no-sandbox --disable-gpu "
                              "--dump-dom 'file://" +
                              probe + "' >'" + shown + "' 2>/dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  EXPECT_NE(read_text(shown).find("<title>shown:5:16x12,16x12</title>"), std::string::npos)
      << read_text(shown).substr(0, 200);
}

}  // namespace
}  // namespace morsel::test
