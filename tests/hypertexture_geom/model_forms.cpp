// SPDX-License-Identifier: Apache-2.0
#include "tests/hypertexture_geom/model_forms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hypertexture_geom/field/impulse_model.h"
#include "hypertexture_geom/field/truncated_cube.h"

namespace morsel::geom::testing {
namespace {

using topology::Interval;
using topology::LocalModel;

// Powers of x, y, z in the order of topology::monomial.
constexpr int kPower[topology::monomial::kCount][3] = {
    {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2},
    {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {2, 1, 0},
    {2, 0, 1}, {1, 2, 0}, {0, 2, 1}, {1, 0, 2}, {0, 1, 2}, {1, 1, 1}};

double power_of(double x, int n) {
  double p = 1.0;
  for (; n > 0; --n) p *= x;
  return p;
}

// A cubic p(t) = c0 + c1 t + c2 t^2 + c3 t^3 close to max(0, t - r)^4 on [0, 1]: its slope is
// Chebyshev's projection, its constant centres the error, as truncated_cube.cpp does for the third
// power. The errors are sampled, which is good enough for a comparison.
struct Fit {
  double c[4];
  double error[3];
};

Fit fit_fourth_power(double r) {
  const auto truncated = [r](double t, int n) { return t <= r ? 0.0 : power_of(t - r, n); };
  constexpr int kNodes = 256;
  double b[3] = {};
  for (int i = 0; i < kNodes; ++i) {
    const double angle = std::numbers::pi * (i + 0.5) / kNodes;
    const double f = 4.0 * truncated(0.5 + 0.5 * std::cos(angle), 3);
    for (int k = 0; k < 3; ++k) b[k] += (k == 0 ? 1.0 : 2.0) / kNodes * f * std::cos(k * angle);
  }
  Fit p{{0.0, b[0] - b[1] + b[2], b[1] - 4.0 * b[2], 8.0 * b[2] / 3.0}, {}};
  double lo = 0.0, hi = 0.0;
  for (int i = 0; i <= 1024; ++i) {
    const double t = i / 1024.0;
    const double value = t * (p.c[1] + t * (p.c[2] + t * p.c[3])) - truncated(t, 4);
    lo = std::min(lo, value);
    hi = std::max(hi, value);
    const double slope = p.c[1] + t * (2.0 * p.c[2] + t * 3.0 * p.c[3]) - 4.0 * truncated(t, 3);
    p.error[1] = std::max(p.error[1], std::abs(slope));
    const double bend = 2.0 * p.c[2] + 6.0 * p.c[3] * t - 12.0 * truncated(t, 2);
    p.error[2] = std::max(p.error[2], std::abs(bend));
  }
  p.c[0] = -0.5 * (lo + hi);
  p.error[0] = 0.5 * (hi - lo);
  return p;
}

constexpr int kTable = 128;

// max(0, q)^4 on [lo, hi] by a cubic about q0.
CubicPiece truncated_fourth_power(double q0, double lo, double hi) {
  if (hi <= 0.0) return {};
  CubicPiece piece{};
  const auto expand = [&](const double(&c)[4], double origin, double size) {
    const double t = (q0 - origin) / size, s1 = power_of(size, 3), s2 = size * size;
    piece.a[0] = s2 * s2 * (c[0] + t * (c[1] + t * (c[2] + t * c[3])));
    piece.a[1] = s1 * (c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]));
    piece.a[2] = s2 * (c[2] + t * 3.0 * c[3]);
    piece.a[3] = size * c[3];
  };
  if (lo >= 0.0) {
    // q = m + w t; t^4 is replaced by 3/2 t^2 - 9/32.
    const double m = 0.5 * (lo + hi), w = std::max(0.5 * (hi - lo), 1e-100), n = m / w;
    const double c[4] = {n * n * n * n - 9.0 / 32.0, 4.0 * n * n * n, 6.0 * n * n + 1.5, 4.0 * n};
    expand(c, m, w);
    piece.error[0] = 9.0 / 32.0 * w * w * w * w;
    piece.error[1] = w * w * w;
    piece.error[2] = 9.0 * w * w;
    return piece;
  }
  static const auto table = [] {
    std::array<Fit, kTable> t{};
    for (std::size_t i = 0; i < kTable; ++i)
      t[i] = fit_fourth_power((static_cast<double>(i) + 0.5) / kTable);
    return t;
  }();
  const double r = -lo / (hi - lo);
  const int i = std::min(kTable - 1, static_cast<int>(r * kTable));
  const double knot = (i + 0.5) / kTable;
  if (knot > r)
    lo = -hi * knot / (1.0 - knot);
  else
    hi = -lo * (1.0 - knot) / knot;
  const Fit& f = table[static_cast<std::size_t>(i)];
  const double size = hi - lo;
  expand(f.c, lo, size);
  piece.error[0] = power_of(size, 4) * f.error[0];
  piece.error[1] = power_of(size, 3) * f.error[1];
  piece.error[2] = size * size * f.error[2];
  return piece;
}

// The cube of q0 + e, or 0, instead of the truncated cube.
CubicPiece nearest_piece(double q0, double lo, double hi) {
  if (hi <= 0.0) return {};
  const double below = std::max(0.0, -lo);
  const CubicPiece cube{{q0 * q0 * q0, 3.0 * q0 * q0, 3.0 * q0, 1.0},
                        {below * below * below, 3.0 * below * below, 6.0 * below}};
  const CubicPiece none{{0.0, 0.0, 0.0, 0.0}, {hi * hi * hi, 3.0 * hi * hi, 6.0 * hi}};
  return below <= hi ? cube : none;
}

struct Span {
  double q0, lo, hi, reach;  // q at the centre, its range on the box, the largest |grad q|
};

Span span_of(const Impulse& p, const Imath::V3d& centre, const Imath::V3d& half) {
  const Imath::V3d d = centre - p.centre;
  double nearest = 0.0, farthest = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double a = std::abs(d[i]), low = std::max(0.0, a - half[i]), high = a + half[i];
    nearest += low * low;
    farthest += high * high;
  }
  return {1.0 - p.inverse_square * d.length2(), 1.0 - p.inverse_square * farthest,
          1.0 - p.inverse_square * nearest, 2.0 * p.inverse_square * std::sqrt(farthest)};
}

CubicPiece piece_of(const Span& s, int power, Border border, const Imath::V3d& half) {
  // As the library: in a box much wider than the kernel the plain range says more.
  if (s.reach * (half.x + half.y + half.z) > 4.0) {
    const double top = std::clamp(s.hi, 0.0, 1.0), bottom = std::clamp(s.lo, 0.0, 1.0);
    const double high = power_of(top, power), low = power_of(bottom, power);
    return {{0.5 * (high + low), 0.0, 0.0, 0.0},
            {0.5 * (high - low), power * power_of(top, power - 1),
             power * (power - 1) * power_of(top, power - 2)}};
  }
  if (power == 4) return truncated_fourth_power(s.q0, s.lo, s.hi);
  return border == Border::kFit ? truncated_cube(s.q0, s.lo, s.hi)
                                : nearest_piece(s.q0, s.lo, s.hi);
}

}  // namespace

Sextic::Sextic(const Imath::V3d& centre, const Imath::V3d& half)
    : centre_(centre), half_(half), c_(kSide * kSide * kSide, 0.0) {}

void Sextic::add(const LocalModel& m) {
  for (std::size_t n = 0; n < topology::monomial::kCount; ++n)
    c_[at(kPower[n][0], kPower[n][1], kPower[n][2])] += m.c[n];
  value_error_ += m.value_error;
  slope_error_ += m.gradient_error;
}

void Sextic::add(const Impulse& p, Border border) {
  const Span span = span_of(p, centre_, half_);
  const CubicPiece piece = piece_of(span, 3, border, half_);
  const double s = -p.inverse_square;
  const Imath::V3d g = (centre_ - p.centre) * (2.0 * s);
  // e = g.u + s |u|^2 as six monomials.
  struct Monomial {
    int power[3];
    double c;
  };
  Monomial e[6];
  for (int i = 0; i < 3; ++i) {
    e[i] = {{i == 0, i == 1, i == 2}, g[i]};
    e[3 + i] = {{2 * (i == 0), 2 * (i == 1), 2 * (i == 2)}, s};
  }
  c_[0] += p.weight * piece.a[0];
  for (const Monomial& a : e) {
    c_[at(a.power[0], a.power[1], a.power[2])] += p.weight * piece.a[1] * a.c;
    for (const Monomial& b : e) {
      const int i = a.power[0] + b.power[0], j = a.power[1] + b.power[1],
                k = a.power[2] + b.power[2];
      const double ab = a.c * b.c;
      c_[at(i, j, k)] += p.weight * piece.a[2] * ab;
      for (const Monomial& d : e)
        c_[at(i + d.power[0], j + d.power[1], k + d.power[2])] += p.weight * piece.a[3] * ab * d.c;
    }
  }
  value_error_ += std::abs(p.weight) * piece.error[0];
  for (int i = 0; i < 3; ++i)
    slope_error_[i] +=
        std::abs(p.weight) * piece.error[1] * (std::abs(g[i]) + 2.0 * std::abs(s) * half_[i]);
}

LocalModel Sextic::truncated() const {
  LocalModel m;
  m.centre = centre_;
  m.half = half_;
  for (std::size_t n = 0; n < topology::monomial::kCount; ++n)
    m.c[n] = c_[at(kPower[n][0], kPower[n][1], kPower[n][2])];
  m.value_error = value_error_;
  m.gradient_error = slope_error_;
  for (int i = 0; i <= kDegree; ++i)
    for (int j = 0; i + j <= kDegree; ++j)
      for (int k = std::max(0, 4 - i - j); i + j + k <= kDegree; ++k) {
        const double c = std::abs(c_[at(i, j, k)]);
        if (c == 0.0) continue;
        const int n[3] = {i, j, k};
        double powers[3], size = c;
        for (int a = 0; a < 3; ++a) {
          powers[a] = power_of(half_[a], n[a]);
          size *= powers[a];
        }
        m.value_error += size;
        for (int a = 0; a < 3; ++a)
          if (n[a] > 0) m.gradient_error[a] += n[a] * size / half_[a];
      }
  return m;
}

// Axis after axis: b_i = sum_{j <= i} C(i, j) / C(6, j) a_j for powers of t in [0, 1], after u has
// been replaced by half (2 t - 1).
Interval Sextic::bernstein_range(const Coefficients& c, double error) const {
  static const auto matrix = [] {
    std::array<std::array<double, kSide>, kSide> m{};
    const auto binomial = [](int n, int k) {
      double b = 1.0;
      for (int i = 1; i <= k; ++i) b = b * (n - k + i) / i;
      return b;
    };
    for (std::size_t i = 0; i < kSide; ++i)
      for (std::size_t power = 0; power < kSide; ++power)
        for (int j = 0; j <= static_cast<int>(std::min(i, power)); ++j) {
          // (2 t - 1)^power = sum_j C(power, j) 2^j t^j (-1)^(power - j)
          const int p = static_cast<int>(power);
          const double sign = (p - j) % 2 == 0 ? 1.0 : -1.0;
          m[i][power] += binomial(static_cast<int>(i), j) / binomial(kDegree, j) * sign *
                         binomial(p, j) * power_of(2.0, j);
        }
    return m;
  }();
  Coefficients from = c, to(from.size());
  for (int axis = 0; axis < 3; ++axis) {
    // The axis that is done goes last, so that after three the order is the first one again.
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j) {
        double a[kSide], h = 1.0;
        for (int k = 0; k < kSide; ++k, h *= half_[axis]) a[k] = from[at(k, i, j)] * h;
        for (std::size_t n = 0; n < kSide; ++n) {
          double sum = 0.0;
          for (std::size_t k = 0; k < kSide; ++k) sum += matrix[n][k] * a[k];
          to[at(i, j, static_cast<int>(n))] = sum;
        }
      }
    std::swap(from, to);
  }
  const auto [lo, hi] = std::minmax_element(from.begin(), from.end());
  return {*lo - error, *hi + error};
}

Bounds Sextic::bernstein() const {
  Bounds b;
  b.value = bernstein_range(c_, value_error_);
  for (int a = 0; a < 3; ++a) {
    Coefficients d(c_.size(), 0.0);
    for (int i = 0; i <= kDegree; ++i)
      for (int j = 0; i + j <= kDegree; ++j)
        for (int k = 0; i + j + k <= kDegree; ++k) {
          const int n[3] = {i, j, k};
          if (n[a] > 0) d[at(i - (a == 0), j - (a == 1), k - (a == 2))] = n[a] * c_[at(i, j, k)];
        }
    b.slope[a] = bernstein_range(d, slope_error_[a]);
  }
  return b;
}

LocalModel radial_model(const ImpulseList& impulses, const topology::Box& box, int power,
                        Border border) {
  RadialSum sum(box);
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    const Impulse p = impulses[n];
    if (!reaches(p, sum.centre(), sum.half())) continue;
    const Span span = span_of(p, sum.centre(), sum.half());
    const CubicPiece piece = piece_of(span, power, border, sum.half());
    RadialTerm t;
    t.d = sum.centre() - p.centre;
    t.s = -p.inverse_square;
    t.weight = p.weight;
    std::copy(piece.a, piece.a + 4, t.a);
    std::copy(piece.error, piece.error + 3, t.error);
    sum.add(t);
  }
  return sum.finish();
}

void add_impulse(const Impulse& p, int power, const Imath::V3d& x, double& value,
                 Imath::V3d& gradient) {
  const Imath::V3d d = x - p.centre;
  const double q = 1.0 - p.inverse_square * d.length2();
  if (q <= 0.0) return;
  value += p.weight * power_of(q, power);
  gradient -= d * (2.0 * power * p.weight * p.inverse_square * power_of(q, power - 1));
}

Bounds as_built(const LocalModel& m) {
  return {m.range(), {m.gradient_range(0), m.gradient_range(1), m.gradient_range(2)}};
}

Bounds by_monomials(const LocalModel& m) {
  Bounds b;
  b.value = m.plain_range();
  for (int a = 0; a < 3; ++a) {
    double middle = 0.0, reach = m.gradient_error[a];
    for (std::size_t n = 0; n < topology::monomial::kCount; ++n) {
      if (kPower[n][a] == 0) continue;
      double size = std::abs(m.c[n]) * kPower[n][a];
      bool constant = true;
      for (int i = 0; i < 3; ++i) {
        const int p = kPower[n][i] - (i == a);
        constant = constant && p == 0;
        size *= power_of(m.half[i], p);
      }
      if (constant)
        middle = m.c[n];
      else
        reach += size;
    }
    b.slope[a] = {middle - reach, middle + reach};
  }
  return b;
}

Bounds by_bernstein(const LocalModel& m) {
  Sextic s(m.centre, m.half);
  s.add(m);
  Bounds b = s.bernstein();
  b.value = m.bernstein_range();
  return b;
}

}  // namespace morsel::geom::testing
