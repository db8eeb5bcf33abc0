// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/cell_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morsel::topology::meshing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Covers the rounding of the few operations between bounds that are proved and what is returned.
constexpr double kOutward = 1.0 + 1e-12;

bool has_sign(const Interval& r) { return r.lo > 0.0 || r.hi < 0.0; }
bool keeps_sign(const Interval& r) { return r.lo >= 0.0 || r.hi <= 0.0; }

// On a face (`free` its two axes) or an edge (one axis, twice).
bool is_simple(const LocalModel& model, int free_a, int free_b) {
  if (has_sign(model.plain_range())) return true;
  if (keeps_sign(model.gradient_range(free_a))) return true;
  if (free_b != free_a && keeps_sign(model.gradient_range(free_b))) return true;
  return has_sign(model.range());
}

// The largest of sum_{i<j} l_i l_j q_ij over l_i >= 0, l_1 + l_2 + l_3 = 1 for q >= 0; q[i] belongs
// to the side opposite of corner i. For q = squared lengths this is the squared radius of the
// smallest circle around the triangle.
double largest_form(const std::array<double, 3>& q) {
  const double a = q[0], b = q[1], c = q[2];
  const bool inside = a < b + c && b < c + a && c < a + b;
  const double area = 2.0 * (a * b + b * c + c * a) - (a * a + b * b + c * c);
  if (inside && area > 0.0) return a * b * c / area;
  return std::max({a, b, c}) / 4.0;
}

}  // namespace

bool avoids_zero(const LocalModel& model, double below) {
  const auto avoids = [&](const Interval& r) { return r.lo > 0.0 || r.hi < -below; };
  return avoids(model.plain_range()) || avoids(model.range());
}

bool is_resolved(const LocalModel& model) {
  bool monotone[3], any = false;
  for (int i = 0; i < 3; ++i) {
    monotone[i] = keeps_sign(model.gradient_range(i));
    any = any || monotone[i];
  }
  if (!any) return has_sign(model.range());
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    if (monotone[b] || monotone[c]) continue;
    for (const int side : {-1, 1})
      if (!is_simple(model.on_face(a, side), b, c)) return false;
  }
  for (int a = 0; a < 3; ++a) {
    if (monotone[a]) continue;
    for (const int side_b : {-1, 1})
      for (const int side_c : {-1, 1})
        if (!is_simple(model.on_face((a + 1) % 3, side_b).on_face((a + 2) % 3, side_c), a, a))
          return false;
  }
  return true;
}

CellBounds bounds_of(const LocalModel& model, const Box& box, double reach) {
  CellBounds bounds;
  bounds.reach = reach;
  constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  double change = 0.0;
  for (unsigned k = 0; k < 6; ++k) {
    const Interval h = model.hessian_range(kPairs[k][0], kPairs[k][1]);
    bounds.hessian[k] = h.middle();
    const double radius = std::max(h.hi - bounds.hessian[k], bounds.hessian[k] - h.lo);
    change += (k < 3 ? 1.0 : 2.0) * radius * radius;
  }
  double norm = 0.0;
  for (const double h : bounds.hessian) norm += 2.0 * std::abs(h);
  // The second term is for the rounding of the forms that triangle_error computes.
  bounds.hessian_change = kOutward * std::sqrt(change) + 1e-14 * norm;

  const Imath::V3d gradient = model.gradient_at(Imath::V3d(0.0));
  const double length = gradient.length();
  Interval slope = Interval::point(0.0);
  if (length > 0.0 && std::isfinite(length)) {
    for (int i = 0; i < 3; ++i)
      slope = slope + Interval::point(gradient[i] / length) * model.gradient_range(i);
    // The direction's length is 1 to within rounding.
    bounds.slope = slope.lo - 1e-15 * slope.magnitude();
    const Imath::V3d n = gradient / length;
    // The second fundamental form: the Hessian on the tangent plane, by its Frobenius norm.
    const auto& h = bounds.hessian;
    const Imath::V3d hn(h[0] * n.x + h[3] * n.y + h[4] * n.z, h[3] * n.x + h[1] * n.y + h[5] * n.z,
                        h[4] * n.x + h[5] * n.y + h[2] * n.z);
    const double nhn = n.dot(hn);
    const double whole =
        h[0] * h[0] + h[1] * h[1] + h[2] * h[2] + 2.0 * (h[3] * h[3] + h[4] * h[4] + h[5] * h[5]);
    bounds.curvature = std::sqrt(std::max(0.0, whole - 2.0 * hn.length2() + nhn * nhn)) / length;
  }

  LocalModel own = model;
  own.half = half_size(box);
  bounds.resolved = is_resolved(own);
  return bounds;
}

double CellBounds::triangle_error(const std::array<Imath::V3d, 3>& corners, double residual) const {
  if (!(slope > 0.0)) return kInfinity;
  // Linear interpolation misses F at x = sum l_i v_i by 1/2 sum_i l_i (x - v_i)' H_i (x - v_i), H_i
  // a mean of Hessians between x and v_i. With H_i = H at the centre that is
  // 1/2 sum_{i<j} l_i l_j d_ij' H d_ij; the rest is at most 1/2 change sum_{i<j} l_i l_j |d_ij|^2.
  std::array<double, 3> above, below, lengths;
  for (unsigned i = 0; i < 3; ++i) {
    const Imath::V3d d = corners[(i + 2) % 3] - corners[(i + 1) % 3];
    const double form =
        hessian[0] * d.x * d.x + hessian[1] * d.y * d.y + hessian[2] * d.z * d.z +
        2.0 * (hessian[3] * d.x * d.y + hessian[4] * d.x * d.z + hessian[5] * d.y * d.z);
    above[i] = std::max(form, 0.0);
    below[i] = std::max(-form, 0.0);
    lengths[i] = d.length2();
  }
  const double bend = std::max(largest_form(above), largest_form(below));
  const double value = residual + 0.5 * (bend + hessian_change * largest_form(lengths));
  const double error = kOutward * value / slope;
  // The slope is known on the way to the surface only within reach of the cell.
  return error <= reach ? error : kInfinity;
}

}  // namespace morsel::topology::meshing
