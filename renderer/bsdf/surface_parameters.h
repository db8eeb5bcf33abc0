// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/directional_albedo.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// A material at one point: what BSDFs are made of. Meanings and ranges are those of Material.
struct SurfaceParameters {
  MaterialType type = MaterialType::kDiffuse;
  V3f color{0.5f};
  float alpha = 0.0f;  // roughness^2, here and below
  float ior = 1.5f;
  float metallic = 0.0f;
  float specular = 1.0f;
  V3f specular_color{1.0f};
  float diffuse_roughness = 0.0f;
  float clearcoat = 0.0f, clearcoat_alpha = 0.0f;
  V3f sheen_color{0.0f};
  float sheen_alpha = 0.0f;
  float transmission = 0.0f;
  bool thin = false;
  bool tints_crossings = true;  // whether `color` is multiplied to what passes
  // Whether refraction changes radiance by the square of the index. Not where part of the light
  // passes straight through (partial opacity): what goes in by one way and out by the other would
  // keep the factor.
  bool scales_radiance = true;
  const InterfaceTables* tables = nullptr;  // of `ior`; needed by all but diffuse and conductor
  const InterfaceTables* coat_tables = nullptr;  // of the clear coat
};

// What one crossing of a solid's boundary multiplies refracted light by: light that passes through
// a body crosses twice, and `color` is that of the whole passage.
V3f crossing_tint(const SurfaceParameters& p);

}  // namespace morsel::render
