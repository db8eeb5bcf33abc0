// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/radial_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hypertexture_geom/field/model_algebra.h"

namespace morsel::geom {
namespace {

using namespace topology::monomial;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// Roundings behind one coefficient of one term, with a safety factor; the accumulation over terms
// is counted on top of it.
constexpr double kRoundings = 128.0;
constexpr double kUnderflow = 1e-290;

}  // namespace

RadialSum::RadialSum(const topology::Box& box) {
  model_.centre = topology::centre(box);
  // The exact half size may be a rounding above (max - min) / 2, and the centre a rounding off the
  // middle.
  for (int i = 0; i < 3; ++i) {
    const double c = model_.centre[i];
    const double reach = std::max(box.max[i] - c, c - box.min[i]);
    // Exact for the dyadic boxes of the topology stage: then no widening is needed.
    const bool exact =
        box.max[i] - c == c - box.min[i] && c + reach == box.max[i] && c - reach == box.min[i];
    model_.half[i] = exact ? reach : reach * (1.0 + 4.0 * kEpsilon);
  }
}

void RadialSum::add(const RadialTerm& t) {
  const double s = t.s, w = t.weight;
  const Imath::V3d& h = model_.half;
  // e = l + k, l = g.u linear, k = s |u|^2.
  const double g[3] = {2.0 * s * t.d.x, 2.0 * s * t.d.y, 2.0 * s * t.d.z};
  const double a0 = w * t.a[0], a1 = w * t.a[1], a2 = w * t.a[2], a3 = w * t.a[3];
  auto& c = model_.c;
  // Degree 0 to 3 of a0 + a1 e + a2 e^2 + a3 e^3.
  c[k1] += a0;
  c[kX] += a1 * g[0];
  c[kY] += a1 * g[1];
  c[kZ] += a1 * g[2];
  const double a1s = a1 * s;
  c[kXX] += a1s + a2 * g[0] * g[0];
  c[kYY] += a1s + a2 * g[1] * g[1];
  c[kZZ] += a1s + a2 * g[2] * g[2];
  c[kXY] += 2.0 * a2 * g[0] * g[1];
  c[kXZ] += 2.0 * a2 * g[0] * g[2];
  c[kYZ] += 2.0 * a2 * g[1] * g[2];
  const double b = 2.0 * a2 * s;
  const double p[3] = {a3 * g[0] * g[0], a3 * g[1] * g[1], a3 * g[2] * g[2]};
  c[kXXX] += g[0] * (b + p[0]);
  c[kYYY] += g[1] * (b + p[1]);
  c[kZZZ] += g[2] * (b + p[2]);
  c[kXXY] += g[1] * (b + 3.0 * p[0]);
  c[kXXZ] += g[2] * (b + 3.0 * p[0]);
  c[kXYY] += g[0] * (b + 3.0 * p[1]);
  c[kYYZ] += g[2] * (b + 3.0 * p[1]);
  c[kXZZ] += g[0] * (b + 3.0 * p[2]);
  c[kYZZ] += g[1] * (b + 3.0 * p[2]);
  c[kXYZ] += 6.0 * a3 * g[0] * g[1] * g[2];

  // a2 k^2 + 3 a3 (l^2 k + l k^2) + a3 k^3, of degree 4 to 6.
  quartic_ += a2 * s * s;
  const double q = 3.0 * a3 * s;
  quartic_form_[0] += q * g[0] * g[0];
  quartic_form_[1] += q * g[1] * g[1];
  quartic_form_[2] += q * g[2] * g[2];
  quartic_form_[3] += q * g[0] * g[1];
  quartic_form_[4] += q * g[0] * g[2];
  quartic_form_[5] += q * g[1] * g[2];
  for (int i = 0; i < 3; ++i) quintic_[i] += q * s * g[i];
  sextic_ += a3 * s * s * s;

  // phi's own error.
  const double as = std::abs(s), aw = std::abs(w);
  double reach[3];  // largest |dq/dx_i|
  for (int i = 0; i < 3; ++i) {
    reach[i] = std::abs(g[i]) + 2.0 * as * h[i];
    model_.gradient_error[i] += aw * t.error[1] * reach[i];
  }
  const double R = std::max({reach[0], reach[1], reach[2]});
  model_.value_error += aw * t.error[0];
  model_.hessian_error += aw * (t.error[2] * R * R + 2.0 * as * t.error[1]);

  // Rounding: each coefficient is off by a few roundings of the same expression with absolute
  // values, and that is at most the size of phi's derivatives times powers of q's.
  const double z = t.size;
  const double v0 = t.a_size[0] + z * (t.a_size[1] + z * (t.a_size[2] + z * t.a_size[3]));
  const double v1 = t.a_size[1] + 2.0 * z * (t.a_size[2] + 1.5 * z * t.a_size[3]);
  const double v2 = 2.0 * t.a_size[2] + 6.0 * z * t.a_size[3];
  rounding_[0] += aw * v0;
  rounding_[1] += aw * v1 * R;
  rounding_[2] += aw * (v2 * R * R + 2.0 * as * v1);
  ++terms_;
}

void RadialSum::add(const RadialPolynomial& polynomial) {
  if (polynomial.empty()) return;
  const RadialPolynomial p = moved(polynomial, model_.centre);
  for (std::size_t i = 0; i < kCount; ++i) model_.c[i] += p.c[i];
  for (int i = 0; i < 6; ++i) quartic_form_[i] += p.form[i];
  for (int i = 0; i < 3; ++i) quintic_[i] += p.quintic[i];
  sextic_ += p.sextic;
  model_.value_error += p.error[0];
  model_.gradient_error += Imath::V3d(p.error[1]);
  model_.hessian_error += p.error[2];
  for (int k = 0; k < 3; ++k) {
    rounding_[k] += p.size[k];
    inherited_[k] += p.size[k];
  }
  ++terms_;
}

namespace {

// RadialPolynomial::size on |u_i| <= h_i, from the coefficients as they are, so that what impulses
// of either sign cancel does not count.
void set_size(RadialPolynomial& p, const Imath::V3d& h) {
  constexpr int kPair[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};  // of form, and of kXX + ...
  constexpr int kTriple[3][6] = {{kXXX, kXYY, kXZZ, kXXY, kXXZ, kXYZ},
                                 {kXXY, kYYY, kYZZ, kXYY, kXYZ, kYYZ},
                                 {kXXZ, kYYZ, kZZZ, kXYZ, kXZZ, kYZZ}};
  const auto& c = p.c;
  const double r = h.length2(), top = std::max({h.x, h.y, h.z}), w = std::abs(p.sextic);
  double form = 0.0, widest = 0.0, largest = 0.0, reach = 0.0, slope = 0.0, th[3];
  for (int i = 0; i < 3; ++i) {
    th[i] = 0.0;
    for (int j = 0; j < 3; ++j) {
      const double f = std::abs(p.form[kPair[i][j]]);
      th[i] += f * h[j];
      largest = std::max(largest, f);
    }
    form += th[i] * h[i];
    widest = std::max(widest, th[i]);
    reach += std::abs(p.quintic[i]) * h[i];
    slope = std::max(slope, std::abs(p.quintic[i]));
  }
  double value = std::abs(c[k1]), gradient = 0.0, hessian = 0.0;
  for (int i = 0; i < 3; ++i) {
    double g = std::abs(c[kX + i]);
    for (int j = 0; j < 3; ++j) {
      // Every monomial is counted at least once for each of its factors.
      double second = 2.0 * std::abs(c[kXX + kPair[i][j]]);
      for (int k = 0; k < 3; ++k) second += 6.0 * std::abs(c[kTriple[i][kPair[j][k]]]) * h[k];
      hessian = std::max(hessian, second);
      g += second * h[j];
    }
    value += g * h[i];
    g += 2.0 * h[i] * form + 2.0 * r * th[i] + r * r * std::abs(p.quintic[i]) +
         (4.0 * reach + 6.0 * r * w) * r * h[i];
    gradient = std::max(gradient, g);
  }
  p.size[0] = kUnderflow + value + r * (form + r * (reach + r * w));
  p.size[1] = gradient;
  p.size[2] = hessian + 2.0 * form + 8.0 * top * widest + 2.0 * r * largest +
              8.0 * r * top * slope + reach * (8.0 * top * top + 4.0 * r) +
              w * (24.0 * r * top * top + 6.0 * r * r);
  for (double& size : p.size) size *= 1.0 + 1e-12;
}

}  // namespace

RadialPolynomial RadialSum::polynomial() const {
  RadialPolynomial p;
  p.centre = model_.centre;
  if (terms_ == 0) return p;
  for (std::size_t i = 0; i < kCount; ++i) p.c[i] = model_.c[i];
  for (int i = 0; i < 6; ++i) p.form[i] = quartic_form_[i] + (i < 3 ? quartic_ : 0.0);
  for (int i = 0; i < 3; ++i) p.quintic[i] = quintic_[i];
  p.sextic = sextic_;
  const Imath::V3d& g = model_.gradient_error;
  const double error[3] = {model_.value_error, std::max({g.x, g.y, g.z}), model_.hessian_error};
  for (int k = 0; k < 3; ++k) {
    const double own = rounding_[k] - inherited_[k];
    p.error[k] = error[k] +
                 kEpsilon * (kRoundings * own + (2.0 * terms_ + 8.0) * (rounding_[k] + error[k])) +
                 kUnderflow;
  }
  set_size(p, model_.half);
  return p;
}

void RadialSum::add_constant(double value, double value_error, const Imath::V3d& gradient_error,
                             double hessian_error) {
  model_.c[k1] += value;
  model_.value_error += value_error;
  model_.gradient_error += gradient_error;
  model_.hessian_error += hessian_error;
  rounding_[0] += std::abs(value) + value_error;
  ++terms_;
}

// On |u_i| <= h_i, with v in [-1, 1] for u_i / h_i:
//   v^4     ~ 3/2 v^2 - 9/32   value within 9/32, slope within 1, bend within 9 (T4 has the
//   smallest slope error) v^2 w^2 ~ (v^2 + w^2) / 2 - 1/4      within 1/4; slope 1; bends 1, 4
//   (mixed) v^3 w   ~ 3/4 v w                     within 1/4; slopes 9/4 (v), 1/4 (w); bends 6, 9/4
//   (mixed) v^2 w t ~ 1/2 w t                     within 1/2; slopes 2 (v), 1/2 (w, t); bends 2, 2
//   (mixed with v), 1/2
void RadialSum::fold_quartic() {
  const Imath::V3d& h = model_.half;
  auto& c = model_.c;
  constexpr int kSquare[3] = {kXX, kYY, kZZ};
  constexpr int kPair[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  constexpr int kMixed[3] = {kXY, kXZ, kYZ};
  const double diagonal[3] = {quartic_ + quartic_form_[0], quartic_ + quartic_form_[1],
                              quartic_ + quartic_form_[2]};
  double bend = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double f = diagonal[i], a = std::abs(f), h2 = h[i] * h[i];
    c[kSquare[i]] += 1.5 * f * h2;
    c[k1] -= 9.0 / 32.0 * f * h2 * h2;
    model_.value_error += 9.0 / 32.0 * a * h2 * h2;
    model_.gradient_error[i] += a * h2 * h[i];
    bend += 9.0 * a * h2;
  }
  for (int n = 0; n < 3; ++n) {
    const int i = kPair[n][0], j = kPair[n][1], k = 3 - i - j;
    const double hi = h[i], hj = h[j], hk2 = h[k] * h[k], i2 = hi * hi, j2 = hj * hj;
    {
      const double f = diagonal[i] + diagonal[j], a = std::abs(f);
      c[kSquare[i]] += 0.5 * f * j2;
      c[kSquare[j]] += 0.5 * f * i2;
      c[k1] -= 0.25 * f * i2 * j2;
      model_.value_error += 0.25 * a * i2 * j2;
      model_.gradient_error[i] += a * hi * j2;
      model_.gradient_error[j] += a * hj * i2;
      bend += a * std::max({i2, j2, 4.0 * hi * hj});
    }
    // x_i^3 x_j, x_i x_j^3 and x_k^2 x_i x_j all have the coefficient 2 T_ij.
    const double f = 2.0 * quartic_form_[3 + n], a = std::abs(f);
    c[kMixed[n]] += f * (0.75 * (i2 + j2) + 0.5 * hk2);
    model_.value_error += a * hi * hj * (0.25 * (i2 + j2) + 0.5 * hk2);
    model_.gradient_error[i] += a * hj * (2.25 * i2 + 0.25 * j2 + 0.5 * hk2);
    model_.gradient_error[j] += a * hi * (2.25 * j2 + 0.25 * i2 + 0.5 * hk2);
    model_.gradient_error[k] += a * 2.0 * h[k] * hi * hj;
    bend +=
        a * std::max({6.0 * hi * hj, 2.25 * (i2 + j2) + 0.5 * hk2, 2.0 * h[k] * std::max(hi, hj)});
  }
  model_.hessian_error += bend;
}

// With p = |u|^2 in [0, P]: p^2 ~ P p - P^2 / 8 (value within P^2 / 8, slope in p within P) and
// p^3 ~ P^2 p - P^3 / sqrt(27) (within P^3 / sqrt(27), slope within 2 P^2).
void RadialSum::fold_quintic_and_sextic() {
  const Imath::V3d& h = model_.half;
  auto& c = model_.c;
  constexpr double kRoot27 = 0.19245008972987526;  // 1 / sqrt(27)
  const double p = h.length2(), p2 = p * p;
  const double* v = quintic_;
  const double reach = std::abs(v[0]) * h.x + std::abs(v[1]) * h.y + std::abs(v[2]) * h.z;
  for (int i = 0; i < 3; ++i) c[kX + i] -= v[i] * p2 / 8.0;
  c[kXXX] += p * v[0];
  c[kXYY] += p * v[0];
  c[kXZZ] += p * v[0];
  c[kXXY] += p * v[1];
  c[kYYY] += p * v[1];
  c[kYZZ] += p * v[1];
  c[kXXZ] += p * v[2];
  c[kYYZ] += p * v[2];
  c[kZZZ] += p * v[2];
  const double w = sextic_, a = std::abs(w);
  c[kXX] += w * p2;
  c[kYY] += w * p2;
  c[kZZ] += w * p2;
  c[k1] -= w * kRoot27 * p2 * p;
  model_.value_error += reach * p2 / 8.0 + a * kRoot27 * 1.000001 * p2 * p;
  double slope = 0.0;
  for (int i = 0; i < 3; ++i) {
    slope = std::max(slope, std::abs(v[i]));
    model_.gradient_error[i] += std::abs(v[i]) * p2 / 8.0 + (reach * p + 2.0 * a * p2) * 2.0 * h[i];
  }
  const double top = std::max({h.x, h.y, h.z});
  model_.hessian_error += 4.0 * slope * top * p + reach * (8.0 * top * top + 2.0 * p) +
                          a * (24.0 * p * top * top + 4.0 * p2);
}

topology::LocalModel RadialSum::finish() {
  fold_quartic();
  fold_quintic_and_sextic();
  const double unit = (kRoundings + 2.0 * terms_) * kEpsilon;
  model_.value_error += unit * (rounding_[0] + model_.value_error) + kUnderflow;
  for (int i = 0; i < 3; ++i)
    model_.gradient_error[i] += unit * (rounding_[1] + model_.gradient_error[i]) + kUnderflow;
  model_.hessian_error += unit * (rounding_[2] + model_.hessian_error) + kUnderflow;
  forget_nans(model_);  // on huge boxes powers of their size overflow
  model_.add_rounding();
  return model_;
}

}  // namespace morsel::geom
