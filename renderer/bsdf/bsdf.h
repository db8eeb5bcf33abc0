// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <variant>

#include "renderer/bsdf/conductor.h"
#include "renderer/bsdf/dielectric.h"
#include "renderer/bsdf/diffuse.h"
#include "renderer/bsdf/principled.h"
#include "renderer/bsdf/surface_parameters.h"
#include "renderer/bsdf/thin_glass.h"
#include "renderer/math/frame.h"

namespace morsel::render {

// The registry: a new kind of material is a file pair with a class as lobe.h describes, one entry
// here, and one case in make_lobe (bsdf.cpp).
using Lobe = std::variant<Diffuse, Conductor, Dielectric, ThinGlass, Plastic, Principled>;

// The lobe of a surface seen from the outside or the inside: the simplest that has all its parts.
Lobe make_lobe(const SurfaceParameters& p, bool outside);

// A lobe at a point of a surface; directions are unit vectors in world space.
//
// Interpolated normals make trouble where they disagree with the true one, so:
// - a shading normal that faces away from the viewer, or mirrors him into the surface, is turned
//   just as far as needed (no black pixels along silhouettes);
// - light is only reflected to the side of the true surface it came from, and only transmitted
//   through it (no leaks);
// - reflection fades out towards directions under the true surface instead of being cut off
//   (Chiang, Li & Burley, "Taming the Shadow Terminator", 2019).
class Bsdf {
 public:
  // `geometric_normal` is outward, `shading_normal` in the same hemisphere, both unit.
  Bsdf(const SurfaceParameters& parameters, const V3f& geometric_normal, const V3f& shading_normal,
       const V3f& wo);

  // As LobeValue and LobeSample, but with wi in world space.
  LobeValue evaluate(const V3f& wi) const;
  std::optional<LobeSample> sample(float choice, const V2f& u) const;
  bool delta() const {
    return std::visit([](const auto& lobe) { return lobe.delta(); }, lobe_);
  }
  float spread() const {
    return std::visit([](const auto& lobe) { return lobe.spread(); }, lobe_);
  }
  V3f albedo() const {
    return std::visit([](const auto& lobe) { return lobe.albedo(); }, lobe_);
  }
  // The normal that shading happens with, on the viewer's side.
  const V3f& shading_normal() const { return frame_.z; }

 private:
  float terminator(const V3f& wi) const;

  V3f geometric_normal_;  // on the viewer's side
  bool smooth_;           // shading and geometric normals differ
  Frame frame_;
  float per_agreement_;  // over the cosine between them
  V3f wo_;               // local
  Lobe lobe_;
};

}  // namespace morsel::render
