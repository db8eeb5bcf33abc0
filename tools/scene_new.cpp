// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/output_file.h"

namespace morsel::tools {
namespace {

namespace fs = std::filesystem;

// The parts that change are {0} and {1}: the mesh as a geometry and as an instance.
constexpr const char* kStarter = R"(// A scene for Morsel. Comments like this one are allowed.
//   morsel scene check FILE            says everything that is wrong with it
//   morsel render FILE -o picture.exr  renders it, and picture.png
//   morsel scene schema                prints the schema by which an editor completes it
// Lengths are units of your own, angles degrees, colours scene-linear Rec. 709; y is up.
{{
  "morsel": 1,  // version of the format
  "description": "A boulder of hypertexture on the ground",

  "camera": {{ "position": [0, 1.6, 6], "look_at": [0, 0.9, 0], "vertical_fov": 35 }},
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
    {{ "name": "floor", "type": "rectangle", "size": [40, 40] }}
  ],

  // Where shapes stand: scaled, then rotated about x, y, z, then moved.
  "instances": [
    {{ "geometry": "rock", "material": "stone", "detached_material": "removed", "translate": [0, 1.1, 0] }},{1}
    {{ "geometry": "floor", "material": "ground" }}
  ],

  "lights": [
    {{ "type": "sky", "sun_elevation": 35, "sun_azimuth": 50, "turbidity": 3, "radiance": 0.06 }}
  ]
}}
)";

constexpr const char* kMesh = R"(
    // A mesh of yours: .obj, .ply, .stl, .gltf or .glb, relative to this file.
    {{ "name": "mesh", "type": "mesh", "file": {} }},)";

constexpr const char* kMeshInstance = R"(
    {{ "geometry": "mesh", "material": "stone", "scale": [1, 1, 1], "translate": [2, 0, 0] }},)";

struct Options {
  std::string file, mesh;
  bool force = false;
};

int run(const Options& options) {
  const fs::path file = options.file;
  std::error_code error;
  if (fs::exists(file, error) && !options.force)
    throw UsageError(fmt::format("{}: is there already; --force replaces it", file.string()));
  std::string geometry, instance;
  if (!options.mesh.empty()) {
    const fs::path folder = fs::absolute(file).parent_path();
    const fs::path mesh = fs::proximate(fs::absolute(options.mesh), folder);
    geometry = fmt::format(kMesh, nlohmann::json(mesh.string()).dump());
    instance = fmt::format(kMeshInstance);
  }
  OutputFile out(file);
  out.stream() << fmt::format(kStarter, geometry, instance);
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
  command->add_option("--mesh", options->mesh, "A mesh of yours that it shows too");
  command->add_flag("--force", options->force, "Replace the file if it is there");
  command->callback([options, &session] { session.run = [options] { return run(*options); }; });
}

}  // namespace morsel::tools
