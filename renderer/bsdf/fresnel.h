// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/math/vector.h"

namespace morsel::render {

// Unpolarised reflectance of a dielectric interface for light that arrives at angle
// acos(cos_incident), cos_incident >= 0; `eta` is the index behind the interface over the index in
// front. Also gives the cosine of the refracted direction, 0 at total reflection.
inline float fresnel_dielectric(float cos_incident, float eta, float& cos_transmitted) {
  const float sin2 = std::max(0.0f, 1.0f - cos_incident * cos_incident) / (eta * eta);
  if (sin2 >= 1.0f) {
    cos_transmitted = 0.0f;
    return 1.0f;
  }
  cos_transmitted = std::sqrt(1.0f - sin2);
  // Numerators and denominators of both polarisations, over one common denominator.
  const float parallel = eta * cos_incident - cos_transmitted,
              under_parallel = eta * cos_incident + cos_transmitted;
  const float perpendicular = cos_incident - eta * cos_transmitted,
              under_perpendicular = cos_incident + eta * cos_transmitted;
  const float a = parallel * under_perpendicular, b = perpendicular * under_parallel;
  return 0.5f * (a * a + b * b) / square(under_parallel * under_perpendicular);
}

// Schlick's approximation from the reflectance at normal incidence.
inline V3f fresnel_schlick(const V3f& normal_reflectance, float cos_incident) {
  const float m = std::clamp(1.0f - cos_incident, 0.0f, 1.0f);
  const float m2 = m * m;
  return normal_reflectance + (V3f(1.0f) - normal_reflectance) * (m2 * m2 * m);
}

}  // namespace morsel::render
