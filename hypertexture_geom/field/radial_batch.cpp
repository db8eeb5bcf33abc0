// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hypertexture_geom/field/radial_batch.cpp"
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
#include <hwy/foreach_target.h>
//
#include <cmath>

#include "hypertexture_geom/field/radial_batch.h"
#include "hypertexture_geom/field/radial_lanes-inl.h"
#include "hypertexture_geom/field/truncated_cube.h"

HWY_BEFORE_NAMESPACE();
namespace morsel::geom::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// truncated_cube() by lane, about q0.
struct Piece {
  Lanes a[4], error[3];
};

HWY_INLINE Piece whole_cube(Lanes q0) {
  const Lanes three_q = Lanes(3.0) * q0;
  return {{q0 * q0 * q0, three_q * q0, three_q, Lanes(1.0)}, {Lanes(0.0), Lanes(0.0), Lanes(0.0)}};
}

// For lanes where lo < 0 < hi; anything finite elsewhere.
HWY_INLINE Piece fitted_cube(Lanes q0, Lanes lo, Lanes hi) {
  using Tag = topology::HWY_NAMESPACE::LanesTag;
  const hn::Rebind<std::int64_t, Tag> integers;
  const TruncatedCubeTable& table = truncated_cube_table();
  constexpr double kSize = TruncatedCubeTable::kSize;
  const Lanes r = minimum(maximum(-lo / (hi - lo), Lanes(0.0)), Lanes(1.0));
  // Truncation of numbers within [0, kSize - 1].
  const auto index = hn::ConvertTo(integers, minimum(r * Lanes(kSize), Lanes(kSize - 0.5)).v);
  const auto column = [&](const double* values) {
    return Lanes(hn::GatherIndex(Tag(), values, index));
  };
  const Lanes knot = (Lanes(hn::ConvertTo(Tag(), index)) + Lanes(0.5)) * Lanes(1.0 / kSize);
  const LaneMask lower = knot > r;
  const Lanes low = select(lower, -hi * column(table.below), lo);
  const Lanes high = select(lower, hi, -lo * column(table.above));
  const Lanes size = (high - low) * Lanes(1.0 + 1e-14);
  const Lanes t = (q0 - low) / size, size2 = size * size, size3 = size2 * size;
  Lanes c[4];
  for (int i = 0; i < 4; ++i) c[i] = column(table.c[i]);
  const Lanes three_t = Lanes(3.0) * t;
  return {{size3 * (c[0] + t * (c[1] + t * (c[2] + t * c[3]))),
           size2 * (c[1] + t * (Lanes(2.0) * c[2] + three_t * c[3])),
           size * (c[2] + three_t * c[3]), c[3]},
          {size3 * column(table.error[0]), size2 * column(table.error[1]),
           size * column(table.error[2])}};
}

HWY_INLINE Piece select_piece(LaneMask m, const Piece& yes, const Piece& no) {
  Piece p;
  for (int i = 0; i < 4; ++i) p.a[i] = select(m, yes.a[i], no.a[i]);
  for (int i = 0; i < 3; ++i) p.error[i] = select(m, yes.error[i], no.error[i]);
  return p;
}

// See radial_term() in impulse_model.cpp.
HWY_INLINE void add_impulse(const Impulse& impulse, RadialLanes& sum) {
  constexpr double kSlack = 1e-12;  // relative, on squared distances
  const Lanes zero(0.0), one(1.0);
  Lanes d[3], nearest(0.0), farthest(0.0), square(0.0);
  for (int i = 0; i < 3; ++i) {
    d[i] = sum.centre(i) - Lanes(impulse.centre[i]);
    const Lanes away = absolute(d[i]);
    const Lanes low = maximum(zero, away - sum.half(i)), high = away + sum.half(i);
    nearest += low * low;
    farthest += high * high;
    square += d[i] * d[i];
  }
  const double s = impulse.inverse_square, w = impulse.weight;
  const Lanes near = Lanes(s) * nearest, far = Lanes(s) * farthest;
  if (!any(near < Lanes(1.0 + kSlack))) return;
  const Lanes q0 = one - Lanes(s) * square;
  const Lanes z = one + far;  // bounds |q| and what q is computed from
  const Lanes slack = Lanes(kSlack) * z;
  const Lanes lo = one - far - slack, hi = one - near + slack;
  const LaneMask out = hi <= zero, cut = without(lo < zero, out);
  const Lanes weight(w), size(std::abs(w));
  Piece piece = whole_cube(q0);
  if (any(cut)) {
    piece = select_piece(cut, fitted_cube(q0, lo, hi), piece);
    // In a box much wider than the kernel the polynomial says less than the plain range: where the
    // largest |grad q| times the half sizes' sum is above 4.
    const Lanes extent = sum.half(0) + sum.half(1) + sum.half(2);
    const LaneMask wide = Lanes(s) * far * extent * extent > Lanes(4.0);
    if (any(wide)) {
      const Lanes top = minimum(maximum(hi, zero), one), bottom = minimum(maximum(lo, zero), one);
      const Lanes high = top * top * top, low = bottom * bottom * bottom, half(0.5);
      const Piece plain{{half * (high + low), zero, zero, zero},
                        {half * (high - low), Lanes(3.0) * top * top, Lanes(6.0) * top}};
      piece = select_piece(wide, plain, piece);
    }
  }
  if (any(out)) {
    for (Lanes& a : piece.a) a = select(out, zero, a);
    for (Lanes& e : piece.error) e = select(out, zero, e);
  }
  const Lanes minus(-s);
  sum.add_cubic(d, minus, weight * piece.a[0], weight * piece.a[1], weight * piece.a[2],
                weight * piece.a[3]);
  if (any(cut))
    sum.add_error(d, minus, size * piece.error[0], size * piece.error[1], size * piece.error[2]);
  // Sizes of the value and the derivatives of a sum of absolute values, as in RadialSum::add, with
  // |grad q| <= 2 sqrt(s far) <= sqrt(s) z.
  const double slope = std::sqrt(s) * (1.0 + 1e-12), aw = std::abs(w);
  const Lanes z3 = z * z * z;
  sum.add_sizes(Lanes(8.0 * aw) * z3, Lanes(12.0 * aw * slope) * z3,
                Lanes(36.0 * aw * slope * slope) * z3);
}

void impulse_models(const ImpulseList& impulses, const RadialPolynomial& polynomial,
                    topology::ModelBatch& models) {
  for (std::size_t first = 0; first < topology::ModelBatch::kSize; first += Lanes::count()) {
    RadialLanes sum(models, first);
    if (!polynomial.empty()) sum.add_polynomial(polynomial);
    for (std::size_t n = 0; n < impulses.size(); ++n) add_impulse(impulses[n], sum);
    sum.finish(static_cast<int>(impulses.size()) + 1, models);
  }
}

// See density_sphere.cpp.
void sphere_models(const Imath::V3d& centre, double radius, double square,
                   topology::ModelBatch& models) {
  const Lanes zero(0.0), one(1.0), half(0.5);
  for (std::size_t first = 0; first < topology::ModelBatch::kSize; first += Lanes::count()) {
    RadialLanes sum(models, first);
    Lanes d[3], nearest(square), farthest(square), q0(square);
    for (int i = 0; i < 3; ++i) {
      d[i] = sum.centre(i) - Lanes(centre[i]);
      const Lanes away = absolute(d[i]);
      const Lanes low = maximum(zero, away - sum.half(i)), high = away + sum.half(i);
      nearest += low * low;
      farthest += high * high;
      q0 += d[i] * d[i];
    }
    nearest = nearest * Lanes(1.0 - 1e-12);
    farthest = farthest * Lanes(1.0 + 1e-12);
    const Lanes root = square_root(q0), lowest = square_root(nearest);
    const Lanes highest = square_root(farthest), half_range = half * (highest - lowest);
    const Lanes e = maximum(farthest - q0, q0 - nearest) + Lanes(1e-12) * farthest;
    const Lanes low_inverse = one / lowest, near_inverse = low_inverse * low_inverse;
    const Lanes fourth = Lanes(15.0 / 16.0) * low_inverse * near_inverse * near_inverse *
                         near_inverse * Lanes(1.0 + 1e-12);
    const Lanes e2 = e * e;
    const Lanes error[3] = {fourth * e2 * e2 * Lanes(1.0 / 24.0),
                            fourth * e2 * e * Lanes(1.0 / 6.0), fourth * e2 * half};
    // Too wide a box for the Taylor polynomial: the plain range. |grad D| < 1, and its derivatives
    // are at most 1 / lowest.
    const LaneMask narrow = error[0] < half_range;
    const Lanes inverse = one / root, inverse_square = one / q0;
    const Lanes a[4] = {select(narrow, -root, -half * (highest + lowest)),
                        where(narrow, -half * inverse),
                        where(narrow, Lanes(0.125) * inverse * inverse_square),
                        where(narrow, Lanes(-0.0625) * inverse * inverse_square * inverse_square)};
    sum.add_cubic(d, one, a[0], a[1], a[2], a[3]);
    sum.add_to_constant(Lanes(radius));
    sum.add_error(d, one, where(narrow, error[0]), where(narrow, error[1]),
                  where(narrow, error[2]));
    const Lanes none(0.0);
    const Lanes wide_value = half_range + Lanes(1e-12) * (highest + Lanes(std::abs(radius)));
    sum.add_plain_error(select(narrow, none, wide_value), select(narrow, none, one),
                        select(narrow, none, low_inverse * Lanes(1.0 + 1e-12)));
    // RadialSum::add's sizes.
    const Lanes s0 = highest, s1 = half * low_inverse,
                s2 = Lanes(0.125) * low_inverse * near_inverse,
                s3 = Lanes(0.0625) * low_inverse * near_inverse * near_inverse;
    const Lanes z = farthest;
    const Lanes v1 = s1 + Lanes(2.0) * z * (s2 + Lanes(1.5) * z * s3);
    const Lanes v2 = Lanes(2.0) * s2 + Lanes(6.0) * z * s3;
    const Lanes reach = Lanes(2.0) * square_root(farthest);
    sum.add_sizes(where(narrow, s0 + z * (s1 + z * (s2 + z * s3))) + Lanes(std::abs(radius)),
                  where(narrow, v1 * reach), where(narrow, v2 * reach * reach + Lanes(2.0) * v1));
    sum.finish(2, models);
  }
}

}  // namespace
}  // namespace morsel::geom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morsel::geom {

HWY_EXPORT(impulse_models);
HWY_EXPORT(sphere_models);

void child_models_of(const ImpulseList& impulses, const RadialPolynomial& polynomial,
                     topology::ModelBatch& models) {
  HWY_DYNAMIC_DISPATCH(impulse_models)(impulses, polynomial, models);
}

void child_models_of_sphere(const Imath::V3d& centre, double radius, double square,
                            topology::ModelBatch& models) {
  HWY_DYNAMIC_DISPATCH(sphere_models)(centre, radius, square, models);
}

}  // namespace morsel::geom
#endif
