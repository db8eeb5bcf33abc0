// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/curvature.h"

#include <algorithm>
#include <cmath>

namespace morsel::geom {
namespace {

double half_difference(const Curvature& c) {
  return std::sqrt(std::max(0.0, c.mean * c.mean - c.gaussian));
}

}  // namespace

double Curvature::largest() const { return mean + half_difference(*this); }
double Curvature::smallest() const { return mean - half_difference(*this); }

Curvature curvature(const topology::Jet& jet) {
  const double slope = jet.gradient.length();
  if (!(slope > 0.0)) return {};
  // With the unit gradient no power of its length can overflow or vanish.
  const Imath::V3d n = jet.gradient / slope;
  const double xx = jet.hessian[0], yy = jet.hessian[1], zz = jet.hessian[2];
  const double xy = jet.hessian[3], xz = jet.hessian[4], yz = jet.hessian[5];
  const Imath::V3d hn(xx * n.x + xy * n.y + xz * n.z, xy * n.x + yy * n.y + yz * n.z,
                      xz * n.x + yz * n.y + zz * n.z);
  const Imath::V3d adjugate_n(
      (yy * zz - yz * yz) * n.x + (xz * yz - xy * zz) * n.y + (xy * yz - xz * yy) * n.z,
      (xz * yz - xy * zz) * n.x + (xx * zz - xz * xz) * n.y + (xy * xz - xx * yz) * n.z,
      (xy * yz - xz * yy) * n.x + (xy * xz - xx * yz) * n.y + (xx * yy - xy * xy) * n.z);
  Curvature c;
  c.mean = 0.5 * (n.dot(hn) - (xx + yy + zz)) / slope;
  c.gaussian = n.dot(adjugate_n) / (slope * slope);
  return c;
}

}  // namespace morsel::geom
