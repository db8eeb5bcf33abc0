// SPDX-License-Identifier: Apache-2.0
#include "topology/local_model.h"

#include <cmath>
#include <limits>

namespace morsel::topology {
namespace {

using namespace monomial;

// Index of the monomial u_i u_j and u_i u_j u_k.
constexpr int kSecond[3][3] = {{kXX, kXY, kXZ}, {kXY, kYY, kYZ}, {kXZ, kYZ, kZZ}};
constexpr int kThird[3][3][3] = {
    {{kXXX, kXXY, kXXZ}, {kXXY, kXYY, kXYZ}, {kXXZ, kXYZ, kXZZ}},
    {{kXXY, kXYY, kXYZ}, {kXYY, kYYY, kYYZ}, {kXYZ, kYYZ, kYZZ}},
    {{kXXZ, kXYZ, kXZZ}, {kXYZ, kYYZ, kYZZ}, {kXZZ, kYZZ, kZZZ}},
};

// Roundings that one value computed here goes through, times a safety factor of about two: no
// expression below has more than 30.
constexpr double kSlack = 64.0 * std::numeric_limits<double>::epsilon();
// Covers products that underflow, with flush-to-zero or without.
constexpr double kUnderflow = 1e-290;

// Adds the range of a*u + b*u^2 on [-h, h] to [lo, hi].
inline void add_parabola(double a, double b, double h, double& lo, double& hi) {
  const double bend = b * h * h, slope = std::abs(a) * h;
  double low = bend - slope, high = bend + slope;
  if (2.0 * std::abs(b) * h > std::abs(a)) {  // the vertex is inside
    const double vertex = -a * a / (4.0 * b);
    low = std::min(low, vertex);
    high = std::max(high, vertex);
  }
  lo += low;
  hi += high;
}

}  // namespace

void LocalModel::add_rounding() {
  const double h[3] = {half.x, half.y, half.z};
  double value = std::abs(c[k1]);
  double gradient[3];
  double hessian = 0.0;
  for (int i = 0; i < 3; ++i) {
    double g = std::abs(c[kX + i]);
    for (int j = 0; j < 3; ++j) {
      // Every mixed monomial is counted at least once for each of its factors: an upper bound.
      double s = 2.0 * std::abs(c[kSecond[i][j]]);
      for (int k = 0; k < 3; ++k) s += 6.0 * std::abs(c[kThird[i][j][k]]) * h[k];
      hessian = std::max(hessian, s);
      g += s * h[j];
    }
    gradient[i] = g;
    value += g * h[i];
  }
  value_error += kSlack * (value + value_error) + kUnderflow;
  for (int i = 0; i < 3; ++i)
    gradient_error[i] += kSlack * (gradient[i] + gradient_error[i]) + kUnderflow;
  hessian_error += kSlack * (hessian + hessian_error) + kUnderflow;
}

double LocalModel::value_at(const Imath::V3d& u) const {
  const double x = u.x, y = u.y, z = u.z;
  return c[k1] +
         x * (c[kX] + x * (c[kXX] + x * c[kXXX] + y * c[kXXY] + z * c[kXXZ]) +
              y * (c[kXY] + y * c[kXYY] + z * c[kXYZ]) + z * (c[kXZ] + z * c[kXZZ])) +
         y * (c[kY] + y * (c[kYY] + y * c[kYYY] + z * c[kYYZ]) + z * (c[kYZ] + z * c[kYZZ])) +
         z * (c[kZ] + z * (c[kZZ] + z * c[kZZZ]));
}

Imath::V3d LocalModel::gradient_at(const Imath::V3d& u) const {
  Imath::V3d g;
  for (int a = 0; a < 3; ++a) {
    double s = c[kX + a];
    for (int j = 0; j < 3; ++j) {
      s += (j == a ? 2.0 : 1.0) * c[kSecond[a][j]] * u[j];
      for (int k = j; k < 3; ++k)
        s += (1.0 + (a == j) + (a == k)) * c[kThird[a][j][k]] * u[j] * u[k];
    }
    g[a] = s;
  }
  return g;
}

Interval LocalModel::range() const {
  const double hx = half.x, hy = half.y, hz = half.z;
  double lo = c[k1] - value_error, hi = c[k1] + value_error;
  add_parabola(c[kX], c[kXX], hx, lo, hi);
  add_parabola(c[kY], c[kYY], hy, lo, hi);
  add_parabola(c[kZ], c[kZZ], hz, lo, hi);
  const double rest =
      hx * (hy * (std::abs(c[kXY]) + hx * std::abs(c[kXXY]) + hy * std::abs(c[kXYY]) +
                  hz * std::abs(c[kXYZ])) +
            hz * (std::abs(c[kXZ]) + hx * std::abs(c[kXXZ]) + hz * std::abs(c[kXZZ])) +
            hx * hx * std::abs(c[kXXX])) +
      hy * (hz * (std::abs(c[kYZ]) + hy * std::abs(c[kYYZ]) + hz * std::abs(c[kYZZ])) +
            hy * hy * std::abs(c[kYYY])) +
      hz * hz * hz * std::abs(c[kZZZ]);
  lo -= rest;
  hi += rest;
  if (std::isnan(lo) || std::isnan(hi)) return Interval::whole();
  return {lo, hi};
}

Interval LocalModel::gradient_range(int a) const {
  const double error = gradient_error[a];
  double lo = c[kX + a] - error, hi = c[kX + a] + error;
  for (int j = 0; j < 3; ++j) {
    const double linear = (j == a ? 2.0 : 1.0) * c[kSecond[a][j]];
    const double square = (j == a ? 3.0 : 1.0) * c[kThird[a][j][j]];
    add_parabola(linear, square, half[j], lo, hi);
    for (int k = j + 1; k < 3; ++k) {
      const double rest =
          (1.0 + (a == j) + (a == k)) * std::abs(c[kThird[a][j][k]]) * half[j] * half[k];
      lo -= rest;
      hi += rest;
    }
  }
  if (std::isnan(lo) || std::isnan(hi)) return Interval::whole();
  return {lo, hi};
}

Interval LocalModel::hessian_range(int i, int j) const {
  const double middle = (i == j ? 2.0 : 1.0) * c[kSecond[i][j]];
  double reach = hessian_error;
  for (int k = 0; k < 3; ++k) {
    const double factor = i == j ? (k == i ? 6.0 : 2.0) : (1.0 + (k == i)) * (1.0 + (k == j));
    reach += factor * std::abs(c[kThird[i][j][k]]) * half[k];
  }
  if (std::isnan(middle) || std::isnan(reach)) return Interval::whole();
  return {middle - reach, middle + reach};
}

LocalModel LocalModel::on_face(int a, int side) const {
  LocalModel face = *this;
  const double t = side * half[a];
  face.centre[a] += t;
  face.half[a] = 0.0;
  const double ca = c[kX + a], caa = c[kSecond[a][a]], caaa = c[kThird[a][a][a]];
  face.c[k1] = c[k1] + t * (ca + t * (caa + t * caaa));
  face.c[kX + a] = ca + t * (2.0 * caa + t * 3.0 * caaa);
  face.c[kSecond[a][a]] = caa + 3.0 * t * caaa;
  for (int j = 0; j < 3; ++j) {
    if (j == a) continue;
    face.c[kX + j] = c[kX + j] + t * (c[kSecond[a][j]] + t * c[kThird[a][a][j]]);
    face.c[kSecond[a][j]] = c[kSecond[a][j]] + 2.0 * t * c[kThird[a][a][j]];
    for (int k = j; k < 3; ++k)
      if (k != a) face.c[kSecond[j][k]] = c[kSecond[j][k]] + t * c[kThird[a][j][k]];
  }
  return face;
}

}  // namespace morsel::topology
