// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/path_tracer.h"

#include "renderer/bsdf/bsdf.h"

namespace morsel::render {
namespace {

// Vertices from here on are cut by Russian roulette.
constexpr int kRouletteStart = 3;

// Shadow rays stop short of a light's own surface by this fraction.
constexpr float kShadowLength = 0.9999f;

// Angle of the footprint of rays that a matte surface scatters, radians.
constexpr float kLobeAngle = 0.1f;

// Surfaces of partial opacity that a path or a shadow ray passes before it counts as blocked.
constexpr int kMostCutouts = 256;

enum VertexDimension : std::uint32_t {
  kLobeAndTexture,
  kDirection,
  kLightChoice,
  kLightPoint,
  kInfinitePoint,
  kRoulette,
  kPerVertex
};

std::uint32_t dimension(int vertex, VertexDimension use) {
  return kPathDimension + static_cast<std::uint32_t>(vertex) * kPerVertex + use;
}
// Apart from those of all vertices.
std::uint32_t cutout_dimension(int vertex, int passed) {
  return 0x40000000u + static_cast<std::uint32_t>(vertex * kMostCutouts + passed);
}

// Counts a ray, and what the calling thread's queries in its scope cost if they can.
class CountedRay {
 public:
  CountedRay(RayCounts& rays, RayUse use, bool can_cost)
      : cost_(rays.costs[static_cast<std::size_t>(use)]), can_cost_(can_cost) {
    if (can_cost_) before_ = hypertexture_cost();
    ++(use == RayUse::kCamera ? rays.camera : use == RayUse::kBounce ? rays.bounce : rays.shadow);
  }
  ~CountedRay() {
    if (!can_cost_) {
      cost_.add_ray(0, 0);
      return;
    }
    const HypertextureCost now = hypertexture_cost();
    cost_.add_ray(now.evaluations - before_.evaluations, now.filtered - before_.filtered);
  }
  CountedRay(const CountedRay&) = delete;
  CountedRay& operator=(const CountedRay&) = delete;

 private:
  RayCost& cost_;
  bool can_cost_;
  HypertextureCost before_;
};

// Of what is no number 1.
V3f clamped_to_one(const V3f& c) {
  return {std::min(1.0f, c.x), std::min(1.0f, c.y), std::min(1.0f, c.z)};
}

}  // namespace

struct PathTracer::State {
  Ray ray;
  V3f throughput{1.0f};
  float eta_scale = 1.0f;  // what refraction took from the throughput and will give back
  int vertex = 0;          // 0: the first hit
  int diffuse = 0, glossy = 0, transmitted = 0;  // bounces so far
  bool ends = false;                             // the limits leave it no more than light to find
  float travelled = 0.0f;                        // from the last vertex through cut-outs
  float inside = 0.0f;  // of that, since it passed into the body, if there is one, that absorbs
  float cone_width = 0.0f, cone_angle = 0.0f;  // of the ray's footprint, at the last vertex
  // How the ray was chosen; a camera ray or a delta lobe has no competing light sample.
  V3f previous_p{0.0f};
  float previous_pdf = 0.0f;
  bool previous_delta = true;
  LightSet::Direction towards;  // of `ray`, from the first bounce on
  bool previous_split = false;  // there were two light samples, one for each group
  float smallest_alpha = 0.0f;  // regularization: of lobes to come
  // Albedo and normal wait for the first vertex that is not a delta lobe.
  bool features_open = true;
  V3f feature_tint{1.0f};

  LightGroup group(LightGroup one) const { return previous_split ? one : LightGroup::kAll; }
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

// The first is what the others follow from. The radiance shows it, whatever is added to it later.
void PathTracer::mark_non_finite(int bounces, PathSample& sample) {
  if (sample.non_finite_bounce != PathSample::kAllFinite) return;
  sample.non_finite_bounce = static_cast<std::uint32_t>(bounces);
  sample.radiance = V3f(std::numeric_limits<float>::quiet_NaN());
}

// Light that left the scene's surface or the sky `bounces` bounces before the camera.
void PathTracer::add_light(V3f light, std::uint32_t light_group, int bounces,
                           PathSample& sample) const {
  if (!is_finite(light)) mark_non_finite(bounces, sample);
  const float limit = scene_.settings.indirect_clamp;
  if (bounces > 1 && limit > 0.0f) {
    const float brightest = max_component(light);
    if (brightest > limit) light *= limit / brightest;
  }
  sample.radiance += light;
  if (light_group < kMaxLightGroups) sample.groups[light_group] += light;
}

void PathTracer::add_escaped(State& state, PathSample& sample) const {
  const LightGroup group = state.group(LightGroup::kInfinite);
  if (state.vertex == 0) lights_.find(state.ray.direction, state.towards);
  for (std::size_t i = 0; i < lights_.infinite_count(); ++i) {
    if (state.vertex == 0 && !lights_.infinite_visible_to_camera(i)) continue;
    const auto [radiance, pdf] =
        state.previous_delta
            ? Environment::Arriving{lights_.infinite_radiance(i, state.towards), 0.0f}
            : lights_.infinite_arriving(group, i, state.previous_p, state.towards);
    if (state.vertex == 0 && i == 0 && lights_.has_environment()) sample.alpha = 1.0f;
    if (is_black(radiance)) continue;
    const float weight = state.previous_delta ? 1.0f : mis_weight(state.previous_pdf, pdf, false);
    add_light(state.throughput * radiance * weight, lights_.infinite_light_group(i), state.vertex,
              sample);
  }
}

void PathTracer::add_emitted(State& state, const SurfaceInteraction& hit, const V3f& radiance,
                             std::uint32_t light, std::uint32_t light_group,
                             PathSample& sample) const {
  float weight = 1.0f;
  // What no light sample finds is left to the BSDF's alone.
  if (!state.previous_delta && light != LightSet::kNoLight)
    weight = mis_weight(state.previous_pdf,
                        lights_.local_pdf(state.group(LightGroup::kLocal), light, state.previous_p,
                                          state.ray.direction, state.travelled + hit.t),
                        false);
  add_light(state.throughput * radiance * weight, light_group, state.vertex, sample);
}

// A light of LightSet is the end of the path.
void PathTracer::add_light_hit(State& state, const SurfaceInteraction& hit,
                               PathSample& sample) const {
  const bool facing = dot(state.ray.direction, hit.geometric_normal) < 0.0f;
  const V3f radiance = lights_.local_radiance(hit.light, state.ray.direction, facing);
  if (state.features_open) {
    state.features_open = false;
    sample.albedo = state.feature_tint * clamped_to_one(radiance);
    sample.normal = facing ? hit.geometric_normal : -hit.geometric_normal;
  }
  if (!is_black(radiance))
    add_emitted(state, hit, radiance, hit.light, lights_.local_light_group(hit.light), sample);
}

void PathTracer::pass(const SurfaceInteraction& hit, const V3f& direction, float length,
                      float& travelled, V3f& throughput) const {
  travelled += length;
  if (!materials_.absorbs(hit.material)) return;
  if (dot(direction, hit.geometric_normal) > 0.0f)  // out of it
    throughput *= materials_.transmittance(hit.material, travelled);
  travelled = 0.0f;
}

// Share of light that comes through; 0 when something is in the way.
V3f PathTracer::visibility(Ray shadow, RayCounts& rays) const {
  constexpr float kBlocked = 0.0f;
  {
    const CountedRay counted(rays, RayUse::kShadow, hypertextures_);
    if (accel_.occluded(shadow)) return V3f(kBlocked);
  }
  V3f passed(1.0f);
  if (!accel_.has_cutouts()) return passed;
  float inside = 0.0f;
  for (int i = 0; i < kMostCutouts; ++i) {
    SurfaceInteraction hit;
    const CountedRay counted(rays, RayUse::kShadow, hypertextures_);
    if (!accel_.intersect(shadow, RayKind::kCutout, hit)) return passed;
    passed *= 1.0f - materials_.opacity(hit, -normalize(shadow.direction));
    pass(hit, shadow.direction, hit.t * shadow.direction.length(), inside, passed);
    if (is_black(passed)) return V3f(kBlocked);
    // On from behind the surface, to the same end.
    const V3f end = shadow.origin + shadow.direction * shadow.tfar;
    shadow.origin = hit.spawn(shadow.direction);
    if (std::isfinite(shadow.tfar)) {
      shadow.direction = end - shadow.origin;
      shadow.tfar = 1.0f;
    }
  }
  return V3f(kBlocked);
}

// The radiance of a light sample: where a texture varies what a mesh emits it is asked, and what
// part of it is there at all.
V3f PathTracer::emitted_towards(const SurfaceInteraction& from,
                                const LightSet::Sample& light) const {
  if (light.instance == LightSet::kNoLight) return light.radiance;
  const Instance& instance = scene_.instances[light.instance];
  if (!materials_.emission_is_textured(instance.material) && materials_.opaque(instance.material))
    return light.radiance;
  SurfaceInteraction on;
  on.instance = light.instance;
  on.geometry = instance.geometry;
  on.material = instance.material;
  on.primitive = light.triangle;
  on.p = from.p + light.wi * light.distance;
  on.uv = light.on_light;
  const auto& mesh = std::get<TriangleMesh>(scene_.geometries[on.geometry].shape);
  const Imath::V3i& t = mesh.triangles[light.triangle];
  const float b1 = light.on_light.x, b2 = light.on_light.y;
  const auto corner = [&](int k) { return static_cast<std::size_t>(t[k]); };
  const auto mixed = [&](const auto& values) {
    return values[corner(0)] * (1.0f - b1 - b2) + values[corner(1)] * b1 + values[corner(2)] * b2;
  };
  on.object_p = mixed(mesh.positions);
  if (!mesh.uvs.empty()) on.uv = mixed(mesh.uvs);
  on.uv1 = mesh.uvs1.empty() ? on.uv : mixed(mesh.uvs1);
  on.geometric_normal = on.shading_normal = -light.wi;
  if (!mesh.alphas.empty()) on.vertex_alpha = mixed(mesh.alphas);
  const V3f emitted = materials_.emission(on, -light.wi);
  if (materials_.opaque(instance.material)) return emitted;
  return emitted * materials_.opacity(on, -light.wi);
}

void PathTracer::add_direct(const State& state, LightGroup group, const LightSet::LightPoint& point,
                            const SurfaceInteraction& hit, const Bsdf& bsdf,
                            const PixelSampler& sampler, PathSample& sample,
                            RayCounts& rays) const {
  const float choice =
      lights_.chooses(group) ? sampler.get_1d(dimension(state.vertex, kLightChoice)) : 0.0f;
  const auto light = lights_.sample(group, hit.p, choice, point);
  if (light.pdf <= 0.0f || is_black(light.radiance)) return;
  const LobeValue lobe = bsdf.evaluate(light.wi);
  if (is_black(lobe.value)) return;

  Ray shadow;
  shadow.time = state.ray.time;
  shadow.origin = hit.spawn(light.wi);
  shadow.direction = light.wi;
  if (std::isfinite(light.distance)) {
    // From the spawn point, which is not quite hit.p, to the same point of the light.
    shadow.direction = hit.p + light.wi * light.distance - shadow.origin;
    shadow.tfar = kShadowLength;
  }
  const V3f visible = visibility(shadow, rays);
  if (is_black(visible)) return;
  const float weight = light.delta ? 1.0f : mis_weight(light.pdf, lobe.pdf, true);
  add_light(
      state.throughput * lobe.value * emitted_towards(hit, light) * visible * (weight / light.pdf),
      light.light_group, state.vertex + 1, sample);
}

PathTracer::Next PathTracer::next_hit(State& state, const PixelSampler& sampler,
                                      SurfaceInteraction& hit, RayCounts& rays) const {
  const bool first = state.vertex == 0;
  state.travelled = state.inside = 0.0f;
  for (int passed = 0; passed < kMostCutouts; ++passed) {
    const CountedRay counted(rays, first ? RayUse::kCamera : RayUse::kBounce, hypertextures_);
    if (!accel_.intersect(state.ray, first ? RayKind::kCamera : RayKind::kBounce, hit))
      return Next::kEscaped;
    if (hit.light != kNoIndex || materials_.opaque(hit.material)) return Next::kHit;
    hit.footprint = state.cone_width + state.cone_angle * (state.travelled + hit.t);
    const float opacity = materials_.opacity(hit, -state.ray.direction);
    if (opacity >= 1.0f) return Next::kHit;
    if (sampler.get_1d(cutout_dimension(state.vertex, passed)) < opacity) return Next::kHit;
    state.travelled += hit.t;
    pass(hit, state.ray.direction, hit.t, state.inside, state.throughput);
    state.ray.origin = hit.spawn(state.ray.direction);
  }
  return Next::kBlocked;
}

// Counts a bounce; whether the path may go on from what it meets next.
bool PathTracer::within_limits(State& state, const LobeSample& scattered) const {
  const RenderSettings& s = scene_.settings;
  if (scattered.transmission) return ++state.transmitted <= s.max_transmission_depth;
  if (scattered.diffuse) return ++state.diffuse <= s.max_diffuse_depth;
  return ++state.glossy <= s.max_glossy_depth;
}

PathSample PathTracer::trace(const Ray& camera_ray, const PixelSampler& sampler,
                             RayCounts& rays) const {
  PathSample result;
  State state;
  state.ray = camera_ray;
  state.cone_width = camera_.pixel_width();
  state.cone_angle = camera_.pixel_angle();

  for (;; ++state.vertex) {
    SurfaceInteraction hit;
    const bool first = state.vertex == 0;
    const std::uint64_t evaluations =
        rays.costs[static_cast<std::size_t>(RayUse::kCamera)].evaluations;
    // The light sample that every vertex gets; what it needs of memory comes while the ray is
    // traced, and then while the surface is looked up.
    const LightGroup from = first ? LightGroup::kInfinite : LightGroup::kAll;
    const bool last = state.ends || state.vertex > scene_.settings.max_depth;
    const bool lit = !last && direct_lighting_ != DirectLighting::kBsdfOnly && lights_.any(from);
    LightSet::LightPoint light_point;
    if (lit)
      lights_.point(from,
                    sampler.get_2d(dimension(state.vertex, first ? kInfinitePoint : kLightPoint)),
                    light_point);
    const Next next = next_hit(state, sampler, hit, rays);
    if (first)
      result.steps = static_cast<float>(
          rays.costs[static_cast<std::size_t>(RayUse::kCamera)].evaluations - evaluations);
    if (next == Next::kEscaped) add_escaped(state, result);
    if (next != Next::kHit) break;
    if (first) {
      result.alpha = 1.0f;
      result.depth = camera_.depth(hit.p);
      result.position = hit.p;
      result.geometric_normal = dot(hit.geometric_normal, state.ray.direction) > 0.0f
                                    ? -hit.geometric_normal
                                    : hit.geometric_normal;
      result.instance = hit.instance;
      result.material = hit.light == kNoIndex ? hit.material : kNoIndex;
      if (hit.component != kNoIndex) result.component = 1.0f + static_cast<float>(hit.component);
    }
    if (hit.light != kNoIndex) {
      add_light_hit(state, hit, result);
      break;
    }
    const V3f wo = -state.ray.direction;
    hit.footprint = state.cone_width + state.cone_angle * (state.travelled + hit.t);
    const bool textured = materials_.textured(hit.material);
    V2f choices(0.0f);
    if (textured || !last) choices = sampler.get_2d(dimension(state.vertex, kLobeAndTexture));
    if (textured) hit.texture_random = choices.y;
    if (materials_.absorbs(hit.material) && dot(wo, hit.geometric_normal) < 0.0f)
      state.throughput *= materials_.transmittance(hit.material, state.inside + hit.t);
    if (materials_.emits(hit.material)) {
      const V3f emitted = materials_.emission(hit, wo);
      const std::uint32_t light = lights_.emissive_triangle(hit.instance, hit.primitive);
      if (!is_black(emitted))
        add_emitted(state, hit, emitted, light, scene_.materials[hit.material].group, result);
    }
    if (last) break;

    if (lit) lights_.fetch(light_point);
    const MaterialSet::Shading shading = materials_.shade(hit, wo, state.smallest_alpha);
    const Bsdf bsdf(shading.parameters, hit.geometric_normal, shading.normal, wo);
    const bool delta = bsdf.delta();
    if (state.features_open && !delta) {
      state.features_open = false;
      result.albedo = clamped_to_one(state.feature_tint * bsdf.albedo());
      result.normal = bsdf.shading_normal();
    }
    if (!delta && lit) add_direct(state, from, light_point, hit, bsdf, sampler, result, rays);
    if (!delta && first && direct_lighting_ != DirectLighting::kBsdfOnly &&
        lights_.any(LightGroup::kLocal)) {
      light_point.u = sampler.get_2d(dimension(state.vertex, kLightPoint));
      add_direct(state, LightGroup::kLocal, light_point, hit, bsdf, sampler, result, rays);
    }

    const auto scattered =
        bsdf.sample(choices.x, sampler.get_2d(dimension(state.vertex, kDirection)));
    if (!scattered) break;
    // The light samples count on this ray for their part of the light it finds, as at max_depth.
    state.ends = !within_limits(state, *scattered);
    state.throughput *= scattered->weight;
    state.eta_scale *= scattered->eta_squared;
    if (!is_finite(state.throughput)) {
      mark_non_finite(state.vertex + 1, result);
      break;
    }
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
    // What a wide lobe sees need not be sharp.
    state.cone_width = hit.footprint;
    state.cone_angle = std::max(state.cone_angle, kLobeAngle * bsdf.spread());
    state.previous_p = hit.p;
    state.previous_pdf = scattered->pdf;
    state.previous_delta = scattered->delta;
    state.previous_split = first;
    state.ray.origin = hit.spawn(scattered->wi);
    state.ray.direction = scattered->wi;
    lights_.find(scattered->wi, state.towards);  // many rays escape
  }
  // A sum of finite lights may overflow.
  if (!is_finite(result.radiance)) mark_non_finite(state.vertex, result);
  return result;
}

}  // namespace morsel::render
