// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace morsel::test {

// A scene with one of everything. Its hypertexture is a plain ball in a given box, so that its
// topology takes milliseconds.
inline constexpr char kSmallScene[] = R"({
  "morsel": 1,
  "camera": { "position": [0, 1, 6], "look_at": [0, 0, 0], "vertical_fov": 30 },
  "render": { "resolution": [64, 48], "spp": 2, "max_depth": 3, "seed": 7, "exposure": 0.5 },
  "materials": [
    { "name": "white", "type": "diffuse", "color": [0.8, 0.8, 0.8], "checker_color": [0.1, 0.1, 0.1] },
    { "name": "metal", "type": "conductor", "roughness": 0.1 },
    { "name": "glass", "type": "dielectric", "ior": 1.33 }
  ],
  "geometries": [
    {
      "name": "rock",
      "type": "hypertexture",
      "field": { "density": { "type": "sphere", "radius": 1 }, "modulations": [] },
      "bounds": { "min": [-1.25, -1.25, -1.25], "max": [1.25, 1.25, 1.25] }
    },
    { "name": "floor", "type": "rectangle", "size": [4, 6] },
    { "name": "triangle", "type": "mesh", "file": "triangle.obj" },
    { "name": "ball", "type": "sphere", "radius": 0.5, "segments": 8 }
  ],
  "instances": [
    { "geometry": "rock", "material": "white", "detached_material": "glass" },
    { "name": "ground", "geometry": "floor", "material": "white", "translate": [0, -1, 0] },
    { "geometry": "triangle", "material": "metal", "scale": [1, 2, 3], "rotate": [0, 90, 0] },
    { "geometry": "ball", "material": "glass" }
  ],
  "lights": [
    { "type": "environment", "radiance": [0.1, 0.2, 0.3], "rotation": 30 },
    { "type": "rectangle", "name": "key", "corner": [0, 3, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 2],
      "radiance": 5, "visible_to_camera": false }
  ]
})";

inline constexpr char kTriangleObj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

}  // namespace morsel::test
