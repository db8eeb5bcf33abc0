// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "hypertexture_geom/field/field.h"
#include "topology/certified.h"

namespace morsel::geom::test {

// F = (r^2 - |x - c|^2) / (2 r): quadratic, so its local models are exact and every ray has an
// answer in closed form. |grad F| is 1 on the surface.
class BallField : public Field {
 public:
  BallField(const Imath::V3d& centre, double radius) : centre_(centre), radius_(radius) {}

  double value(const Imath::V3d& x) const override {
    return (radius_ * radius_ - (x - centre_).length2()) / (2.0 * radius_);
  }

  topology::Jet jet(const Imath::V3d& x) const override {
    topology::Jet j;
    j.value = value(x);
    j.gradient = (centre_ - x) / radius_;
    for (int i = 0; i < 3; ++i) j.hessian[i] = -1.0 / radius_;
    return j;
  }

  topology::LocalModel model(const topology::Box& box) const override {
    topology::LocalModel m;
    m.centre = topology::centre(box);
    m.half = topology::half_size(box);
    const topology::Jet j = jet(m.centre);
    m.c[topology::monomial::k1] = j.value;
    for (int i = 0; i < 3; ++i) {
      m.c[topology::monomial::kX + i] = j.gradient[i];
      m.c[topology::monomial::kXX + i] = 0.5 * j.hessian[i];
    }
    m.value_error = 1e-14;
    m.gradient_error = Imath::V3d(1e-14);
    m.hessian_error = 1e-14;
    m.add_rounding();
    return m;
  }

  std::unique_ptr<topology::ScalarField> restricted_to(const topology::Box&) const override {
    return std::make_unique<BallField>(*this);
  }

  nlohmann::json canonical_json() const override { return {{"type", "ball"}}; }

  std::optional<topology::Box> solid_bounds() const override {
    return topology::Box(centre_ - Imath::V3d(radius_), centre_ + Imath::V3d(radius_));
  }

  // Parameters at which a ray meets the sphere, in order; none when it misses.
  std::optional<std::pair<double, double>> crossings(const Imath::V3d& o,
                                                     const Imath::V3d& d) const {
    const Imath::V3d p = o - centre_;
    const double a = d.length2(), b = p.dot(d), h2 = p.cross(d).length2() / a;
    if (!(h2 < radius_ * radius_)) return std::nullopt;
    const double half_chord = std::sqrt((radius_ * radius_ - h2) / a);
    return std::pair{-b / a - half_chord, -b / a + half_chord};
  }

  const Imath::V3d& centre() const { return centre_; }
  double radius() const { return radius_; }

 private:
  Imath::V3d centre_;
  double radius_;
};

inline std::shared_ptr<const topology::TopologyCache> certified_cache(
    const topology::ScalarField& field, const topology::CertifyOptions& options) {
  auto cache = std::make_shared<topology::TopologyCache>();
  cache->topology = topology::certify(field, options);
  return cache;
}

}  // namespace morsel::geom::test
