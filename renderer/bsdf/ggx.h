// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/math/sine_cosine.h"
#include "renderer/math/vector.h"

namespace morsel::render {

// Isotropic GGX microfacets about +z with Smith's height-correlated masking-shadowing: Walter et
// al. 2007, Heitz 2014. Directions are unit vectors on either side; facet normals have z > 0.
class Ggx {
 public:
  // Below this the lobe is narrower than what float resolves: treat the surface as smooth.
  static constexpr float kSmallestAlpha = 1e-3f;

  explicit Ggx(float alpha) : alpha_(alpha) {}

  // Density of facet normals per unit of macro area and solid angle.
  float distribution(const V3f& h) const {
    const float a2 = alpha_ * alpha_;
    // (a2 - 1) cos^2 + 1, arranged to lose no digits at small alpha near the pole.
    const float d = a2 * h.z * h.z + (h.x * h.x + h.y * h.y);
    return a2 / (kPi * d * d);
  }
  float lambda(const V3f& w) const {
    const float cos2 = w.z * w.z;
    const float tan2 = (w.x * w.x + w.y * w.y) / std::max(cos2, 1e-20f);
    return 0.5f * (std::sqrt(1.0f + alpha_ * alpha_ * tan2) - 1.0f);
  }
  float masking(const V3f& w) const { return 1.0f / (1.0f + lambda(w)); }
  float masking_shadowing(const V3f& wo, const V3f& wi) const {
    return 1.0f / (1.0f + lambda(wo) + lambda(wi));
  }

  // Reflection at facets: f wi.z but for the Fresnel term, the density of wi by sample_visible(),
  // and the cosine between either and the facets' normal. Directions are on the upper side. The
  // same as D G / (4 wo.z), D G1 / (4 wo.z) and dot(wo, h), put together so that little is divided.
  struct Reflection {
    float value = 0.0f, pdf = 0.0f, cosine = 0.0f;
  };
  Reflection reflection(const V3f& wo, const V3f& wi) const {
    const V3f sum = wo + wi;  // the normal times twice the cosine
    const float length2 = dot(sum, sum);
    if (!(length2 > 0.0f)) return {};
    const float a2 = alpha_ * alpha_;
    // See distribution(); times length2.
    const float d = a2 * sum.z * sum.z + (sum.x * sum.x + sum.y * sum.y);
    const auto stretched = [&](const V3f& w) {  // w.z (1 + 2 lambda(w))
      return std::sqrt(w.z * w.z + a2 * (w.x * w.x + w.y * w.y));
    };
    const float o = stretched(wo), i = stretched(wi);
    const float density = 0.5f * kInvPi * a2 * (length2 / d) * (length2 / d);
    return {density * wi.z / (wi.z * o + wo.z * i), density / (wo.z + o),
            0.5f * std::sqrt(length2)};
  }

  // Density with which sample_visible() draws `h`; wo.z > 0.
  float visible_density(const V3f& wo, const V3f& h) const {
    return masking(wo) * std::max(0.0f, dot(wo, h)) * distribution(h) / wo.z;
  }

  // A facet normal seen from `wo` (wo.z > 0). The hemisphere of directions that mirror into the
  // stretched wo is a spherical cap: Dupuy & Benyoub, "Sampling Visible GGX Normals with Spherical
  // Caps", 2023.
  V3f sample_visible(const V3f& wo, const V2f& u) const {
    const V3f stretched = normalize(V3f(alpha_ * wo.x, alpha_ * wo.y, wo.z));
    const float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
    const float r = std::sqrt(std::clamp(1.0f - z * z, 0.0f, 1.0f));
    const SineCosine phi = sine_cosine_of_turns(u.x);
    const V3f h = V3f(r * phi.cosine, r * phi.sine, z) + stretched;
    return normalize(V3f(alpha_ * h.x, alpha_ * h.y, std::max(h.z, 1e-7f)));
  }
  // Where a facet normal that it draws mirrors `wo`; may be below the surface.
  V3f sample_reflection(const V3f& wo, const V2f& u) const {
    const V3f h = sample_visible(wo, u);
    return renormalize(h * (2.0f * dot(wo, h)) - wo);
  }

 private:
  float alpha_;
};

}  // namespace morsel::render
