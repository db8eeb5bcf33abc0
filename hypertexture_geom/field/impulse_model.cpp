// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/impulse_model.h"

#include <algorithm>
#include <cmath>

#include "hypertexture_geom/field/truncated_cube.h"

namespace morsel::geom {
namespace {

// Squared distance from a point at `d` from the box's centre to the nearest and to the farthest
// point of the box.
struct Distances {
  double nearest, farthest;
};

Distances distances(const Imath::V3d& d, const Imath::V3d& half) {
  Distances r{0.0, 0.0};
  for (int i = 0; i < 3; ++i) {
    const double a = std::abs(d[i]);
    const double low = std::max(0.0, a - half[i]), high = a + half[i];
    r.nearest += low * low;
    r.farthest += high * high;
  }
  return r;
}

// Relative slack on squared distances: far above their rounding, far below anything that matters.
constexpr double kSlack = 1e-12;

RadialTerm radial_term(const Impulse& impulse, const Imath::V3d& centre, const Imath::V3d& half) {
  RadialTerm t;
  t.d = centre - impulse.centre;
  t.s = -impulse.inverse_square;
  t.weight = impulse.weight;
  const Distances r = distances(t.d, half);
  const double near = impulse.inverse_square * r.nearest, far = impulse.inverse_square * r.farthest;
  const double q0 = 1.0 - impulse.inverse_square * t.d.length2();
  t.size = 1.0 + far;
  const double lo = 1.0 - far - kSlack * t.size, hi = 1.0 - near + kSlack * t.size;
  const CubicPiece piece = truncated_cube(q0, lo, hi);
  std::copy(piece.a, piece.a + 4, t.a);
  std::copy(piece.error, piece.error + 3, t.error);
  const double z = t.size;
  t.a_size[0] = z * z * z;
  t.a_size[1] = 3.0 * z * z;
  t.a_size[2] = 3.0 * z;
  t.a_size[3] = 1.0;
  // In a box much wider than the kernel the polynomial says less than the plain range. (A limit of
  // 4 rather than 2 takes a sixth of the labelling's models away; more makes no difference.)
  const double top = std::clamp(hi, 0.0, 1.0);
  const double reach = 2.0 * impulse.inverse_square * std::sqrt(r.farthest);  // of |grad q|
  if (reach * (half.x + half.y + half.z) > 4.0) {
    const double bottom = std::clamp(lo, 0.0, 1.0);
    const double high = top * top * top, low = bottom * bottom * bottom;
    t.a[0] = 0.5 * (high + low);
    t.a[1] = t.a[2] = t.a[3] = 0.0;
    t.error[0] = 0.5 * (high - low);
    t.error[1] = 3.0 * top * top;
    t.error[2] = 6.0 * top;
  }
  return t;
}

}  // namespace

bool reaches(const Impulse& impulse, const Imath::V3d& centre, const Imath::V3d& half) {
  return impulse.inverse_square * distances(centre - impulse.centre, half).nearest < 1.0 + kSlack;
}

void add_jet(const ImpulseList& impulses, const Imath::V3d& x, topology::Jet& jet) {
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    const Impulse p = impulses[n];
    const Imath::V3d d = x - p.centre;
    const double q = 1.0 - p.inverse_square * d.length2();
    if (q <= 0.0) continue;
    // grad q = -2 s d, Hessian of q = -2 s I.
    const double s2 = 2.0 * p.inverse_square;
    const double first = 3.0 * p.weight * q * q, second = 6.0 * p.weight * q * s2 * s2;
    jet.value += p.weight * (q * q * q);
    jet.gradient -= d * (first * s2);
    jet.hessian[0] += second * d.x * d.x - first * s2;
    jet.hessian[1] += second * d.y * d.y - first * s2;
    jet.hessian[2] += second * d.z * d.z - first * s2;
    jet.hessian[3] += second * d.x * d.y;
    jet.hessian[4] += second * d.x * d.z;
    jet.hessian[5] += second * d.y * d.z;
  }
}

void add_terms(const ImpulseList& impulses, RadialSum& sum) {
  for (std::size_t n = 0; n < impulses.size(); ++n)
    if (const Impulse p = impulses[n]; reaches(p, sum.centre(), sum.half()))
      sum.add(radial_term(p, sum.centre(), sum.half()));
}

}  // namespace morsel::geom
