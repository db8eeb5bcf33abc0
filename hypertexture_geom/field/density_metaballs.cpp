// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/density_metaballs.h"

#include <cmath>

#include "hypertexture_geom/field/formula.h"
#include "hypertexture_geom/field/impulse_model.h"

namespace morsel::geom {
namespace {

using topology::Box;

class Metaballs final : public Expression {
 public:
  Metaballs(ImpulseList balls, double level) : balls_(std::move(balls)), level_(level) {}

  double value(const Imath::V3d& x) const override { return balls_.value(x) - level_; }

  topology::Jet jet(const Imath::V3d& x) const override {
    topology::Jet jet;
    add_jet(balls_, x, jet);
    jet.value -= level_;
    return jet;
  }

  topology::LocalModel model(const Box& box) const override {
    RadialSum sum(box);
    add_terms(balls_, sum);
    sum.add_constant(-level_);
    return sum.finish();
  }

  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    const RadialSum frame(box);
    ImpulseList near;
    for (std::size_t n = 0; n < balls_.size(); ++n)
      if (const Impulse p = balls_[n]; reaches(p, frame.centre(), frame.half())) near.push_back(p);
    return std::make_unique<Metaballs>(std::move(near), level_);
  }

  TapeValue emit(TapeBuilder& tape) const override {
    return tape.multiply_add(tape.impulses(balls_), 1.0, -level_);
  }

  topology::Interval expected_range() const override {
    double lo = 0.0, hi = 0.0;
    for (std::size_t n = 0; n < balls_.size(); ++n) {
      const double w = balls_[n].weight;
      (w < 0.0 ? lo : hi) += w;
    }
    return {lo - level_, hi - level_};
  }

  // Where the sum of n positive balls reaches T > 0, one of them reaches T / n.
  std::optional<Box> superlevel_box(double level) const override {
    const double threshold = (level + level_) * (1.0 - 1e-12);
    if (level > expected_range().hi) return Box();
    if (!(threshold > 0.0)) return std::nullopt;
    double positive = 0.0;
    for (std::size_t n = 0; n < balls_.size(); ++n) positive += balls_[n].weight > 0.0 ? 1.0 : 0.0;
    Box all;
    for (std::size_t n = 0; n < balls_.size(); ++n) {
      const Impulse p = balls_[n];
      const double share = threshold / (positive * p.weight);
      if (!(p.weight > 0.0) || share > 1.0) continue;
      const double reach = std::sqrt((1.0 - std::cbrt(share) * (1.0 - 1e-12)) / p.inverse_square);
      all.extendBy(box_about(p.centre, Imath::V3d(reach)));
    }
    return all;
  }

 private:
  ImpulseList balls_;
  double level_;
};

}  // namespace

std::unique_ptr<Expression> make_metaballs(const std::vector<Metaball>& balls, double level) {
  ImpulseList list;
  list.reserve(balls.size());
  for (const Metaball& b : balls) list.push_back({b.centre, 1.0 / (b.radius * b.radius), b.weight});
  return std::make_unique<Metaballs>(std::move(list), level);
}

}  // namespace morsel::geom
