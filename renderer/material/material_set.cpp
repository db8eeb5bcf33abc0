// SPDX-License-Identifier: Apache-2.0
#include "renderer/material/material_set.h"

namespace morsel::render {
namespace {

constexpr float kCoatIor = 1.5f;  // KHR_materials_clearcoat

// -log of a transmittance; black is as dark as a float can tell apart from nothing.
float absorption(float transmittance, float distance) {
  return -std::log(std::max(transmittance, 1e-6f)) / distance;
}

SurfaceParameters prepare(const Material& m) {
  SurfaceParameters p;
  p.type = m.type;
  p.color = m.color;
  p.alpha = square(m.roughness);
  p.diffuse_roughness = m.diffuse_roughness;
  p.ior = m.ior;
  p.metallic = m.metallic;
  p.specular = m.specular;
  p.specular_color = m.specular_color;
  p.clearcoat = m.clearcoat;
  p.clearcoat_alpha = square(m.clearcoat_roughness);
  p.sheen_color = m.sheen_color;
  p.sheen_alpha = square(m.sheen_roughness);
  p.transmission = m.transmission;
  p.thin = m.thin;
  p.absorbing = m.attenuation_distance > 0.0f && !m.thin;
  if (m.type == MaterialType::kDielectric || m.type == MaterialType::kPrincipled)
    p.tables = &interface_albedo(m.ior);
  if (m.type == MaterialType::kPrincipled) p.coat_tables = &interface_albedo(kCoatIor);
  return p;
}

V3f checkered(const Material& m, const V3f& p) {
  const float square_sum = std::floor(p.x / m.checker_size) + std::floor(p.z / m.checker_size);
  return std::fmod(square_sum, 2.0f) != 0.0f ? *m.checker_color : m.color;
}

}  // namespace

MaterialSet::MaterialSet(const Scene& scene) : scene_(scene) {
  for (const Material& m : scene.materials) {
    Prepared p;
    p.base = prepare(m);
    p.emits = max_component(m.emission) > 0.0f;
    p.opaque = m.opacity >= 1.0f;
    if (p.base.absorbing)
      for (int i = 0; i < 3; ++i)
        p.absorption[i] = absorption(m.attenuation_color[i], m.attenuation_distance);
    prepared_.push_back(p);
  }
}

SurfaceParameters MaterialSet::parameters(const SurfaceInteraction& hit,
                                          float smallest_alpha) const {
  const Material& m = scene_.materials[hit.material];
  SurfaceParameters p = prepared_[hit.material].base;
  if (m.checker_color) p.color = checkered(m, hit.p);
  p.alpha = std::max(p.alpha, smallest_alpha);
  p.clearcoat_alpha = std::max(p.clearcoat_alpha, smallest_alpha);
  return p;
}

V3f MaterialSet::emission(const SurfaceInteraction& hit) const {
  return scene_.materials[hit.material].emission;
}

float MaterialSet::opacity(const SurfaceInteraction& hit) const {
  return scene_.materials[hit.material].opacity;
}

V3f MaterialSet::transmittance(std::uint32_t material, float length) const {
  const V3f& a = prepared_[material].absorption;
  return {std::exp(-a.x * length), std::exp(-a.y * length), std::exp(-a.z * length)};
}

}  // namespace morsel::render
