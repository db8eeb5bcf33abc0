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
// expression below has more than 40 in a row.
constexpr double kSlack = 96.0 * std::numeric_limits<double>::epsilon();
// Covers products that underflow, with flush-to-zero or without.
constexpr double kUnderflow = 1e-290;

// Adds the range of a*u + b*u^2 on [-h, h] to [lo, hi].
inline void add_parabola(double a, double b, double h, double& lo, double& hi) {
  const double bend = b * h * h, slope = std::abs(a) * h;
  double low = bend - slope, high = bend + slope;
  if (2.0 * std::abs(b) * h > std::abs(a)) {  // the vertex is inside
    // Not a * a / (4 b): the square of a small slope underflows where its share does not.
    const double vertex = -a * (a / (4.0 * b));
    low = std::min(low, vertex);
    high = std::max(high, vertex);
  }
  lo += low;
  hi += high;
}

// Bernstein coefficients on [-1, 1] of a[0] + a[1] v + a[2] v^2 + a[3] v^3.
struct Bernstein {
  double b[4];
};
inline Bernstein bernstein(double a0, double a1, double a2, double a3) {
  constexpr double kThirdPart = 1.0 / 3.0;
  const double even = a0 + a2, odd = a1 + a3;
  const double even_inner = a0 - kThirdPart * a2, odd_inner = kThirdPart * a1 - a3;
  return {{even - odd, even_inner - odd_inner, even_inner + odd_inner, even + odd}};
}

// Index of x^i y^j z^k, i + j + k <= 3; -1 beyond.
constexpr int kPower[4][4][4] = {
    {{k1, kZ, kZZ, kZZZ}, {kY, kYZ, kYZZ, -1}, {kYY, kYYZ, -1, -1}, {kYYY, -1, -1, -1}},
    {{kX, kXZ, kXZZ, -1}, {kXY, kXYZ, -1, -1}, {kXYY, -1, -1, -1}, {-1, -1, -1, -1}},
    {{kXX, kXXZ, -1, -1}, {kXXY, -1, -1, -1}, {-1, -1, -1, -1}, {-1, -1, -1, -1}},
    {{kXXX, -1, -1, -1}, {-1, -1, -1, -1}, {-1, -1, -1, -1}, {-1, -1, -1, -1}},
};

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

Interval LocalModel::plain_range() const {
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

Interval LocalModel::bernstein_range() const {
  // The polynomial lies in the convex hull of its tensor Bernstein coefficients, which are found
  // axis by axis.
  const double hx = half.x, hy = half.y, hz = half.z;
  double after_x[4][4][4];  // [x coefficient][power of y][power of z]
  for (int j = 0; j < 4; ++j) {
    for (int k = 0; j + k < 4; ++k) {
      double a[4] = {};
      double scale = (j > 0 ? hy : 1.0) * (j > 1 ? hy : 1.0) * (j > 2 ? hy : 1.0) *
                     (k > 0 ? hz : 1.0) * (k > 1 ? hz : 1.0) * (k > 2 ? hz : 1.0);
      for (int i = 0; i + j + k < 4; ++i, scale *= hx) a[i] = c[kPower[i][j][k]] * scale;
      const Bernstein b = bernstein(a[0], a[1], a[2], a[3]);
      for (int i = 0; i < 4; ++i) after_x[i][j][k] = b.b[i];
    }
  }
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (int i = 0; i < 4; ++i) {
    double after_y[4][4];  // [y coefficient][power of z]
    for (int k = 0; k < 4; ++k) {
      const Bernstein b = bernstein(after_x[i][0][k], k < 3 ? after_x[i][1][k] : 0.0,
                                    k < 2 ? after_x[i][2][k] : 0.0, k < 1 ? after_x[i][3][k] : 0.0);
      for (int j = 0; j < 4; ++j) after_y[j][k] = b.b[j];
    }
    for (int j = 0; j < 4; ++j) {
      const Bernstein b = bernstein(after_y[j][0], after_y[j][1], after_y[j][2], after_y[j][3]);
      for (const double value : b.b) {
        if (std::isnan(value)) return Interval::whole();
        lo = std::min(lo, value);
        hi = std::max(hi, value);
      }
    }
  }
  return {lo - value_error, hi + value_error};
}

Interval LocalModel::range() const {
  const Interval plain = plain_range();
  if (!(plain.lo < 0.0 && plain.hi >= 0.0)) return plain;
  // Along an axis where F is monotone its extremes lie on the two faces.
  LocalModel low = *this, high = *this;
  bool monotone = false;
  for (int axis = 0; axis < 3; ++axis) {
    if (half[axis] == 0.0) continue;
    const Interval slope = gradient_range(axis);
    if (slope.lo < 0.0 && slope.hi > 0.0) continue;
    monotone = true;
    const int side = slope.lo >= 0.0 ? 1 : -1;
    low = low.on_face(axis, -side);
    high = high.on_face(axis, side);
  }
  if (!monotone) {
    const Interval tight = low.bernstein_range();
    return {std::max(plain.lo, tight.lo), std::min(plain.hi, tight.hi)};
  }
  return {std::max(plain.lo, low.bernstein_range().lo),
          std::min(plain.hi, high.bernstein_range().hi)};
}

Interval LocalModel::gradient_range(int a) const {
  // dP/dx_a = constant + linear.u + sum of square[j] u_j^2 and cross[j] u_j' u_j'' (the other two
  // axes).
  const double constant = c[kX + a];
  double linear[3], square[3], cross[3];
  for (int j = 0; j < 3; ++j) {
    linear[j] = (j == a ? 2.0 : 1.0) * c[kSecond[a][j]];
    square[j] = (j == a ? 3.0 : 1.0) * c[kThird[a][j][j]];
    const int k = (j + 1) % 3, l = (j + 2) % 3;
    cross[j] = (1.0 + (a == k) + (a == l)) * c[kThird[a][k][l]];
  }
  const double error = gradient_error[a];
  Interval result;
  for (const int side : {-1, 1}) {  // the lower end, then the upper
    double f = constant, g[3] = {linear[0], linear[1], linear[2]};
    double x[3] = {cross[0], cross[1], cross[2]};
    bool fixed[3] = {};
    for (int j = 0; j < 3; ++j) {
      // Along an axis where this derivative is monotone its extreme lies at an end.
      const int k = (j + 1) % 3, l = (j + 2) % 3;
      const double reach = 2.0 * std::abs(square[j]) * half[j] +
                           std::abs(x[l]) * (fixed[k] ? 0.0 : half[k]) +
                           std::abs(x[k]) * (fixed[l] ? 0.0 : half[l]);
      if (std::abs(g[j]) < reach) continue;
      const double t = (g[j] >= 0.0 ? side : -side) * half[j];
      f += t * (g[j] + t * square[j]);
      if (!fixed[k]) g[k] += t * x[l];
      if (!fixed[l]) g[l] += t * x[k];
      x[k] = x[l] = 0.0;
      fixed[j] = true;
    }
    double lo = f, hi = f;
    for (int j = 0; j < 3; ++j) {
      if (!fixed[j]) add_parabola(g[j], square[j], half[j], lo, hi);
      const double rest = std::abs(x[j]) * half[(j + 1) % 3] * half[(j + 2) % 3];
      lo -= rest;
      hi += rest;
    }
    if (side < 0)
      result.lo = lo - error;
    else
      result.hi = hi + error;
  }
  if (std::isnan(result.lo) || std::isnan(result.hi)) return Interval::whole();
  return result;
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
