// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "renderer/accel/embree_handles.h"
#include "renderer/accel/interaction.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// The lights that rays can hit, as one Embree geometry each, numbered as in LightSet: rectangles,
// disks, spheres.
class LightGeometry {
 public:
  // Attaches them to `top` with the IDs `first_id`, `first_id` + 1, ...
  LightGeometry(const Scene& scene, const Device& device, RTCScene top, unsigned first_id);

  // Fills in p, normal and spawn points of the hit of `ray` at s.t on light s.light.
  void interact(const Ray& ray, const RTCHit& hit, SurfaceInteraction& s) const;

 private:
  struct Light {
    V3f centre;  // of a sphere
    V3f normal;  // of the others
    bool sphere;
    float magnitude;  // largest coordinate
  };
  void add(const Device& device, RTCScene top, RTCGeometry geometry, const LightFlags& flags,
           const std::string& name, const Light& light);

  unsigned first_id_;
  std::vector<Light> lights_;
};

}  // namespace morsel::render
