// SPDX-License-Identifier: Apache-2.0
#include "renderer/material/material_set.h"

#include "renderer/math/frame.h"

namespace morsel::render {
namespace {

constexpr float kCoatIor = 1.5f;  // KHR_materials_clearcoat

// -log of a transmittance; black is as dark as a float can tell apart from nothing.
float absorption(float transmittance, float distance) {
  return -std::log(std::max(transmittance, 1e-6f)) / distance;
}

bool absorbs_inside(const Material& m) { return m.attenuation_distance > 0.0f && !m.thin; }

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
  p.tints_crossings = !absorbs_inside(m) || m.color_tints_volume;
  p.scales_radiance = m.opaque();
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

MaterialSet::MaterialSet(const Scene& scene) : scene_(scene), textures_(scene) {
  for (const Material& m : scene.materials) {
    Prepared p;
    p.base = prepare(m);
    p.emits = max_component(m.emission) > 0.0f;
    p.opaque = m.opaque();
    p.emission_textured = m.texture(MaterialInput::kEmission) != kNoTexture;
    for (std::size_t i = 0; i < kMaterialInputs; ++i) {
      const auto input = static_cast<MaterialInput>(i);
      if (input != MaterialInput::kEmission && input != MaterialInput::kOpacity)
        p.textured = p.textured || m.textures[i] != kNoTexture;
    }
    p.absorbs = absorbs_inside(m);
    if (p.absorbs)
      for (int i = 0; i < 3; ++i)
        p.absorption[i] = absorption(m.attenuation_color[i], m.attenuation_distance);
    prepared_.push_back(p);
  }
}

// Textures may hold anything; the BSDFs rely on [0, 1].
void MaterialSet::apply_textures(const Material& m, const TexturePoint& point,
                                 Shading& shading) const {
  SurfaceParameters& p = shading.parameters;
  const auto tint = [&](MaterialInput input, V3f& value) {
    if (m.texture(input) == kNoTexture) return;
    const V3f c = textures_.color(m.texture(input), point);
    for (int i = 0; i < 3; ++i) value[i] *= std::clamp(c[i], 0.0f, 1.0f);
  };
  const auto scaled = [&](MaterialInput input, float value) {
    if (m.texture(input) == kNoTexture) return value;
    return value * std::clamp(textures_.number(m.texture(input), point), 0.0f, 1.0f);
  };
  tint(MaterialInput::kColor, p.color);
  tint(MaterialInput::kSpecularColor, p.specular_color);
  tint(MaterialInput::kSheenColor, p.sheen_color);
  p.alpha = square(scaled(MaterialInput::kRoughness, m.roughness));
  p.metallic = scaled(MaterialInput::kMetallic, p.metallic);
  p.specular = scaled(MaterialInput::kSpecular, p.specular);
  p.transmission = scaled(MaterialInput::kTransmission, p.transmission);
  p.clearcoat = scaled(MaterialInput::kClearcoat, p.clearcoat);
  p.clearcoat_alpha = square(scaled(MaterialInput::kClearcoatRoughness, m.clearcoat_roughness));
  p.sheen_alpha = square(scaled(MaterialInput::kSheenRoughness, m.sheen_roughness));
  bend_normal(m, point, shading.normal);
}

void MaterialSet::bend_normal(const Material& m, const TexturePoint& point, V3f& n) const {
  const V3f before = n;
  const std::uint32_t normal_map = m.texture(MaterialInput::kNormal);
  const SurfaceFrame* uv = normal_map != kNoTexture ? &textures_.frame(normal_map, point) : nullptr;
  if (uv != nullptr && uv->valid()) {
    const V3f u = uv->u_tangent - n * dot(n, uv->u_tangent);
    if (dot(u, u) > 0.0f) {
      const V3f tangent = normalize(u);
      V3f bitangent = cross(n, tangent);
      if (dot(bitangent, uv->v_tangent) < 0.0f) bitangent = -bitangent;
      const V3f t = textures_.color(normal_map, point) * 2.0f - V3f(1.0f);
      n = tangent * (t.x * m.normal_scale) + bitangent * (t.y * m.normal_scale) +
          n * std::max(t.z, 1e-3f);
      n = normalize(n);
    }
  }
  if (m.texture(MaterialInput::kBump) != kNoTexture) {
    const Frame frame(n);
    const V2f slope =
        textures_.slope(m.texture(MaterialInput::kBump), point, frame.x, frame.y) * m.bump_height;
    n = normalize(n - frame.x * slope.x - frame.y * slope.y);
  }
  const V3f& g = point.hit.geometric_normal;
  if (!is_finite(n) || dot(n, g) <= 0.0f) n = before;
}

MaterialSet::Shading MaterialSet::shade(const SurfaceInteraction& hit, const V3f& wo,
                                        float smallest_alpha) const {
  const Material& m = scene_.materials[hit.material];
  const Prepared& prepared = prepared_[hit.material];
  Shading s{prepared.base, hit.shading_normal};
  if (m.checker_color) s.parameters.color = checkered(m, hit.p);
  if (hit.vertex_color != V3f(1.0f))
    for (int i = 0; i < 3; ++i)
      s.parameters.color[i] *= std::clamp(hit.vertex_color[i], 0.0f, 1.0f);
  if (prepared.textured) apply_textures(m, TexturePoint(scene_, hit, wo), s);
  s.parameters.alpha = std::max(s.parameters.alpha, smallest_alpha);
  s.parameters.clearcoat_alpha = std::max(s.parameters.clearcoat_alpha, smallest_alpha);
  return s;
}

V3f MaterialSet::emission(const SurfaceInteraction& hit, const V3f& wo) const {
  const Material& m = scene_.materials[hit.material];
  const std::uint32_t texture = m.texture(MaterialInput::kEmission);
  if (texture == kNoTexture) return m.emission;
  const V3f c = textures_.color(texture, TexturePoint(scene_, hit, wo));
  return m.emission * V3f(std::max(0.0f, c.x), std::max(0.0f, c.y), std::max(0.0f, c.z));
}

float MaterialSet::opacity(const SurfaceInteraction& hit, const V3f& wo) const {
  const Material& m = scene_.materials[hit.material];
  const std::uint32_t texture = m.texture(MaterialInput::kOpacity);
  float opacity = m.opacity;
  if (m.vertex_alpha) opacity *= std::clamp(hit.vertex_alpha, 0.0f, 1.0f);
  if (texture != kNoTexture)
    opacity *= std::clamp(textures_.number(texture, TexturePoint(scene_, hit, wo)), 0.0f, 1.0f);
  if (m.opacity_cutoff > 0.0f) return opacity >= m.opacity_cutoff ? 1.0f : 0.0f;
  return opacity;
}

V3f MaterialSet::transmittance(std::uint32_t material, float length) const {
  const V3f& a = prepared_[material].absorption;
  return {std::exp(-a.x * length), std::exp(-a.y * length), std::exp(-a.z * length)};
}

}  // namespace morsel::render
