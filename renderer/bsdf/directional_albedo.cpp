// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf/directional_albedo.h"

#include <map>
#include <memory>
#include <mutex>

#include "renderer/bsdf/fresnel.h"
#include "renderer/bsdf/ggx.h"
#include "renderer/bsdf/sheen.h"
#include "renderer/math/warp.h"
#include "renderer/sampler/owen_sobol.h"

namespace morsel::render {
namespace {

constexpr int kSamples = 256;

V2f hammersley(int i) {
  return {(static_cast<float>(i) + 0.5f) / kSamples,
          to_unit_float(reverse_bits(static_cast<std::uint32_t>(i)))};
}
V3f direction_of(float cosine) {
  return {std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine};
}

// Mean weights of the visible-normal estimator.
struct Shares {
  float reflected = 0.0f, refracted = 0.0f;
};
// `eta` 0: a mirror.
Shares integrate(float cosine, float roughness, float eta) {
  const V3f wo = direction_of(cosine);
  // Facets of a perfectly smooth surface are the surface.
  const float alpha = roughness * roughness;
  const bool smooth = alpha < Ggx::kSmallestAlpha;
  const Ggx ggx(std::max(alpha, Ggx::kSmallestAlpha));
  double reflected = 0.0, refracted = 0.0;
  const int samples = smooth ? 1 : kSamples;
  for (int i = 0; i < samples; ++i) {
    const V3f h = smooth ? V3f(0, 0, 1) : ggx.sample_visible(wo, hammersley(i));
    const float cos_o = dot(wo, h);
    if (cos_o <= 0.0f) continue;
    float cos_t = 0.0f;
    const float f = eta > 0.0f ? fresnel_dielectric(cos_o, eta, cos_t) : 1.0f;
    const auto weight = [&](const V3f& wi) {
      return smooth ? 1.0f : ggx.masking_shadowing(wo, wi) / ggx.masking(wo);
    };
    const V3f mirrored = h * (2.0f * cos_o) - wo;
    if (mirrored.z > 0.0f) reflected += f * weight(mirrored);
    if (f < 1.0f) {
      const V3f bent = wo * (-1.0f / eta) + h * (cos_o / eta - cos_t);
      if (bent.z < 0.0f) refracted += (1.0f - f) * weight(bent);
    }
  }
  return {static_cast<float>(reflected / samples), static_cast<float>(refracted / samples)};
}

InterfaceAlbedo tables_of(float eta) {
  // One integration gives both numbers.
  std::map<std::pair<float, float>, Shares> shares;
  AlbedoTable reflected([&](float c, float r) {
    const Shares s = integrate(c, r, eta);
    shares[{c, r}] = s;
    return s.reflected;
  });
  AlbedoTable total([&](float c, float r) {
    const Shares& s = shares[{c, r}];
    return s.reflected + s.refracted;
  });
  return {reflected, total};
}

}  // namespace

const AlbedoTable& ggx_albedo() {
  static const AlbedoTable table(
      [](float cosine, float roughness) { return integrate(cosine, roughness, 0.0f).reflected; });
  return table;
}

const InterfaceTables& interface_albedo(float ior) {
  static std::mutex mutex;
  static std::map<float, std::unique_ptr<const InterfaceTables>> known;
  const std::lock_guard lock(mutex);
  auto& tables = known[ior];
  if (!tables)
    tables = std::make_unique<InterfaceTables>(InterfaceTables{
        ior, square((ior - 1.0f) / (ior + 1.0f)), tables_of(ior), tables_of(1.0f / ior)});
  return *tables;
}

const AlbedoTable& sheen_albedo() {
  static const AlbedoTable table([](float cosine, float roughness) {
    const Sheen sheen(V3f(1.0f), roughness * roughness);
    const V3f wo = direction_of(cosine);
    // Uniform in the hemisphere: the lobe is widest along the horizon.
    double sum = 0.0;
    constexpr int kFine = 4 * kSamples;
    for (int i = 0; i < kFine; ++i) {
      const float z = (static_cast<float>(i) + 0.5f) / kFine;
      const float phi = 2.0f * kPi * to_unit_float(reverse_bits(static_cast<std::uint32_t>(i)));
      const float s = std::sqrt(1.0f - z * z);
      sum += sheen.evaluate(wo, V3f(s * std::cos(phi), s * std::sin(phi), z)).value.x;
    }
    return static_cast<float>(sum / kFine * 2.0 * kPi);
  });
  return table;
}

}  // namespace morsel::render
