// SPDX-License-Identifier: Apache-2.0
#pragma once

// Scenes for the command's tests: small enough that everything takes a fraction of a second.
namespace morsel::test {

// A ball that one layer of noise makes into a lump and four smaller pieces, and a floor.
inline constexpr char kCommandScene[] = R"({
  "morsel": 1,
  "camera": { "position": [0, 0, 6], "vertical_fov": 40 },
  "render": { "resolution": [32, 24], "spp": 2, "max_depth": 2 },
  "materials": [{ "name": "grey", "type": "diffuse" }],
  "geometries": [
    {
      "name": "rock",
      "type": "hypertexture",
      "field": {
        "density": { "type": "sphere", "radius": 1 },
        "modulations": [{ "type": "fbm", "amplitude": 0.6, "frequency": 1.5, "seed": 3 }]
      },
      "bounds": { "min": [-2.5, -2.5, -2.5], "max": [2.5, 2.5, 2.5] }
    },
    { "name": "floor", "type": "rectangle", "size": [8, 8] }
  ],
  "instances": [
    { "geometry": "rock", "material": "grey" },
    { "geometry": "floor", "material": "grey", "translate": [0, -2, 0] }
  ],
  "lights": [{ "type": "environment" }]
})";

// The same density without noise: F = 1 - sqrt(|x|^2 + 0.01^2).
inline constexpr char kBallScene[] = R"({
  "morsel": 1,
  "geometries": [
    {
      "name": "ball",
      "type": "hypertexture",
      "field": { "density": { "type": "sphere", "radius": 1, "smoothing": 0.01 } },
      "bounds": { "min": [-1.5, -1.5, -1.5], "max": [1.5, 1.5, 1.5] }
    }
  ]
})";

}  // namespace morsel::test
