// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/perlin_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hypertexture_geom/field/model_algebra.h"
#include "hypertexture_geom/field/perlin_lattice.h"
#include "hypertexture_geom/field/truncated_cube.h"

namespace morsel::geom {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr int kTerms = Polynomial6::kTerms;

// Half width in lattice cells up to which an octave is expanded. Wider boxes than a cell would meet
// two lattice planes of an axis; well before that the bound over all of space is as good.
constexpr double kWidest = 0.26;

// Roundings behind a coefficient of the final polynomial: below 30 for each of three functions of
// one variable, 33 in products and sums over lattice points and octaves, 30 in dropping terms and
// scaling; times a safety factor.
constexpr double kRoundings = 256.0;

// Boxes that reach less than this part of their width across a lattice plane don't count as
// straddling it (a face on the plane must not, but is computed with rounding).
constexpr double kHair = 1e-14;

// Smallest half width used, in cells of the finest octave: powers of it stay clear of underflow.
constexpr double kSmallest = 0x1p-40;

using Coefficients = double[Polynomial6::kStride];

// p * (t + shift).
Polynomial6 times_linear(const Polynomial6& p, double shift) {
  Polynomial6 r;
  r.c[0] = p.c[0] * shift;
  for (int m = 1; m < kTerms; ++m) r.c[m] = p.c[m] * shift + p.c[m - 1];
  return r;
}

Polynomial6 product(const Polynomial6& a, const Polynomial6& b) {
  Polynomial6 r;
  for (int i = 0; i < kTerms; ++i)
    for (int j = 0; i + j < kTerms; ++j) r.c[i + j] += a.c[i] * b.c[j];
  return r;
}

Polynomial6 negative_sum(const Polynomial6& a, const Polynomial6& b) {
  Polynomial6 r;
  for (int m = 0; m < kTerms; ++m) r.c[m] = -(a.c[m] + b.c[m]);
  return r;
}

// y = scale v.
void rescale(Polynomial6& p, double scale) {
  double power = 1.0;
  for (double& c : p.c) {
    c *= power;
    power *= scale;
  }
}

// Sum of absolute terms for |y| <= b, of p and its derivatives with respect to y.
void add_norms(const Polynomial6& p, double b, DerivativeBounds1& norms) {
  double power = 1.0, below = 0.0, below2 = 0.0;  // b^m, b^(m-1), b^(m-2)
  for (int m = 0; m < kTerms; ++m) {
    const double a = std::abs(p.c[m]);
    norms.d[0] += a * power;
    norms.d[1] += a * m * below;
    norms.d[2] += a * m * (m - 1) * below2;
    below2 = below;
    below = power;
    power *= b;
  }
}

// Bounds on the product of two functions with these bounds.
DerivativeBounds1 product(const DerivativeBounds1& a, const DerivativeBounds1& b) {
  return {{a.d[0] * b.d[0], a.d[1] * b.d[0] + a.d[0] * b.d[1],
           a.d[2] * b.d[0] + 2.0 * a.d[1] * b.d[1] + a.d[0] * b.d[2]}};
}

// The functions W(t - c) ("weight") and W(t - c) (t - c) ("moment") of the lattice points whose
// support meets the interval.
struct Functions {
  Polynomial6 weight[3], moment[3];
};

// Sums over lattice points of bounds on absolute weights and moments.
struct Sizes {
  DerivativeBounds1 weight, moment;
};

Sizes sizes_of(const Functions& f, double b) {
  Sizes s;
  for (int c = 0; c < 3; ++c) {
    add_norms(f.weight[c], b, s.weight);
    add_norms(f.moment[c], b, s.moment);
  }
  return s;
}

// One axis of the lattice on an interval q - b <= t <= q + b, in powers of (t - q) / b once
// finished.
struct Axis {
  double b = 0.0;
  int points = 2;
  std::int64_t first = 0;  // of the lattice points
  bool straddles = false;
  Functions functions;
  Functions jump;           // factors of the truncated cube's error
  DerivativeBounds1 error;  // of the truncated cube
  Sizes size;               // sums of absolute terms before anything cancelled: for rounding
};

// Within the cell [floor(q), floor(q) + 1].
void expand_in_cell(double q, Axis& axis) {
  const double corner = std::floor(q), t = q - corner, s = 1.0 - t;
  axis.first = static_cast<std::int64_t>(corner);
  // fade(t + y) and its complement, each to within a few roundings of itself.
  const auto fade = [](double v) { return v * v * v * (10.0 + v * (-15.0 + 6.0 * v)); };
  const double near = fade(std::min(t, s)), far = 1.0 - near;
  Functions& f = axis.functions;
  f.weight[1] = {{t <= 0.5 ? near : far, 30.0 * t * t * s * s, 30.0 * t * s * (s - t),
                  10.0 - 60.0 * t * s, 15.0 * (t - s), 6.0}};
  for (int m = 1; m < kTerms; ++m) f.weight[0].c[m] = -f.weight[1].c[m];
  f.weight[0].c[0] = t <= 0.5 ? far : near;
  f.moment[0] = times_linear(f.weight[0], t);
  f.moment[1] = times_linear(f.weight[1], -s);
  axis.size = sizes_of(f, axis.b);
  // The cubic and quartic coefficients may cancel to 0.
  const double b = axis.b;
  const DerivativeBounds1 cancelled{{b * b * b * 80.0, b * b * 240.0, b * 480.0}};
  for (int n = 0; n < 3; ++n) {
    axis.size.weight.d[n] += cancelled.d[n];
    axis.size.moment.d[n] += cancelled.d[n] + 2.0 * axis.size.weight.d[n] * (n == 0 ? b : 1.0);
  }
}

// About lattice plane k. With z = t - k, the weights of the points k - 1, k, k + 1 are
//   max(0, -z)^3 (10 + 15 z + 6 z^2),  1 - the others,  max(0, z)^3 (10 - 15 z + 6 z^2),
// and max(0, -z)^3 = max(0, z)^3 - z^3.
void expand_about_plane(double q, double k, Axis& axis) {
  axis.first = static_cast<std::int64_t>(k) - 1;
  axis.points = 3;
  axis.straddles = true;
  const double z = q - k, b = axis.b;  // z of the centre, |z| < b
  const CubicPiece cube = truncated_cube(z, z - b, z + b);
  const Polynomial6 after{{cube.a[0], cube.a[1], cube.a[2], cube.a[3]}};
  const Polynomial6 before{
      {cube.a[0] - z * z * z, cube.a[1] - 3.0 * z * z, cube.a[2] - 3.0 * z, cube.a[3] - 1.0}};
  std::copy(cube.error, cube.error + 3, axis.error.d);
  const Polynomial6 up{{10.0 + z * (-15.0 + 6.0 * z), -15.0 + 12.0 * z, 6.0}};
  const Polynomial6 down{{10.0 + z * (15.0 + 6.0 * z), 15.0 + 12.0 * z, 6.0}};
  Functions& f = axis.functions;
  f.weight[0] = product(before, down);
  f.weight[2] = product(after, up);
  f.weight[1] = negative_sum(f.weight[0], f.weight[2]);
  f.weight[1].c[0] += 1.0;
  Functions& j = axis.jump;
  j.weight[0] = down;
  j.weight[2] = up;
  j.weight[1] = negative_sum(down, up);
  for (Functions* g : {&f, &j})
    for (int c = 0; c < 3; ++c) g->moment[c] = times_linear(g->weight[c], z + (1 - c));
  // Sizes before anything cancels: the cubics' terms on this interval, of width 2b, stay below 10
  // (2b)^3, the quadratics below 31.
  const DerivativeBounds1 cubic{{80.0 * b * b * b, 240.0 * b * b, 480.0 * b}};
  const DerivativeBounds1 outer = product(cubic, {{31.0, 27.0, 12.0}});
  const DerivativeBounds1 weight{{1.0 + 4.0 * outer.d[0], 4.0 * outer.d[1], 4.0 * outer.d[2]}};
  axis.size.weight = weight;
  axis.size.moment = {{2.0 * b + 8.0 * outer.d[0], 1.0 + 8.0 * outer.d[1] + 4.0 * outer.d[0],
                       8.0 * outer.d[2] + 8.0 * outer.d[1]}};
}

Axis expand(double q, double b) {
  Axis axis;
  axis.b = b;
  const double plane = std::round(q);
  if (std::abs(q - plane) < b * (1.0 - kHair))
    expand_about_plane(q, plane, axis);
  else
    expand_in_cell(q, axis);
  for (Functions* f : {&axis.functions, &axis.jump})
    for (int c = 0; c < 3; ++c) {
      rescale(f->weight[c], b);
      rescale(f->moment[c], b);
    }
  return axis;
}

using DirectionTable = int[3][3][3];

// Adds amplitude * sum_c g_c . (moment and weights) to `sum`.
void contract(double amplitude, const Axis (&axes)[3], const Functions* const (&functions)[3],
              const DirectionTable& directions, TensorPolynomial& sum) {
  constexpr int kStride = Polynomial6::kStride;
  for (int i = 0; i < axes[0].points; ++i) {
    TensorPolynomial::Plane with_moment{}, with_weight{};  // by what x contributes
    for (int j = 0; j < axes[1].points; ++j) {
      double gx[kStride] = {}, gy[kStride] = {}, gz[kStride] = {};
      for (int k = 0; k < axes[2].points; ++k) {
        const double* g = kPerlinDirection[directions[i][j][k]];
        const double* weight = functions[2]->weight[k].c;
        const double* moment = functions[2]->moment[k].c;
        for (int m = 0; m < kStride; ++m) {
          gx[m] += g[0] * weight[m];
          gy[m] += g[1] * weight[m];
          gz[m] += g[2] * moment[m];
        }
      }
      for (int n = 0; n < kTerms; ++n) {
        const double weight = amplitude * functions[1]->weight[j].c[n];
        const double moment = amplitude * functions[1]->moment[j].c[n];
        for (int m = 0; m < kStride; ++m) {
          with_moment[n].c[m] += weight * gx[m];
          with_weight[n].c[m] += moment * gy[m] + weight * gz[m];
        }
      }
    }
    sum.add(functions[0]->moment[i], with_moment);
    sum.add(functions[0]->weight[i], with_weight);
  }
}

void add_scaled(DerivativeBounds3& sum, const DerivativeBounds3& b, double f0, double f1,
                double f2) {
  sum.value += f0 * b.value;
  for (int i = 0; i < 3; ++i) sum.gradient[i] += f1 * b.gradient[i];
  sum.hessian += f2 * b.hessian;
}

// Bounds on a function of three variables times one of the variable `axis`.
DerivativeBounds3 product(const DerivativeBounds3& a, const DerivativeBounds1& f, int axis) {
  DerivativeBounds3 r;
  const double steepest = std::max({a.gradient[0], a.gradient[1], a.gradient[2]});
  r.value = a.value * f.d[0];
  for (int i = 0; i < 3; ++i) r.gradient[i] = a.gradient[i] * f.d[0];
  r.gradient[axis] += a.value * f.d[1];
  r.hessian = a.hessian * f.d[0] + 2.0 * steepest * f.d[1] + a.value * f.d[2];
  return r;
}

// Bounds on sum_c g_c . (moment and weights), |components of g_c| <= 1, from sums over each axis.
DerivativeBounds3 product(const Sizes& x, const Sizes& y, const Sizes& z) {
  const Sizes* s[3] = {&x, &y, &z};
  DerivativeBounds3 r;
  const auto total = [&](int nx, int ny, int nz) {
    const int n[3] = {nx, ny, nz};
    double sum = 0.0;
    for (int which = 0; which < 3; ++which) {  // which axis has the moment
      double p = 1.0;
      for (int a = 0; a < 3; ++a) p *= (a == which ? s[a]->moment : s[a]->weight).d[n[a]];
      sum += p;
    }
    return sum;
  };
  r.value = total(0, 0, 0);
  r.gradient[0] = total(1, 0, 0);
  r.gradient[1] = total(0, 1, 0);
  r.gradient[2] = total(0, 0, 1);
  r.hessian = std::max({total(2, 0, 0), total(0, 2, 0), total(0, 0, 2), total(1, 1, 0),
                        total(1, 0, 1), total(0, 1, 1)});
  return r;
}

}  // namespace

PerlinSum::PerlinSum(const topology::Box& box, double finest) {
  model_ = empty_model(box);
  for (int i = 0; i < 3; ++i) scale_[i] = std::max(model_.half[i], kSmallest / finest);
}

void PerlinSum::add_bounds(double amplitude, double frequency) {
  const double a = std::abs(amplitude);
  DerivativeBounds3 bounds;
  bounds.value = kPerlinBound[0];
  for (double& g : bounds.gradient) g = kPerlinBound[1];
  bounds.hessian = kPerlinBound[2];
  add_scaled(error_, bounds, a, a * frequency, a * frequency * frequency);
}

void PerlinSum::add(double amplitude, double frequency, const Imath::V3d& offset,
                    const Directions& directions) {
  Axis axes[3];
  double shift = 0.0;  // rounding of the centre's lattice coordinates, summed over the axes
  for (int a = 0; a < 3; ++a) {
    const double p = model_.centre[a] * frequency, q = p + offset[a], b = scale_[a] * frequency;
    // Written so that infinities and NaN fail it.
    if (!(b <= kWidest && std::abs(q) < 0x1p40)) return add_bounds(amplitude, frequency);
    shift += kEpsilon * (std::abs(p) + std::abs(q));
    axes[a] = expand(q, b);
  }
  DirectionTable table;
  for (int i = 0; i < axes[0].points; ++i)
    for (int j = 0; j < axes[1].points; ++j)
      for (int k = 0; k < axes[2].points; ++k)
        table[i][j][k] = directions(axes[0].first + i, axes[1].first + j, axes[2].first + k);
  const Functions* plain[3] = {&axes[0].functions, &axes[1].functions, &axes[2].functions};
  contract(amplitude, axes, plain, table, sum_);

  // The product over axes of (polynomial + error * jump), but for the polynomials' own.
  for (int set = 1; set < 8; ++set) {
    const Functions* functions[3] = {plain[0], plain[1], plain[2]};
    bool all = true;
    for (int a = 0; a < 3; ++a) {
      if (((set >> a) & 1) == 0) continue;
      all = all && axes[a].straddles;
      functions[a] = &axes[a].jump;
    }
    if (!all) continue;
    TensorPolynomial jump;
    contract(amplitude, axes, functions, table, jump);
    DerivativeBounds3 bounds = jump.bounds(scale_);
    for (int a = 0; a < 3; ++a) {
      if (((set >> a) & 1) == 0) continue;
      // The cube's error is known in lattice units.
      const DerivativeBounds1 error{{axes[a].error.d[0], axes[a].error.d[1] * frequency,
                                     axes[a].error.d[2] * frequency * frequency}};
      bounds = product(bounds, error, a);
    }
    add_scaled(error_, bounds, 1.0, 1.0, 1.0);
  }
  const double size = std::abs(amplitude), f1 = size * frequency, f2 = f1 * frequency;
  add_scaled(rounding_, product(axes[0].size, axes[1].size, axes[2].size), size, f1, f2);

  // The polynomial is the noise about a centre that is off by `shift`, and planes within a hair
  // were ignored: there, at a distance h, W is off by less than 20 h^3 on up to three axes.
  DerivativeBounds3 rest;
  const double hair = 2.0 * kHair * std::max({axes[0].b, axes[1].b, axes[2].b});
  rest.value = shift * kPerlinBound[1] + 1e3 * hair * hair * hair;
  for (double& g : rest.gradient) g = shift * kPerlinBound[2] + 1e3 * hair * hair;
  rest.hessian = shift * kPerlinBound[3] + 1e4 * hair;
  add_scaled(error_, rest, size, f1, f2);
}

topology::LocalModel PerlinSum::finish() {
  add_scaled(error_, sum_.economize(scale_, model_), 1.0, 1.0, 1.0);
  constexpr double kUnderflow = 1e-290;
  const double unit = kRoundings * kEpsilon;
  const double slimmest = std::min({scale_.x, scale_.y, scale_.z});
  model_.value_error = error_.value * (1.0 + unit) + unit * rounding_.value + kUnderflow;
  for (int i = 0; i < 3; ++i)
    model_.gradient_error[i] = error_.gradient[i] * (1.0 + unit) + unit * rounding_.gradient[i] +
                               kUnderflow / std::min(1.0, scale_[i]);
  model_.hessian_error = error_.hessian * (1.0 + unit) + unit * rounding_.hessian +
                         kUnderflow / std::min(1.0, slimmest * slimmest);
  model_.add_rounding();
  return model_;
}

}  // namespace morsel::geom
