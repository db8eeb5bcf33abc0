// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/accel/scene_accel.h"
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
// comes from, the environment and the rectangles get a light sample each. Narrow lobes are widened
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
        direct_lighting_(direct_lighting) {}

  // One path through image position (x, y), in pixels. Its radiance may be non-finite.
  PathSample trace(float x, float y, const PixelSampler& sampler, RayCounts& rays) const;

 private:
  struct State;

  void add_escaped(State& state, PathSample& sample) const;
  void add_rectangle(State& state, const SurfaceInteraction& hit, PathSample& sample) const;
  void add_direct(const State& state, LightGroup group, const SurfaceInteraction& hit,
                  const class Bsdf& bsdf, const PixelSampler& sampler, PathSample& sample,
                  RayCounts& rays) const;
  float mis_weight(float this_pdf, float other_pdf, bool light_sample) const;

  const Scene& scene_;
  const SceneAccel& accel_;
  const MaterialSet& materials_;
  const LightSet& lights_;
  const Camera& camera_;
  DirectLighting direct_lighting_;
};

// The sampler's dimension of the position in the pixel; the path uses those above.
inline constexpr std::uint32_t kPixelDimension = 0;

}  // namespace morsel::render
