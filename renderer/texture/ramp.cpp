// SPDX-License-Identifier: Apache-2.0
#include "renderer/texture/ramp.h"

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::render {

std::optional<float> ramp_input(const Scene& scene, RampInput input,
                                const SurfaceInteraction& hit) {
  if (input == RampInput::kHeight) return hit.object_p.y;
  const auto* shape = std::get_if<std::shared_ptr<const geom::HypertextureGeometry>>(
      &scene.geometries[hit.geometry].shape);
  if (shape == nullptr) return std::nullopt;
  const geom::HypertextureGeometry& hypertexture = **shape;
  if (input == RampInput::kComponent) {
    if (hit.component == kNoIndex) return std::nullopt;
    const std::size_t count = hypertexture.components().size();
    return static_cast<float>(hit.component) / static_cast<float>(std::max<std::size_t>(1, count));
  }
  const geom::SurfaceDetail detail = hypertexture.detail(hit.primitive, V3d(hit.object_p));
  switch (input) {
    case RampInput::kDensity:
      return static_cast<float>(detail.density);
    case RampInput::kNoise:
      return static_cast<float>(detail.noise);
    case RampInput::kCurvature:
      return static_cast<float>(detail.curvature.mean);
    case RampInput::kComponent:
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
