// SPDX-License-Identifier: Apache-2.0
#include <Imath/ImathBox.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "renderer/mesh/mesh_file.h"
#include "tools/commands.h"
#include "tools/output_file.h"

namespace morsel::tools {
namespace {

namespace fs = std::filesystem;

// The parts that change are {0} and {1}, the mesh as a geometry and as an instance, and {2}, what
// there is.
constexpr const char* kStarter = R"(// A scene for Morsel. Comments like this one are allowed.
//   morsel scene check FILE            says everything that is wrong with it
//   morsel render FILE -o picture.exr  renders it, and picture.png
//   morsel scene schema                prints the schema by which an editor completes it
// Lengths are units of your own, angles degrees, colours scene-linear Rec. 709; y is up.
{{
  "morsel": 1,  // version of the format
  "description": "{2}",

  "camera": {{ "position": [0, 1.8, 6.6], "look_at": [0.1, 1.1, 0], "vertical_fov": 35 }},
  "render": {{
    "resolution": [640, 480],
    "spp": 64,          // samples a pixel: more is less noise; 16 for a draft
    "max_depth": 4,     // bounces
    "exposure": 0       // stops; of the PNG only
  }},

  // What surfaces look like.
  "materials": [
    {{ "name": "stone", "type": "principled", "color": [0.42, 0.36, 0.30], "roughness": 0.8 }},
    {{ "name": "removed", "type": "principled", "color": [0.8, 0.05, 0.03], "roughness": 0.8 }},
    {{ "name": "ground", "type": "diffuse", "color": [0.35, 0.34, 0.32] }}
  ],

  // Shapes, each around its own origin.
  "geometries": [
    {{
      "name": "rock",
      "type": "hypertexture",
      // F = density + modulations; the surface is where F = 0. The density is the smooth shape.
      "field": {{
        "density": {{ "type": "sphere", "radius": 1 }},
        "modulations": [
          {{
            "type": "fbm",                    // octaves of noise
            "noise": "sparse_convolution",    // or perlin
            "amplitude": 0.5,                 // how far the surface moves, a length; try 0.2 and 0.8
            "frequency": 2,                   // features a unit of length
            "layers": 2,                      // octaves: each has finer detail
            "seed": 1                         // another number, another rock
          }}
        ]
      }},
      // Noise tears pieces off. "main" shows what hangs together with the largest, "all" everything.
      "keep": "main"
    }},{0}
    {{ "name": "floor", "type": "rectangle", "size": [400, 400] }}
  ],

  // Where shapes stand: scaled, then rotated about x, y, z, then moved.
  "instances": [
    {{ "geometry": "rock", "material": "stone", "detached_material": "removed", "translate": [0, 1.1, 0] }},{1}
    {{ "geometry": "floor", "material": "ground" }}
  ],

  "lights": [
    {{ "type": "sky", "sun_elevation": 40, "sun_azimuth": 110, "turbidity": 2.5, "radiance": 0.45 }}
  ]
}}
)";

constexpr const char* kMesh = R"(
    // A mesh of yours: .obj, .ply, .stl, .gltf or .glb, relative to this file. It is {1}.
    {{ "name": "mesh", "type": "mesh", "file": {0} }},)";

constexpr const char* kMeshInstance = R"(
    {{ "geometry": "mesh", "material": "stone", "scale": {}, "translate": [{}, {}, {}] }},)";

// Where a mesh of any size stands on the floor, to the right of the rock and before it.
constexpr float kMeshSize = 1.2F;
const Imath::V3f kMeshPlace(1.4F, 0, 1.2F);

struct MeshText {
  std::string geometry, instance;
};

MeshText describe_mesh(const std::string& name, const fs::path& file) {
  Imath::Box3f box;
  try {
    for (const Imath::V3f& p : render::load_mesh(file).positions) box.extendBy(p);
  } catch (const render::MeshError& e) {
    throw UsageError(fmt::format("--mesh {}", e.what()));
  }
  const Imath::V3f size = box.size();
  const float longest = std::max({size.x, size.y, size.z});
  const float scale = longest > 0 ? kMeshSize / longest : 1;
  const Imath::V3f middle = box.center();
  const Imath::V3f move = kMeshPlace - scale * Imath::V3f(middle.x, box.min.y, middle.z);
  const std::string extent = fmt::format("{:.4g} x {:.4g} x {:.4g} large", size.x, size.y, size.z);
  return {fmt::format(kMesh, nlohmann::json(name).dump(), extent),
          fmt::format(kMeshInstance, fmt::format("{:.4g}", scale), fmt::format("{:.4g}", move.x),
                      fmt::format("{:.4g}", move.y), fmt::format("{:.4g}", move.z))};
}

struct Options {
  std::string file, mesh;
  bool force = false;
};

int run(const Options& options) {
  const fs::path file = options.file;
  std::error_code error;
  if (fs::exists(file, error) && !options.force)
    throw UsageError(fmt::format("{}: is there already; --force replaces it", file.string()));
  MeshText mesh;
  if (!options.mesh.empty()) {
    const fs::path folder = fs::absolute(file).parent_path();
    mesh = describe_mesh(fs::proximate(fs::absolute(options.mesh), folder).string(), options.mesh);
  }
  OutputFile out(file);
  out.stream() << fmt::format(
      kStarter, mesh.geometry, mesh.instance,
      mesh.geometry.empty() ? "A boulder of hypertexture on the ground"
                            : "A boulder of hypertexture on the ground, and a mesh beside it");
  out.commit();
  std::cout << file.string() << '\n';
  return kDone;
}

}  // namespace

void add_scene_new(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      parent.add_subcommand("new", "Write a scene to begin with, with comments that explain it");
  command->add_option("FILE", options->file, "Scene file to write")->required();
  command->add_option("--mesh", options->mesh,
                      "A mesh of yours that it shows too, scaled to stand beside the rock");
  command->add_flag("--force", options->force, "Replace the file if it is there");
  command->callback([options, &session] { session.run = [options] { return run(*options); }; });
}

}  // namespace morsel::tools
