// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/accel/scene_accel.h"
#include "renderer/bsdf/lobe.h"
#include "renderer/camera/camera.h"
#include "renderer/film/film.h"
#include "renderer/integrator/render.h"
#include "renderer/light/light_set.h"
#include "renderer/material/material_set.h"
#include "renderer/sampler/sampler.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Unidirectional path tracing: at every vertex one direction towards a light and one by the BSDF,
// combined with the power heuristic (Veach 1997). At the first vertex, where most of the noise
// comes from, infinite and local lights get a light sample each. Narrow lobes are widened
// after wide ones (RenderSettings::regularization; the idea is Kaplanyan & Dachsbacher's, "Path
// Space Regularization for Holistic and Robust Light Transport", 2013). Holds references only;
// thread-safe.
class PathTracer {
 public:
  PathTracer(const Scene& scene, const SceneAccel& accel, const MaterialSet& materials,
             const LightSet& lights, const Camera& camera, DirectLighting direct_lighting)
      : scene_(scene),
        accel_(accel),
        materials_(materials),
        lights_(lights),
        camera_(camera),
        hypertextures_(accel.has_hypertextures()),
        direct_lighting_(direct_lighting) {}

  // One path that begins with `camera_ray`, whose direction is a unit vector. Its radiance may be
  // non-finite.
  PathSample trace(const Ray& camera_ray, const PixelSampler& sampler, RayCounts& rays) const;

 private:
  struct State;

  enum class Next { kHit, kEscaped, kBlocked };
  // The first hit that the path does not pass through a cut-out.
  Next next_hit(State& state, const PixelSampler& sampler, SurfaceInteraction& hit,
                RayCounts& rays) const;
  bool within_limits(State& state, const LobeSample& scattered) const;
  V3f visibility(Ray shadow, RayCounts& rays) const;
  // Takes a surface into account that light passes straight through, `length` of way after what
  // `travelled` counts.
  void pass(const SurfaceInteraction& hit, const V3f& direction, float length, float& travelled,
            V3f& throughput) const;

  V3f emitted_towards(const SurfaceInteraction& from, const LightSet::Sample& light) const;
  void add_light(V3f light, std::uint32_t light_group, int bounces, PathSample& sample) const;
  static void mark_non_finite(int bounces, PathSample& sample);
  void add_escaped(State& state, PathSample& sample) const;
  void add_light_hit(State& state, const SurfaceInteraction& hit, PathSample& sample) const;
  void add_emitted(State& state, const SurfaceInteraction& hit, const V3f& radiance,
                   std::uint32_t light, std::uint32_t light_group, PathSample& sample) const;
  void add_direct(const State& state, LightGroup group, const LightSet::LightPoint& point,
                  const SurfaceInteraction& hit, const class Bsdf& bsdf,
                  const PixelSampler& sampler, PathSample& sample, RayCounts& rays) const;
  float mis_weight(float this_pdf, float other_pdf, bool light_sample) const;

  const Scene& scene_;
  const SceneAccel& accel_;
  const MaterialSet& materials_;
  const LightSet& lights_;
  const Camera& camera_;
  bool hypertextures_;  // whether there are any
  DirectLighting direct_lighting_;
};

// Dimensions of the sampler: the position in the pixel, on the lens, in time; the path's are above.
enum CameraDimension : std::uint32_t {
  kPixelDimension,
  kLensDimension,
  kTimeDimension,
  kPathDimension
};

// The camera's ray through a place of the film.
inline Ray camera_ray(const Camera& camera, const PixelSampler& sampler, const V2f& film) {
  const V2f lens = camera.has_lens() ? sampler.get_2d(kLensDimension) : V2f(0.5f);
  const float time = camera.has_shutter() ? sampler.get_1d(kTimeDimension) : 0.0f;
  return camera.ray(film.x, film.y, lens, time);
}

}  // namespace morsel::render
