// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "renderer/math/vector.h"

// What every lobe (diffuse.h, conductor.h, dielectric.h) offers, in a local frame whose z axis is
// the shading normal on the viewer's side. `wo` points to the viewer and has z > 0; `wi` points to
// where light comes from, z > 0 for reflection and z < 0 for transmission. All are unit vectors.
//
//   LobeValue evaluate(wo, wi) const;   zero for a delta lobe
//   std::optional<LobeSample> sample(wo, choice, u) const;   random numbers in [0, 1). None where
//       the lobe has nothing to give; what fails to be a number is returned, so that it is found
//   bool delta() const;      reflects and refracts in single directions only
//   float spread() const;    how far it scatters, as GGX's alpha: 0 a mirror, 1 diffuse
//   V3f albedo() const;      colour for the denoiser, in [0, 1]
namespace morsel::render {

struct LobeValue {
  V3f value{0.0f};   // f(wo, wi) * |wi.z|
  float pdf = 0.0f;  // per solid angle, of sample() to choose wi
};

struct LobeSample {
  V3f wi;
  V3f weight;        // f(wo, wi) * |wi.z| / pdf, also for delta lobes
  float pdf = 0.0f;  // as evaluate() has it; 0 for delta lobes
  bool delta = false;
  bool transmission = false;
  bool diffuse = false;  // by a matte lobe: for limits by kind of bounce
  // Square of the index of refraction behind over in front, 1 for reflection: what radiance is
  // divided by in `weight` and gets back when the path leaves again.
  float eta_squared = 1.0f;
};

}  // namespace morsel::render
