// SPDX-License-Identifier: Apache-2.0
// RadialSum for one box a lane; see radial_model.cpp for where each bound comes from.
#if defined(MORSEL_FIELD_RADIAL_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MORSEL_FIELD_RADIAL_LANES_INL_H_
#undef MORSEL_FIELD_RADIAL_LANES_INL_H_
#else
#define MORSEL_FIELD_RADIAL_LANES_INL_H_
#endif

#include <algorithm>
#include <limits>

#include "hypertexture_geom/field/radial_move-inl.h"
#include "topology/lanes-inl.h"
#include "topology/model_batch.h"

HWY_BEFORE_NAMESPACE();
namespace morsel::geom::HWY_NAMESPACE {

using topology::HWY_NAMESPACE::LaneMask;
using topology::HWY_NAMESPACE::Lanes;

class RadialLanes {
 public:
  // The children `first` to first + Lanes::count() - 1 of a batch that has been started.
  HWY_INLINE RadialLanes(const topology::ModelBatch& batch, std::size_t first) : first_(first) {
    const Lanes zero(0.0);
    for (Lanes& c : c_) c = zero;
    quartic_ = sextic_ = value_error_ = hessian_error_ = zero;
    for (Lanes& f : form_) f = zero;
    for (int i = 0; i < 3; ++i) quintic_[i] = gradient_error_[i] = rounding_[i] = zero;
    for (int i = 0; i < 3; ++i) {
      centre_[i] = Lanes::load(batch.centre[i] + first);
      half_[i] = Lanes::load(batch.half[i] + first);
    }
  }
  const Lanes& centre(int i) const { return centre_[i]; }
  const Lanes& half(int i) const { return half_[i]; }

  // a0 + a1 e + a2 e^2 + a3 e^3 with e = s (2 d.u + |u|^2); the weight is in the coefficients.
  HWY_INLINE void add_cubic(const Lanes (&d)[3], Lanes s, Lanes a0, Lanes a1, Lanes a2, Lanes a3) {
    using namespace topology::monomial;
    const Lanes s2 = s + s;
    const Lanes g[3] = {s2 * d[0], s2 * d[1], s2 * d[2]};
    c_[k1] += a0;
    const Lanes a1s = a1 * s, two_a2 = a2 + a2;
    const Lanes ag[3] = {a2 * g[0], a2 * g[1], a2 * g[2]};
    for (int i = 0; i < 3; ++i) {
      c_[kX + i] += a1 * g[i];
      c_[kXX + i] += a1s + ag[i] * g[i];
    }
    c_[kXY] += two_a2 * g[0] * g[1];
    c_[kXZ] += two_a2 * g[0] * g[2];
    c_[kYZ] += two_a2 * g[1] * g[2];
    const Lanes b = two_a2 * s;
    const Lanes q[3] = {a3 * g[0], a3 * g[1], a3 * g[2]};
    const Lanes p[3] = {q[0] * g[0], q[1] * g[1], q[2] * g[2]};
    const Lanes three(3.0);
    const Lanes r[3] = {b + three * p[0], b + three * p[1], b + three * p[2]};
    c_[kXXX] += g[0] * (b + p[0]);
    c_[kYYY] += g[1] * (b + p[1]);
    c_[kZZZ] += g[2] * (b + p[2]);
    c_[kXXY] += g[1] * r[0];
    c_[kXXZ] += g[2] * r[0];
    c_[kXYY] += g[0] * r[1];
    c_[kYYZ] += g[2] * r[1];
    c_[kXZZ] += g[0] * r[2];
    c_[kYZZ] += g[1] * r[2];
    const Lanes xy = q[0] * g[1], xz = q[0] * g[2], yz = q[1] * g[2];
    c_[kXYZ] += Lanes(6.0) * xy * g[2];
    const Lanes s3 = three * s, ss = s * s;
    quartic_ += a2 * ss;
    form_[0] += s3 * p[0];
    form_[1] += s3 * p[1];
    form_[2] += s3 * p[2];
    form_[3] += s3 * xy;
    form_[4] += s3 * xz;
    form_[5] += s3 * yz;
    const Lanes quintic = three * ss;
    for (int i = 0; i < 3; ++i) quintic_[i] += quintic * q[i];
    sextic_ += a3 * ss * s;
  }

  // What is known on a box that contains those of the lanes.
  void add_polynomial(const RadialPolynomial& polynomial) {
    auto p = coefficients_of<Lanes>(polynomial);
    const Lanes d[3] = {centre_[0] - Lanes(polynomial.centre.x),
                        centre_[1] - Lanes(polynomial.centre.y),
                        centre_[2] - Lanes(polynomial.centre.z)};
    move_radial<Lanes>(p, d);
    for (int i = 0; i < topology::monomial::kCount; ++i) c_[i] += p.c[i];
    for (int i = 0; i < 6; ++i) form_[i] += p.form[i];
    for (int i = 0; i < 3; ++i) quintic_[i] += p.quintic[i];
    sextic_ += p.sextic;
    const auto error = [&](int k) {
      return Lanes(polynomial.error[k] + kMoved * polynomial.size[k]);
    };
    add_plain_error(error(0), error(1), error(2));
    add_sizes(Lanes(polynomial.size[0]), Lanes(polynomial.size[1]), Lanes(polynomial.size[2]));
  }

  // What the function of q is off by, with its derivatives: absolute values, the weight included.
  HWY_INLINE void add_error(const Lanes (&d)[3], Lanes s, Lanes e0, Lanes e1, Lanes e2) {
    const Lanes s2 = absolute(s + s);
    Lanes largest(0.0);
    for (int i = 0; i < 3; ++i) {
      const Lanes reach = s2 * (absolute(d[i]) + half_[i]);
      gradient_error_[i] += e1 * reach;
      largest = maximum(largest, reach);
    }
    value_error_ += e0;
    hessian_error_ += e2 * largest * largest + s2 * e1;
  }

  // The same of a function of x itself.
  HWY_INLINE void add_plain_error(Lanes value, Lanes gradient, Lanes hessian) {
    value_error_ += value;
    for (Lanes& e : gradient_error_) e += gradient;
    hessian_error_ += hessian;
  }

  // Sizes that rounding errors are relative to: of the value, of a first and a second derivative.
  HWY_INLINE void add_sizes(Lanes value, Lanes gradient, Lanes hessian) {
    rounding_[0] += value;
    rounding_[1] += gradient;
    rounding_[2] += hessian;
  }

  // Folds the terms of degree 4 to 6 into lower ones and their errors, adds what rounding amounts
  // to (`terms` were added), and writes the lanes to the batch.
  void finish(int terms, topology::ModelBatch& batch) {
    fold_quartic();
    fold_quintic_and_sextic();
    constexpr double kEpsilon = std::numeric_limits<double>::epsilon(), kUnderflow = 1e-290;
    const Lanes unit((128.0 + 2.0 * terms) * kEpsilon), tiny(kUnderflow);
    value_error_ += unit * (rounding_[0] + value_error_) + tiny;
    for (Lanes& e : gradient_error_) e += unit * (rounding_[1] + e) + tiny;
    hessian_error_ += unit * (rounding_[2] + hessian_error_) + tiny;
    for (int n = 0; n < topology::monomial::kCount; ++n) c_[n].store(batch.c[n] + first_);
    value_error_.store(batch.value_error + first_);
    for (int i = 0; i < 3; ++i) gradient_error_[i].store(batch.gradient_error[i] + first_);
    hessian_error_.store(batch.hessian_error + first_);
  }

  void add_to_constant(Lanes x) { c_[topology::monomial::k1] += x; }

 private:
  void fold_quartic() {
    using namespace topology::monomial;
    constexpr int kPair[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    const auto& h = half_;
    const Lanes diagonal[3] = {quartic_ + form_[0], quartic_ + form_[1], quartic_ + form_[2]};
    Lanes bend(0.0);
    for (int i = 0; i < 3; ++i) {
      const Lanes f = diagonal[i], a = absolute(f), h2 = h[i] * h[i];
      c_[kXX + i] += Lanes(1.5) * f * h2;
      c_[k1] -= Lanes(9.0 / 32.0) * f * h2 * h2;
      value_error_ += Lanes(9.0 / 32.0) * a * h2 * h2;
      gradient_error_[i] += a * h2 * h[i];
      bend += Lanes(9.0) * a * h2;
    }
    for (int n = 0; n < 3; ++n) {
      const int i = kPair[n][0], j = kPair[n][1], k = 3 - i - j;
      const Lanes hi = h[i], hj = h[j], hk2 = h[k] * h[k], i2 = hi * hi, j2 = hj * hj;
      {
        const Lanes f = diagonal[i] + diagonal[j], a = absolute(f);
        c_[kXX + i] += Lanes(0.5) * f * j2;
        c_[kXX + j] += Lanes(0.5) * f * i2;
        c_[k1] -= Lanes(0.25) * f * i2 * j2;
        value_error_ += Lanes(0.25) * a * i2 * j2;
        gradient_error_[i] += a * hi * j2;
        gradient_error_[j] += a * hj * i2;
        bend += a * maximum(maximum(i2, j2), Lanes(4.0) * hi * hj);
      }
      const Lanes f = Lanes(2.0) * form_[3 + n], a = absolute(f), half(0.5), quarter(0.25);
      const Lanes steep(2.25);
      c_[kXY + n] += f * (Lanes(0.75) * (i2 + j2) + half * hk2);
      value_error_ += a * hi * hj * (quarter * (i2 + j2) + half * hk2);
      gradient_error_[i] += a * hj * (steep * i2 + quarter * j2 + half * hk2);
      gradient_error_[j] += a * hi * (steep * j2 + quarter * i2 + half * hk2);
      gradient_error_[k] += a * Lanes(2.0) * h[k] * hi * hj;
      bend += a * maximum(maximum(Lanes(6.0) * hi * hj, steep * (i2 + j2) + half * hk2),
                          Lanes(2.0) * h[k] * maximum(hi, hj));
    }
    hessian_error_ += bend;
  }

  void fold_quintic_and_sextic() {
    using namespace topology::monomial;
    const auto& h = half_;
    constexpr double kRoot27 = 0.19245008972987526;  // 1 / sqrt(27)
    const Lanes p = h[0] * h[0] + h[1] * h[1] + h[2] * h[2], p2 = p * p, eighth(0.125);
    const auto& v = quintic_;
    const Lanes reach = absolute(v[0]) * h[0] + absolute(v[1]) * h[1] + absolute(v[2]) * h[2];
    for (int i = 0; i < 3; ++i) c_[kX + i] -= v[i] * p2 * eighth;
    const Lanes pv[3] = {p * v[0], p * v[1], p * v[2]};
    for (const int n : {kXXX, kXYY, kXZZ}) c_[n] += pv[0];
    for (const int n : {kXXY, kYYY, kYZZ}) c_[n] += pv[1];
    for (const int n : {kXXZ, kYYZ, kZZZ}) c_[n] += pv[2];
    const Lanes w = sextic_, a = absolute(w);
    for (int i = 0; i < 3; ++i) c_[kXX + i] += w * p2;
    c_[k1] -= w * Lanes(kRoot27) * p2 * p;
    value_error_ += reach * p2 * eighth + a * Lanes(kRoot27 * 1.000001) * p2 * p;
    Lanes slope(0.0);
    for (int i = 0; i < 3; ++i) {
      slope = maximum(slope, absolute(v[i]));
      gradient_error_[i] +=
          absolute(v[i]) * p2 * eighth + (reach * p + Lanes(2.0) * a * p2) * Lanes(2.0) * h[i];
    }
    const Lanes top = maximum(maximum(h[0], h[1]), h[2]);
    hessian_error_ += Lanes(4.0) * slope * top * p +
                      reach * (Lanes(8.0) * top * top + Lanes(2.0) * p) +
                      a * (Lanes(24.0) * p * top * top + Lanes(4.0) * p2);
  }

  std::size_t first_;
  Lanes centre_[3], half_[3];
  Lanes c_[topology::monomial::kCount];
  Lanes quartic_, form_[6], quintic_[3], sextic_;
  Lanes value_error_, gradient_error_[3], hessian_error_;
  Lanes rounding_[3];
};

}  // namespace morsel::geom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
