// SPDX-License-Identifier: Apache-2.0
#include "renderer/texture/ramp.h"

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::render {
namespace {

// Mean of the two principal curvatures of the surface F = 0, whose outward normal is -grad F:
// half the divergence of the normal.
double mean_curvature(const geom::Field& field, const V3f& p) {
  const topology::Jet jet = field.jet(V3d(p));
  const V3d& g = jet.gradient;
  const auto& h = jet.hessian;  // xx, yy, zz, xy, xz, yz
  const double g2 = g.dot(g);
  if (!(g2 > 0.0)) return 0.0;
  const double trace = h[0] + h[1] + h[2];
  const double along = g.x * g.x * h[0] + g.y * g.y * h[1] + g.z * g.z * h[2] +
                       2.0 * (g.x * g.y * h[3] + g.x * g.z * h[4] + g.y * g.z * h[5]);
  return -0.5 * (trace - along / g2) / std::sqrt(g2);
}

}  // namespace

SolidInputs::SolidInputs(const Scene& scene) {
  bool wanted = false;
  for (const Texture& t : scene.textures)
    wanted = wanted || std::holds_alternative<RampTexture>(t.kind);
  if (!wanted) return;
  for (std::size_t i = 0; i < scene.geometries.size(); ++i) {
    const auto* shape =
        std::get_if<std::shared_ptr<const geom::HypertextureGeometry>>(&scene.geometries[i].shape);
    if (shape == nullptr || !*shape) continue;
    Solid solid;
    solid.field = &(*shape)->field();
    nlohmann::json description = solid.field->canonical_json();
    description["modulations"] = nlohmann::json::array();
    solid.density = geom::field_from_json(description, {"density", ""});
    solid.components = std::max<std::size_t>(1, (*shape)->components().size());
    solids_[static_cast<std::uint32_t>(i)] = std::move(solid);
  }
}

std::optional<float> SolidInputs::value(RampInput input, const SurfaceInteraction& hit) const {
  if (input == RampInput::kHeight) return hit.object_p.y;
  const auto found = solids_.find(hit.geometry);
  if (found == solids_.end()) return std::nullopt;
  const Solid& solid = found->second;
  const V3d p(hit.object_p);
  switch (input) {
    case RampInput::kDensity:
      return static_cast<float>(solid.density->value(p));
    case RampInput::kNoise:
      return static_cast<float>(solid.field->value(p) - solid.density->value(p));
    case RampInput::kCurvature:
      return static_cast<float>(mean_curvature(*solid.field, hit.object_p));
    case RampInput::kComponent:
      if (hit.component == kNoIndex) return std::nullopt;
      return static_cast<float>(hit.component) / static_cast<float>(solid.components);
    case RampInput::kHeight:
      break;
  }
  return std::nullopt;
}

V3f ramp_color(const RampTexture& ramp, float x) {
  const float width = ramp.high - ramp.low;
  const float t = width != 0.0f ? (x - ramp.low) / width : 0.0f;
  const auto& stops = ramp.stops;
  if (!(t > stops.front().position)) return stops.front().color;
  for (std::size_t i = 1; i < stops.size(); ++i) {
    if (t > stops[i].position) continue;
    const float span = stops[i].position - stops[i - 1].position;
    const float f = span > 0.0f ? (t - stops[i - 1].position) / span : 1.0f;
    return stops[i - 1].color * (1.0f - f) + stops[i].color * f;
  }
  return stops.back().color;
}

}  // namespace morsel::render
