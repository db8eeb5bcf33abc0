// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/density_sphere.h"

#include <algorithm>
#include <cmath>

#include "hypertexture_geom/field/radial_batch.h"
#include "hypertexture_geom/field/radial_model.h"
#include "hypertexture_geom/field/tape_builder.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;

class Sphere final : public Expression {
 public:
  Sphere(const Imath::V3d& centre, double radius, double smoothing)
      : centre_(centre), radius_(radius), square_(smoothing * smoothing) {}

  double value(const Imath::V3d& x) const override {
    return radius_ - std::sqrt((x - centre_).length2() + square_);
  }

  Jet jet(const Imath::V3d& x) const override {
    const Imath::V3d d = x - centre_;
    const double r = std::sqrt(d.length2() + square_), inverse = 1.0 / r;
    const Imath::V3d n = d * inverse;
    Jet jet;
    jet.value = radius_ - r;
    jet.gradient = -n;
    const double h[6] = {n.x * n.x - 1.0, n.y * n.y - 1.0, n.z * n.z - 1.0,
                         n.x * n.y,       n.x * n.z,       n.y * n.z};
    for (int i = 0; i < 6; ++i) jet.hessian[i] = h[i] * inverse;
    return jet;
  }

  LocalModel model(const Box& box) const override {
    RadialSum sum(box);
    RadialTerm t;
    t.d = sum.centre() - centre_;
    t.s = 1.0;
    const Imath::V3d& h = sum.half();
    double nearest = square_, farthest = square_;
    for (int i = 0; i < 3; ++i) {
      const double a = std::abs(t.d[i]), low = std::max(0.0, a - h[i]), high = a + h[i];
      nearest += low * low;
      farthest += high * high;
    }
    nearest *= 1.0 - 1e-12;
    farthest *= 1.0 + 1e-12;
    // Taylor polynomial of -sqrt about q0 with Lagrange's remainder: the fourth derivative is 15/16
    // q^(-7/2).
    const double q0 = t.d.length2() + square_, root = std::sqrt(q0);
    const double e = std::max(farthest - q0, q0 - nearest) + 1e-12 * farthest;
    const double lowest = std::sqrt(nearest);
    const double fourth = 15.0 / 16.0 / (lowest * nearest * nearest * nearest);
    t.error[0] = fourth * e * e * e * e / 24.0;
    t.error[1] = fourth * e * e * e / 6.0;
    t.error[2] = fourth * e * e / 2.0;
    t.size = farthest;
    const double highest = std::sqrt(farthest), half_range = 0.5 * (highest - lowest);
    if (!(t.error[0] < half_range)) {
      // Too wide a box for that: the plain range. |grad D| < 1, and its derivatives are at most 1 /
      // lowest.
      sum.add_constant(radius_ - 0.5 * (highest + lowest),
                       half_range + 1e-12 * (highest + std::abs(radius_)), Imath::V3d(1.0),
                       1.0 / lowest);
      return sum.finish();
    }
    t.a[0] = -root;
    t.a[1] = -0.5 / root;
    t.a[2] = 0.125 / (root * q0);
    t.a[3] = -0.0625 / (root * q0 * q0);
    t.a_size[0] = highest;
    t.a_size[1] = 0.5 / lowest;
    t.a_size[2] = 0.125 / (lowest * nearest);
    t.a_size[3] = 0.0625 / (lowest * nearest * nearest);
    sum.add(t);
    sum.add_constant(radius_);
    return sum.finish();
  }

  void child_models(const Box& box, unsigned /*wanted*/, topology::ModelBatch& out) const override {
    out.start(box);
    child_models_of_sphere(centre_, radius_, square_, out);
  }

  std::unique_ptr<ScalarField> restricted_to(const Box&) const override {
    return std::make_unique<Sphere>(*this);
  }

  TapeValue emit(TapeBuilder& tape) const override {
    const Imath::V3d rows[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    return tape.multiply_add(tape.root(tape.squares(rows, centre_, square_), square_), -1.0,
                             radius_);
  }

  Interval expected_range() const override {
    return {-std::numeric_limits<double>::infinity(), radius_};
  }

  std::optional<Box> superlevel_box(double level) const override {
    const double reach = (radius_ - level) * (1.0 + 1e-12) + 1e-300;
    if (reach < 0.0) return Box();
    const Imath::V3d r(reach);
    return Box(centre_ - r, centre_ + r);
  }

 private:
  Imath::V3d centre_;
  double radius_;
  double square_;
};

}  // namespace

std::unique_ptr<Expression> make_sphere(const Imath::V3d& centre, double radius, double smoothing) {
  return std::make_unique<Sphere>(centre, radius, smoothing);
}

}  // namespace morsel::geom
