// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "renderer/math/vector.h"

// What every light that is somewhere (rectangle.h, disk.h, ball.h, emissive_triangle.h, point.h)
// offers:
//
//   LightSample sample(p, u) const;        a direction from p to the light; pdf 0: none
//   float pdf(p, wi, distance) const;      density of sample(p) in `wi`, which hits the light there
//   float importance(p) const;             roughly the irradiance it can cause at p; 0 only where
//                                          it casts no light at all
//   LightBounds bounds() const;            for the light tree
namespace morsel::render {

struct LightSample {
  V3f wi{0.0f};        // unit, towards the light
  V3f radiance{0.0f};  // that arrives from there if nothing is in between
  float pdf = 0.0f;    // per solid angle; 0: no sample. Of a delta light the chance of choosing it
  float distance = 0;  // to the light's point; may be infinite
  V2f on_light{0.0f, 0.0f};  // of a triangle: barycentric coordinates of the point
  bool delta = false;        // `radiance` is an irradiance; no other strategy finds this light
};

// Where a set of lights is and which way it shines.
struct LightBounds {
  V3f low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
  V3f axis{0.0f, 0.0f, 1.0f};  // all normals are within `spread` of it
  float spread = kPi;          // radians; pi: any direction
  bool two_sided = false;      // shines along its normals and against them
  float power = 0.0f;          // luminance of radiance times area

  static LightBounds join(const LightBounds& a, const LightBounds& b);
  float surface_area() const;
  // An estimate of the irradiance at `p`, 0 only where none of the lights shines.
  float importance(const V3f& p) const;
};

}  // namespace morsel::render
