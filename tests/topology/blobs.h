// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "hypertexture_geom/field/radial_model.h"
#include "hypertexture_geom/field/truncated_cube.h"
#include "topology/scalar_field.h"

namespace morsel::topology::testing {

// F(x) = sum_i max(0, 1 - |x - c_i|^2 / r^2)^3 - level: blobs whose joining is known in closed form
// on the line between two centres.
class Blobs final : public ScalarField {
 public:
  Blobs(std::vector<Imath::V3d> centres, double radius, double level)
      : centres_(std::move(centres)), inverse_square_(1.0 / (radius * radius)), level_(level) {}

  double value(const Imath::V3d& x) const override { return jet(x).value; }

  Jet jet(const Imath::V3d& x) const override {
    Jet jet;
    jet.value = -level_;
    for (const Imath::V3d& c : centres_) {
      const Imath::V3d d = x - c;
      const double q = 1.0 - inverse_square_ * d.length2();
      if (q <= 0.0) continue;
      jet.value += q * q * q;
      jet.gradient -= d * (6.0 * inverse_square_ * q * q);
      const double mixed = 24.0 * inverse_square_ * inverse_square_ * q;
      const double products[6] = {d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.x * d.z, d.y * d.z};
      for (int i = 0; i < 6; ++i)
        jet.hessian[i] += mixed * products[i] - (i < 3 ? 6.0 * inverse_square_ * q * q : 0.0);
    }
    return jet;
  }

  LocalModel model(const Box& box) const override {
    geom::RadialSum sum(box);
    for (const Imath::V3d& c : centres_) {
      geom::RadialTerm t;
      t.d = sum.centre() - c;
      t.s = -inverse_square_;
      double near = 0.0, far = 0.0;
      for (int i = 0; i < 3; ++i) {
        const double a = std::abs(t.d[i]), low = std::max(0.0, a - sum.half()[i]),
                     high = a + sum.half()[i];
        near += low * low;
        far += high * high;
      }
      t.size = 1.0 + far * inverse_square_;
      const double slack = 1e-12 * t.size;
      if (near * inverse_square_ > 1.0 + slack) continue;  // nothing, not even rounding
      const geom::CubicPiece piece = geom::truncated_cube(1.0 - inverse_square_ * t.d.length2(),
                                                          1.0 - far * inverse_square_ - slack,
                                                          1.0 - near * inverse_square_ + slack);
      std::copy(piece.a, piece.a + 4, t.a);
      std::copy(piece.error, piece.error + 3, t.error);
      t.a_size[0] = t.size * t.size * t.size;
      t.a_size[1] = 3.0 * t.size * t.size;
      t.a_size[2] = 3.0 * t.size;
      t.a_size[3] = 1.0;
      sum.add(t);
    }
    sum.add_constant(-level_);
    return sum.finish();
  }

  std::unique_ptr<ScalarField> restricted_to(const Box&) const override {
    return std::make_unique<Blobs>(*this);
  }

 private:
  std::vector<Imath::V3d> centres_;
  double inverse_square_;
  double level_;
};

// F = constant.
class Constant final : public ScalarField {
 public:
  explicit Constant(double value) : value_(value) {}
  double value(const Imath::V3d&) const override { return value_; }
  Jet jet(const Imath::V3d&) const override { return {value_, Imath::V3d(0.0), {}}; }
  LocalModel model(const Box& box) const override {
    LocalModel m;
    m.centre = centre(box);
    m.half = half_size(box);
    m.c[0] = value_;
    m.add_rounding();
    return m;
  }
  std::unique_ptr<ScalarField> restricted_to(const Box&) const override {
    return std::make_unique<Constant>(*this);
  }

 private:
  double value_;
};

// F = slope * x + constant.
class Linear final : public ScalarField {
 public:
  Linear(const Imath::V3d& slope, double constant) : slope_(slope), constant_(constant) {}
  double value(const Imath::V3d& x) const override { return (slope_ ^ x) + constant_; }
  Jet jet(const Imath::V3d& x) const override { return {value(x), slope_, {}}; }
  LocalModel model(const Box& box) const override {
    LocalModel m;
    m.centre = centre(box);
    m.half = half_size(box);
    m.c[monomial::k1] = value(m.centre);
    for (int i = 0; i < 3; ++i) m.c[static_cast<std::size_t>(monomial::kX + i)] = slope_[i];
    m.add_rounding();
    return m;
  }
  std::unique_ptr<ScalarField> restricted_to(const Box&) const override {
    return std::make_unique<Linear>(*this);
  }

 private:
  Imath::V3d slope_;
  double constant_;
};

// Two blobs of radius 1 and level 0.3, side by side along `direction`, about the point `shift`. F
// on the axis between them is least half way, where it is 2 (1 - d^2/4)^3 - level for a distance d:
// d is such that this is `saddle`.
inline Blobs two_blobs(double saddle, const Imath::V3d& direction, const Imath::V3d& shift) {
  const double level = 0.3;
  const double d = 2.0 * std::sqrt(1.0 - std::cbrt((level + saddle) / 2.0));
  const Imath::V3d offset = direction.normalized() * (d / 2.0);
  return Blobs({shift + offset, shift - offset}, 1.0, level);
}

}  // namespace morsel::topology::testing
