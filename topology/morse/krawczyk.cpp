// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/krawczyk.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace morsel::topology {
namespace {

// About the inverse of the Hessian in the middle of the box; false when there is none worth having.
bool inverse_hessian(const LocalModel& model, Eigen::Matrix3d& inverse) {
  Eigen::Matrix3d h;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) h(i, j) = model.hessian_range(i, j).middle();
  if (!h.allFinite()) return false;
  bool invertible = false;
  h.computeInverseWithCheck(inverse, invertible, 0.0);
  return invertible && inverse.allFinite();
}

// Y g
IntervalVector product(const Eigen::Matrix3d& y, const IntervalVector& g) {
  IntervalVector r{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r[i] = r[i] + Interval::point(y(i, j)) * g[j];
  return r;
}

Interval symmetric(double half) { return {-half, half}; }

// Enclosure of the mean of d2F/dx_i dx_j along any segment from the box's centre to a point in it:
// what P's third derivatives add grows linearly along the segment, so its mean is half.
Interval slope_range(const LocalModel& model, int i, int j) {
  const Interval h = model.hessian_range(i, j);
  const double reach = 0.5 * h.width(), error = model.hessian_error;
  if (!std::isfinite(reach) || !std::isfinite(error)) return Interval::whole();
  const double mean = 0.5 * std::max(0.0, reach - error) + error;
  const double middle = h.middle();
  return outward(middle - mean, middle + mean);
}

}  // namespace

IntervalVector gradient_at_centre(const LocalModel& model) {
  IntervalVector g;
  for (int i = 0; i < 3; ++i) {
    const double c = model.c[monomial::kX + i], e = model.gradient_error[i];
    g[i] = std::isfinite(c) && std::isfinite(e) ? outward(c - e, c + e) : Interval::whole();
  }
  return g;
}

bool excludes_zero(const LocalModel& model) {
  Eigen::Matrix3d y;
  if (!inverse_hessian(model, y)) return false;
  const IntervalVector shift = product(y, gradient_at_centre(model));
  for (int i = 0; i < 3; ++i) {
    Interval sum = shift[i];
    for (int j = 0; j < 3; ++j) {
      Interval slope;  // (Y S)_ij
      for (int k = 0; k < 3; ++k)
        slope = slope + Interval::point(y(i, k)) * slope_range(model, k, j);
      sum = sum + slope * symmetric(model.half[j]);
    }
    if (!sum.contains(0.0)) return true;
  }
  return false;
}

Krawczyk krawczyk(const LocalModel& model, const IntervalVector& g) {
  Krawczyk result;
  const Imath::V3d &m = model.centre, &h = model.half;
  result.enclosure = Box(m - h, m + h);
  Eigen::Matrix3d y;
  if (!inverse_hessian(model, y)) return result;
  const IntervalVector step = product(y, g);
  bool inside = true, apart = false;
  Box enclosure;
  for (int i = 0; i < 3; ++i) {
    Interval k = -step[i];  // K - m
    for (int j = 0; j < 3; ++j) {
      Interval residual = Interval::point(i == j ? -1.0 : 0.0);
      for (int l = 0; l < 3; ++l)
        residual = residual + Interval::point(y(i, l)) * model.hessian_range(l, j);
      k = k + residual * symmetric(h[j]);
    }
    inside = inside && k.lo > -h[i] && k.hi < h[i];
    apart = apart || k.lo > h[i] || k.hi < -h[i];
    const Interval place =
        Interval::point(m[i]) + Interval{std::max(k.lo, -h[i]), std::min(k.hi, h[i])};
    enclosure.min[i] = place.lo;
    enclosure.max[i] = place.hi;
  }
  if (apart) {
    result.zeros = ZeroCount::kNone;
    return result;
  }
  result.enclosure = enclosure;
  if (inside) result.zeros = ZeroCount::kOne;
  return result;
}

}  // namespace morsel::topology
