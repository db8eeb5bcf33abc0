// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hypertexture_geom/field/radial_polynomial.cpp"
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
#include <hwy/foreach_target.h>
//
#include "hypertexture_geom/field/radial_move-inl.h"
#include "hypertexture_geom/field/radial_polynomial.h"

HWY_BEFORE_NAMESPACE();
namespace morsel::geom::HWY_NAMESPACE {

void move_polynomial(const RadialPolynomial& from, const Imath::V3d& centre, RadialPolynomial& to) {
  constexpr double kUnderflow = 1e-290;
  auto p = coefficients_of<double>(from);
  move_radial<double>(
      p, {centre.x - from.centre.x, centre.y - from.centre.y, centre.z - from.centre.z});
  to.centre = centre;
  for (int i = 0; i < topology::monomial::kCount; ++i) to.c[i] = p.c[i];
  for (int i = 0; i < 6; ++i) to.form[i] = p.form[i];
  for (int i = 0; i < 3; ++i) to.quintic[i] = p.quintic[i];
  to.sextic = p.sextic;
  for (int k = 0; k < 3; ++k) {
    to.error[k] = from.error[k] + kMoved * from.size[k] + kUnderflow;
    to.size[k] = from.size[k];
  }
}

}  // namespace morsel::geom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morsel::geom {

HWY_EXPORT(move_polynomial);

RadialPolynomial moved(const RadialPolynomial& polynomial, const Imath::V3d& centre) {
  RadialPolynomial result;
  HWY_DYNAMIC_DISPATCH(move_polynomial)(polynomial, centre, result);
  return result;
}

}  // namespace morsel::geom
#endif
