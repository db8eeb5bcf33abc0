// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/local_series.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morsel::geom {
namespace {

using topology::LocalModel;
using namespace topology::monomial;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Covers whatever underflows in one operation, flushed to zero or not: products here are of a few
// factors not below 2^-100 (the scale) and of coefficients.
constexpr double kUnderflow = 1e-200;

constexpr int kTerms = LocalSeries::kCount;

// Exponents of x, y, z.
constexpr int kExponent[kTerms][3] = {
    {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2},
    {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {2, 1, 0},
    {2, 0, 1}, {1, 2, 0}, {0, 2, 1}, {1, 0, 2}, {0, 1, 2}, {1, 1, 1}, {4, 0, 0},
    {0, 4, 0}, {0, 0, 4}, {3, 1, 0}, {3, 0, 1}, {1, 3, 0}, {0, 3, 1}, {1, 0, 3},
    {0, 1, 3}, {2, 2, 0}, {2, 0, 2}, {0, 2, 2}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}};
constexpr int kFirst[6] = {0, 1, 4, 10, 20, 35};  // first monomial of each degree

constexpr int index_of(int x, int y, int z) {
  for (int i = 0; i < kTerms; ++i)
    if (kExponent[i][0] == x && kExponent[i][1] == y && kExponent[i][2] == z) return i;
  return -1;
}

// Every pair of monomials whose product has degree 4 at most, and the product: 210 of them.
struct Pair {
  unsigned char left, right, product;
};
constexpr int kPairs = 210;
constexpr std::array<Pair, kPairs> make_pairs() {
  std::array<Pair, kPairs> pairs{};
  int n = 0;
  for (int i = 0; i < kTerms; ++i)
    for (int j = 0; j < kTerms; ++j) {
      const int x = kExponent[i][0] + kExponent[j][0], y = kExponent[i][1] + kExponent[j][1],
                z = kExponent[i][2] + kExponent[j][2];
      if (x + y + z <= 4)
        pairs[n++] = {static_cast<unsigned char>(i), static_cast<unsigned char>(j),
                      static_cast<unsigned char>(index_of(x, y, z))};
    }
  return pairs;
}
constexpr std::array<Pair, kPairs> kProducts = make_pairs();

constexpr int kSecond[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

// The monomial's value, first and second derivatives at v = (1, 1, 1).
struct Weights {
  double w[kTerms][10];
};
constexpr Weights make_weights() {
  Weights r{};
  for (int n = 0; n < kTerms; ++n) {
    const auto& e = kExponent[n];
    r.w[n][0] = 1.0;
    for (int i = 0; i < 3; ++i) r.w[n][1 + i] = e[i];
    for (int k = 0; k < 6; ++k) {
      const int i = kSecond[k][0], j = kSecond[k][1];
      r.w[n][4 + k] = i == j ? e[i] * (e[i] - 1) : e[i] * e[j];
    }
  }
  return r;
}
constexpr Weights kWeights = make_weights();

double or_infinity(double x) { return x >= 0.0 ? x : kInfinity; }  // NaN too

double power(const Imath::V3d& scale, const int (&e)[3]) {
  double p = 1.0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < e[i]; ++k) p *= scale[i];
  return p;
}

}  // namespace

JetBound& JetBound::operator+=(const JetBound& other) {
  for (std::size_t i = 0; i < b.size(); ++i) b[i] += other.b[i];
  return *this;
}

JetBound& JetBound::operator*=(double factor) {
  for (double& x : b) x *= factor;
  return *this;
}

JetBound operator*(const JetBound& f, const JetBound& g) {
  JetBound r;
  r.b[0] = f.b[0] * g.b[0];
  for (int i = 1; i < 4; ++i) r.b[i] = f.b[0] * g.b[i] + f.b[i] * g.b[0];
  for (int k = 0; k < 6; ++k) {
    const int i = 1 + kSecond[k][0], j = 1 + kSecond[k][1];
    r.b[4 + k] = f.b[0] * g.b[4 + k] + f.b[i] * g.b[j] + f.b[j] * g.b[i] + f.b[4 + k] * g.b[0];
  }
  return r;
}

LocalSeries::LocalSeries(const LocalModel& model)
    : LocalSeries(model.centre, model.half, Imath::V3d(0.0)) {
  const double widest = std::max({half_.x, half_.y, half_.z});
  for (int i = 0; i < 3; ++i) scale_[i] = std::max({half_[i], widest * 0x1p-60, 0x1p-100});
  for (int n = 0; n < topology::monomial::kCount; ++n)
    c_[n] = model.c[n] * power(scale_, kExponent[n]);
  round(8.0, size(0, 3));
  double h[6];
  std::fill(h, h + 6, model.hessian_error);
  add_remainder(model.value_error, model.gradient_error, h);
}

JetBound LocalSeries::size(int from, int to) const {
  JetBound r;
  for (int n = kFirst[from]; n < kFirst[to + 1]; ++n) {
    const double a = std::abs(c_[n]);
    for (int k = 0; k < 10; ++k) r.b[k] += a * kWeights.w[n][k];
  }
  return r;
}

void LocalSeries::round(double roundings, const JetBound& size) {
  for (int k = 0; k < 10; ++k) rest_.b[k] += roundings * kEpsilon * size.b[k] + kUnderflow;
}

void LocalSeries::add_remainder(double value, const Imath::V3d& gradient,
                                const double (&hessian)[6]) {
  rest_.b[0] += value;
  for (int i = 0; i < 3; ++i) rest_.b[1 + i] += gradient[i] * scale_[i];
  for (int k = 0; k < 6; ++k)
    rest_.b[4 + k] += hessian[k] * scale_[kSecond[k][0]] * scale_[kSecond[k][1]];
}

LocalSeries& LocalSeries::operator+=(const LocalSeries& other) {
  for (int n = 0; n < kTerms; ++n) c_[n] += other.c_[n];
  rest_ += other.rest_;
  round(2.0, size(0, 4));
  return *this;
}

LocalSeries& LocalSeries::operator+=(double constant) {
  c_[0] += constant;
  rest_.b[0] += kEpsilon * std::abs(c_[0]) + kUnderflow;
  return *this;
}

LocalSeries& LocalSeries::operator*=(double factor) {
  for (double& c : c_) c *= factor;
  rest_ *= std::abs(factor);
  round(2.0, size(0, 4));
  return *this;
}

LocalSeries operator*(const LocalSeries& f, const LocalSeries& g) {
  LocalSeries r(f.centre_, f.half_, f.scale_);
  for (const Pair& p : kProducts) r.c_[p.product] += f.c_[p.left] * g.c_[p.right];
  JetBound of_f[5], in_f, in_g;  // of one degree's terms, of the polynomials
  JetBound g_from[6];            // of g's terms of this degree and above
  for (int degree = 4; degree >= 0; --degree) {
    of_f[degree] = f.size(degree, degree);
    in_f += of_f[degree];
    g_from[degree] = g_from[degree + 1];
    g_from[degree] += g.size(degree, degree);
  }
  in_g = g_from[0];
  // Products of degree 5 and more.
  for (int degree = 1; degree <= 4; ++degree) r.rest_ += of_f[degree] * g_from[5 - degree];
  // A coefficient is a sum of up to 35 products.
  r.round(64.0, in_f * in_g);
  in_f += f.rest_;
  r.rest_ += in_f * g.rest_;
  r.rest_ += f.rest_ * in_g;
  return r;
}

// Terms of degree 4 are replaced by lower ones, on [-1, 1]^3:
//   v^4     ~ 3/2 v^2 - 9/32          value within 9/32, slope 1, second derivative 9
//   v^2 w^2 ~ (v^2 + w^2) / 2 - 1/4   within 1/4; 1; 1, mixed 4
//   v^3 w   ~ 3/4 v w                 within 1/4; 9/4 (v), 1/4 (w); 6 (vv), 9/4 (mixed)
//   v^2 w t ~ 1/2 w t                 within 1/2; 2 (v), 1/2; 2 (vv and mixed with v), 1/2 (wt)
LocalModel LocalSeries::finish() const {
  LocalSeries r = *this;
  for (int n = kFirst[4]; n < kTerms; ++n) {
    const auto& e = kExponent[n];
    const double f = r.c_[n], a = std::abs(f);
    // Axes by descending exponent.
    int i = 0, j = 1, k = 2;
    if (e[i] < e[j]) std::swap(i, j);
    if (e[j] < e[k]) std::swap(j, k);
    if (e[i] < e[j]) std::swap(i, j);
    const auto mixed = [](int p, int q) { return kXX + 2 + p + q; };  // kXY, kXZ, kYZ: 7, 8, 9
    auto& b = r.rest_.b;
    const auto add = [&](int at, double bound) { b[at] += bound * a; };
    if (e[i] == 4) {
      r.c_[kXX + i] += 1.5 * f;
      r.c_[k1] -= 9.0 / 32.0 * f;
      add(0, 9.0 / 32.0);
      add(1 + i, 1.0);
      add(4 + i, 9.0);
    } else if (e[i] == 3) {
      r.c_[mixed(i, j)] += 0.75 * f;
      add(0, 0.25);
      add(1 + i, 2.25);
      add(1 + j, 0.25);
      add(4 + i, 6.0);
      add(mixed(i, j), 2.25);
    } else if (e[j] == 2) {
      r.c_[kXX + i] += 0.5 * f;
      r.c_[kXX + j] += 0.5 * f;
      r.c_[k1] -= 0.25 * f;
      add(0, 0.25);
      add(1 + i, 1.0);
      add(1 + j, 1.0);
      add(4 + i, 1.0);
      add(4 + j, 1.0);
      add(mixed(i, j), 4.0);
    } else {
      r.c_[mixed(j, k)] += 0.5 * f;
      add(0, 0.5);
      add(1 + i, 2.0);
      add(1 + j, 0.5);
      add(1 + k, 0.5);
      add(4 + i, 2.0);
      add(mixed(i, j), 2.0);
      add(mixed(i, k), 2.0);
      add(mixed(j, k), 0.5);
    }
    r.c_[n] = 0.0;
    r.rest_.b[0] += kUnderflow;
  }
  // Up to 12 additions to one coefficient, and the way back to u.
  JetBound all = r.size(0, 3);
  all += size(4, 4);
  r.round(40.0, all);

  LocalModel m;
  m.centre = centre_;
  m.half = half_;
  bool finite = true;
  for (int n = 0; n < topology::monomial::kCount; ++n) {
    m.c[n] = r.c_[n] / power(scale_, kExponent[n]);
    finite = finite && std::isfinite(m.c[n]);
  }
  if (!finite) {
    m.c = {};
    m.value_error = m.hessian_error = kInfinity;
    m.gradient_error = Imath::V3d(kInfinity);
    return m;
  }
  constexpr double kUp = 1.0 + 1e-12;  // the bounds' own rounding
  m.value_error = or_infinity(r.rest_.b[0] * kUp);
  for (int i = 0; i < 3; ++i) m.gradient_error[i] = or_infinity(r.rest_.b[1 + i] * kUp / scale_[i]);
  for (int k = 0; k < 6; ++k)
    m.hessian_error = std::max(
        m.hessian_error,
        or_infinity(r.rest_.b[4 + k] * kUp / scale_[kSecond[k][0]] / scale_[kSecond[k][1]]));
  m.add_rounding();
  return m;
}

}  // namespace morsel::geom
