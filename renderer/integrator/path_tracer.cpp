// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/path_tracer.h"

#include "renderer/bsdf/bsdf.h"

namespace morsel::render {
namespace {

// Vertices from here on are cut by Russian roulette.
constexpr int kRouletteStart = 3;

// Shadow rays stop short of a light's own surface by this fraction.
constexpr float kShadowLength = 0.9999f;

enum VertexDimension : std::uint32_t {
  kLobe,
  kDirection,
  kLightChoice,
  kLightPoint,
  kEnvironmentPoint,
  kRoulette,
  kPerVertex
};

std::uint32_t dimension(int vertex, VertexDimension use) {
  return kPixelDimension + 1 + static_cast<std::uint32_t>(vertex) * kPerVertex + use;
}

V3f clamped_to_one(const V3f& c) {
  return {std::min(c.x, 1.0f), std::min(c.y, 1.0f), std::min(c.z, 1.0f)};
}

}  // namespace

struct PathTracer::State {
  Ray ray;
  V3f throughput{1.0f};
  float eta_scale = 1.0f;  // what refraction took from the throughput and will give back
  int vertex = 0;          // 0: the first hit
  // How the ray was chosen; a camera ray or a delta lobe has no competing light sample.
  V3f previous_p{0.0f};
  float previous_pdf = 0.0f;
  bool previous_delta = true;
  bool previous_split = false;  // there were two light samples, one for each group
  float smallest_alpha = 0.0f;  // regularization: of lobes to come
  // Albedo and normal wait for the first vertex that is not a delta lobe.
  bool features_open = true;
  V3f feature_tint{1.0f};
};

float PathTracer::mis_weight(float this_pdf, float other_pdf, bool light_sample) const {
  switch (direct_lighting_) {
    case DirectLighting::kLightsOnly:
      return light_sample ? 1.0f : 0.0f;
    case DirectLighting::kBsdfOnly:
      return light_sample ? 0.0f : 1.0f;
    case DirectLighting::kMis:
      break;
  }
  // Quotient form: squares of large densities would overflow.
  const float ratio = other_pdf / this_pdf;
  return 1.0f / (1.0f + ratio * ratio);
}

void PathTracer::add_escaped(State& state, PathSample& sample) const {
  const auto& environment = lights_.environment();
  if (!environment || (state.vertex == 0 && !lights_.environment_visible_to_camera())) return;
  if (state.vertex == 0) sample.alpha = 1.0f;
  const V3f& wi = state.ray.direction;
  const LightGroup group = state.previous_split ? LightGroup::kEnvironment : LightGroup::kAll;
  const float weight =
      state.previous_delta
          ? 1.0f
          : mis_weight(state.previous_pdf, lights_.environment_pdf(group, state.previous_p, wi),
                       false);
  sample.radiance += state.throughput * environment->radiance(wi) * weight;
}

void PathTracer::add_rectangle(State& state, const SurfaceInteraction& hit,
                               PathSample& sample) const {
  const Rectangle& light = lights_.rectangle(hit.light);
  const V3f& wi = state.ray.direction;
  const bool emits = dot(wi, light.normal()) < 0.0f;
  if (state.features_open) {
    state.features_open = false;
    sample.albedo = emits ? state.feature_tint * clamped_to_one(light.radiance()) : V3f(0.0f);
    sample.normal = emits ? light.normal() : -light.normal();
  }
  if (!emits) return;
  const LightGroup group = state.previous_split ? LightGroup::kRectangles : LightGroup::kAll;
  const float weight =
      state.previous_delta
          ? 1.0f
          : mis_weight(state.previous_pdf,
                       lights_.rectangle_pdf(group, hit.light, state.previous_p, wi, hit.t), false);
  sample.radiance += state.throughput * light.radiance() * weight;
}

void PathTracer::add_direct(const State& state, LightGroup group, const SurfaceInteraction& hit,
                            const Bsdf& bsdf, const PixelSampler& sampler, PathSample& sample,
                            RayCounts& rays) const {
  const auto use = group == LightGroup::kEnvironment ? kEnvironmentPoint : kLightPoint;
  const LightSample light =
      lights_.sample(group, hit.p, sampler.get_1d(dimension(state.vertex, kLightChoice)),
                     sampler.get_2d(dimension(state.vertex, use)));
  if (!(light.pdf > 0.0f)) return;
  const LobeValue lobe = bsdf.evaluate(light.wi);
  if (!(max_component(lobe.value) > 0.0f)) return;

  Ray shadow;
  shadow.origin = hit.spawn(light.wi);
  shadow.direction = light.wi;
  if (std::isfinite(light.distance)) {
    // From the spawn point, which is not quite hit.p, to the same point of the light.
    shadow.direction = hit.p + light.wi * light.distance - shadow.origin;
    shadow.tfar = kShadowLength;
  }
  ++rays.shadow;
  if (accel_.occluded(shadow)) return;
  sample.radiance += state.throughput * lobe.value * light.radiance *
                     (mis_weight(light.pdf, lobe.pdf, true) / light.pdf);
}

PathSample PathTracer::trace(float x, float y, const PixelSampler& sampler, RayCounts& rays) const {
  PathSample result;
  State state;
  state.ray.origin = camera_.position();
  state.ray.direction = camera_.direction(x, y);

  for (;; ++state.vertex) {
    SurfaceInteraction hit;
    const bool first = state.vertex == 0;
    ++(first ? rays.camera : rays.bounce);
    if (!accel_.intersect(state.ray, first ? RayKind::kCamera : RayKind::kOther, hit)) {
      add_escaped(state, result);
      break;
    }
    if (first) {
      result.alpha = 1.0f;
      result.depth = hit.t * dot(state.ray.direction, camera_.forward());
      if (hit.component != kNoIndex) result.component = 1.0f + static_cast<float>(hit.component);
    }
    if (hit.light != kNoIndex) {
      add_rectangle(state, hit, result);
      break;
    }
    if (state.vertex > scene_.settings.max_depth) break;

    const V3f wo = -state.ray.direction;
    const Bsdf bsdf(materials_.parameters(hit, state.smallest_alpha), hit.geometric_normal,
                    hit.shading_normal, wo);
    const bool delta = bsdf.delta();
    if (state.features_open && !delta) {
      state.features_open = false;
      result.albedo = state.feature_tint * bsdf.albedo();
      result.normal = bsdf.shading_normal();
    }
    if (!delta && direct_lighting_ != DirectLighting::kBsdfOnly) {
      if (first) {
        add_direct(state, LightGroup::kEnvironment, hit, bsdf, sampler, result, rays);
        add_direct(state, LightGroup::kRectangles, hit, bsdf, sampler, result, rays);
      } else {
        add_direct(state, LightGroup::kAll, hit, bsdf, sampler, result, rays);
      }
    }

    const auto scattered = bsdf.sample(sampler.get_1d(dimension(state.vertex, kLobe)),
                                       sampler.get_2d(dimension(state.vertex, kDirection)));
    if (!scattered) break;
    state.throughput *= scattered->weight;
    state.eta_scale *= scattered->eta_squared;
    if (state.features_open)
      state.feature_tint *= clamped_to_one(scattered->weight * scattered->eta_squared);

    const float survival = std::min(1.0f, max_component(state.throughput) * state.eta_scale);
    if (!(survival > 0.0f)) break;
    if (state.vertex + 1 >= kRouletteStart && survival < 1.0f) {
      if (sampler.get_1d(dimension(state.vertex, kRoulette)) >= survival) break;
      state.throughput /= survival;
    }
    state.smallest_alpha =
        std::max(state.smallest_alpha, scene_.settings.regularization * bsdf.spread());
    state.previous_p = hit.p;
    state.previous_pdf = scattered->pdf;
    state.previous_delta = scattered->delta;
    state.previous_split = first;
    state.ray.origin = hit.spawn(scattered->wi);
    state.ray.direction = scattered->wi;
  }
  return result;
}

}  // namespace morsel::render
