// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

TEST(SceneNew, WritesASceneThatIsValidAndRenders) {
  const TemporaryFolder folder;
  folder.write("meshes/tri angle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const CommandOptions here{.folder = folder.path()};
  const CommandResult written =
      run_morsel({"scene", "new", "a.json", "--mesh", "meshes/tri angle.obj"}, here);
  ASSERT_EQ(written.code, 0) << written.err;
  EXPECT_EQ(written.out, "a.json\n");
  const CommandResult checked = run_morsel({"scene", "check", "a.json"}, here);
  EXPECT_EQ(checked.code, 0) << checked.out;
  EXPECT_EQ(checked.err, "");  // no warnings either
  // What it says is written once; the comments are for people.
  const std::string text = read_text(folder / "a.json");
  EXPECT_NE(text.find("Comments like this one are allowed"), std::string::npos);
  EXPECT_NE(text.find("\"meshes/tri angle.obj\""), std::string::npos);

  EXPECT_EQ(run_morsel({"scene", "new", "a.json"}, here).code, 2);
  EXPECT_EQ(run_morsel({"scene", "new", "a.json", "--force"}, here).code, 0);
  const CommandResult rendered =
      run_morsel({"render", "a.json", "--spp", "1", "--resolution", "32x24", "--set",
                  "geometries.rock.field.modulations.0.layers=1", "-o", "a.exr"},
                 here);
  EXPECT_EQ(rendered.code, 0) << rendered.err;
}

TEST(SceneNew, AMeshOfAnySizeStandsBesideTheRock) {
  const TemporaryFolder folder;
  folder.write("big.obj", "v 0 500 0\nv 1200 500 0\nv 0 800 0\nf 1 2 3\n");
  const CommandOptions here{.folder = folder.path()};
  ASSERT_EQ(run_morsel({"scene", "new", "a.json", "--mesh", "big.obj"}, here).code, 0);
  const json scene = json::parse(read_text(folder / "a.json"), nullptr, true, true);
  const json& instance = scene["instances"][1];
  EXPECT_EQ(instance["geometry"], "mesh");
  EXPECT_NEAR(instance["scale"].get<double>(), 0.001, 1e-6);
  EXPECT_NEAR(instance["translate"][1].get<double>(), -0.5, 1e-3);  // its lowest point on the floor

  const CommandResult missing = run_morsel({"scene", "new", "b.json", "--mesh", "no.obj"}, here);
  EXPECT_EQ(missing.code, 2);
  EXPECT_NE(missing.err.find("--mesh no.obj: no such file"), std::string::npos) << missing.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "b.json"));
}

TEST(SceneCheck, ReportsEveryProblem) {
  const TemporaryFolder folder;
  json scene = json::parse(kCommandScene);
  scene["camera"]["vertical_fov"] = 400;
  scene["camera"]["posiiton"] = {0, 0, 1};
  scene["camera"]["up"] = "y";
  scene["render"]["spp"] = 0;
  scene["geometries"][0]["field"]["density"]["radius"] = -1;
  scene["geometries"][0]["field"]["modulations"][0]["amplitude"] = "much";
  scene["geometries"][0]["field"]["modulations"][0]["frequenzy"] = 3;
  scene["geometries"][0]["solver"] = "fast";
  scene["instances"][0]["material"] = "gray";
  scene["instances"][1]["geometry"] = "flor";
  scene["lights"].push_back({{"type", "lamp"}});
  const CommandResult result =
      run_morsel({"scene", "check", folder.write("bad.json", scene.dump()).string(), "--json"});
  EXPECT_EQ(result.code, 2);
  const json problems = json::parse(result.out)["problems"];
  for (const char* place :
       {"/camera/vertical_fov: ", "/camera/posiiton: ", "/camera/up: ", "/render/spp: ",
        "/geometries/0/solver: ", "/instances/0/material: ", "/instances/1/geometry: ",
        "/lights/1/type: ", "/geometries/0/field/density/radius: ",
        "/geometries/0/field/modulations/0/amplitude: ",
        "/geometries/0/field/modulations/0/frequenzy: "}) {
    int times = 0;
    for (const json& p : problems)
      times += p.get<std::string>().find(place) != std::string::npos ? 1 : 0;
    EXPECT_EQ(times, 1) << place << "\n" << problems.dump(2);
  }
  EXPECT_EQ(problems.size(), 11u) << problems.dump(2);
}

TEST(SceneSchema, IsOneDocument) {
  const CommandResult result = run_morsel({"scene", "schema"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json schema = json::parse(result.out);
  EXPECT_EQ(schema["properties"]["morsel"]["type"], "integer");
  EXPECT_EQ(result.err, "");
  const TemporaryFolder folder;
  const CommandResult file =
      run_morsel({"scene", "schema", "-o", (folder / "morsel.schema.json").string()});
  EXPECT_EQ(read_text(folder / "morsel.schema.json"), result.out);
}

}  // namespace
}  // namespace morsel::test
