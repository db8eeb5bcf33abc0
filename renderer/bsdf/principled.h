// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "renderer/bsdf/conductor.h"
#include "renderer/bsdf/dielectric.h"
#include "renderer/bsdf/plastic.h"
#include "renderer/bsdf/sheen.h"
#include "renderer/bsdf/surface_parameters.h"
#include "renderer/bsdf/thin_glass.h"

namespace morsel::render {

// The layered surface of glTF 2.0 with its extensions: a clear coat (index 1.5) over sheen over a
// mixture, by `metallic` and `transmission`, of metal, glass and glossy matte body. What a layer
// reflects towards the viewer is taken off what is under it ("albedo scaling"), which keeps energy
// exactly; under coat and sheen reciprocity is lost by that, the mixture itself is reciprocal. No
// part is a delta lobe: roughness 0 is narrow, not perfect. (make_lobe takes a Conductor or
// Dielectric alone where nothing else is there.)
class Principled {
 public:
  Principled(const SurfaceParameters& p, bool outside);

  LobeValue evaluate(const V3f& wo, const V3f& wi) const;
  std::optional<LobeSample> sample(const V3f& wo, float choice, const V2f& u) const;
  bool delta() const { return false; }
  float spread() const { return spread_; }
  V3f albedo() const { return albedo_; }

 private:
  enum Part { kCoat, kSheen, kMetal, kGlass, kPlastic, kParts };
  // What each part's value is multiplied by, and how often it is sampled.
  struct Shares {
    float scale[kParts], probability[kParts];
  };
  Shares shares(const V3f& wo) const;

  float metallic_, transmission_, sheen_strength_, sheen_alpha_;
  float plastic_strength_, metal_strength_;  // brightest channels, for probabilities
  bool coated_;
  SpecularLayer coat_;
  Sheen sheen_;
  Conductor metal_;
  std::variant<Dielectric, ThinGlass> glass_;
  Plastic plastic_;
  float spread_;
  V3f albedo_;
};

}  // namespace morsel::render
