// SPDX-License-Identifier: Apache-2.0
// The retraction cascade for eight cells at once. Highway compiles this file once for each
// instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "topology/model_batch.cpp"
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
#include <hwy/foreach_target.h>
//
#include <limits>

#include "topology/lanes-inl.h"
#include "topology/model_batch.h"

HWY_BEFORE_NAMESPACE();
namespace morsel::topology::HWY_NAMESPACE {
namespace {

using namespace monomial;

constexpr int kSecond[3][3] = {{kXX, kXY, kXZ}, {kXY, kYY, kYZ}, {kXZ, kYZ, kZZ}};
constexpr int kThird[3][3][3] = {
    {{kXXX, kXXY, kXXZ}, {kXXY, kXYY, kXYZ}, {kXXZ, kXYZ, kXZZ}},
    {{kXXY, kXYY, kXYZ}, {kXYY, kYYY, kYYZ}, {kXYZ, kYYZ, kYZZ}},
    {{kXXZ, kXYZ, kXZZ}, {kXYZ, kYYZ, kYZZ}, {kXZZ, kYZZ, kZZZ}},
};
// Index of x^i y^j z^k, i + j + k <= 3; -1 beyond.
constexpr int kPower[4][4][4] = {
    {{k1, kZ, kZZ, kZZZ}, {kY, kYZ, kYZZ, -1}, {kYY, kYYZ, -1, -1}, {kYYY, -1, -1, -1}},
    {{kX, kXZ, kXZZ, -1}, {kXY, kXYZ, -1, -1}, {kXYY, -1, -1, -1}, {-1, -1, -1, -1}},
    {{kXX, kXXZ, -1, -1}, {kXXY, -1, -1, -1}, {-1, -1, -1, -1}, {-1, -1, -1, -1}},
    {{kXXX, -1, -1, -1}, {-1, -1, -1, -1}, {-1, -1, -1, -1}, {-1, -1, -1, -1}},
};
// As in local_model.cpp.
constexpr double kSlack = 96.0 * 0x1p-52, kUnderflow = 1e-290;
// Beyond this size intermediate results could overflow: such a model says nothing.
constexpr double kHuge = 1e80, kWide = 1e60;

struct Range {
  Lanes lo, hi;
};

// One model a lane.
struct Model {
  Lanes c[kCount], half[3], value_error, gradient_error[3];
};

// What is known of the signs of the partial derivatives: lanes where it is >= 0 or <= 0 everywhere.
struct Signs {
  LaneMask positive[3], negative[3];
  LaneMask known(int axis) const { return positive[axis] | negative[axis]; }
};

HWY_INLINE Range add_parabola(Lanes a, Lanes b, Lanes h, Range sum) {
  const Lanes bend = b * h * h, slope = absolute(a) * h;
  Lanes low = bend - slope, high = bend + slope;
  const LaneMask inside = Lanes(2.0) * absolute(b) * h > absolute(a);
  if (any(inside)) {
    // As in add_parabola: a * a would underflow too early.
    const Lanes vertex = -(a * (a / select(inside, Lanes(4.0) * b, Lanes(1.0))));
    low = select(inside, minimum(low, vertex), low);
    high = select(inside, maximum(high, vertex), high);
  }
  return {sum.lo + low, sum.hi + high};
}

// LocalModel::plain_range.
HWY_INLINE Range plain_range(const Model& m) {
  const Lanes hx = m.half[0], hy = m.half[1], hz = m.half[2];
  const auto& c = m.c;
  Range r{c[k1] - m.value_error, c[k1] + m.value_error};
  r = add_parabola(c[kX], c[kXX], hx, r);
  r = add_parabola(c[kY], c[kYY], hy, r);
  r = add_parabola(c[kZ], c[kZZ], hz, r);
  const Lanes rest =
      hx * (hy * (absolute(c[kXY]) + hx * absolute(c[kXXY]) + hy * absolute(c[kXYY]) +
                  hz * absolute(c[kXYZ])) +
            hz * (absolute(c[kXZ]) + hx * absolute(c[kXXZ]) + hz * absolute(c[kXZZ])) +
            hx * hx * absolute(c[kXXX])) +
      hy * (hz * (absolute(c[kYZ]) + hy * absolute(c[kYYZ]) + hz * absolute(c[kYZZ])) +
            hy * hy * absolute(c[kYYY])) +
      hz * hz * hz * absolute(c[kZZZ]);
  return {r.lo - rest, r.hi + rest};
}

// LocalModel::gradient_range.
Range gradient_range(const Model& m, int a) {
  Lanes linear[3], square[3], cross[3];
  for (int j = 0; j < 3; ++j) {
    linear[j] = Lanes(j == a ? 2.0 : 1.0) * m.c[kSecond[a][j]];
    square[j] = Lanes(j == a ? 3.0 : 1.0) * m.c[kThird[a][j][j]];
    const int k = (j + 1) % 3, l = (j + 2) % 3;
    cross[j] = Lanes(1.0 + (a == k) + (a == l)) * m.c[kThird[a][k][l]];
  }
  Lanes end[2];
  for (int side = 0; side < 2; ++side) {
    const Lanes sign(side == 0 ? -1.0 : 1.0);
    Lanes f = m.c[kX + a];
    Lanes g[3] = {linear[0], linear[1], linear[2]}, x[3] = {cross[0], cross[1], cross[2]};
    LaneMask fixed[3] = {no_lanes(), no_lanes(), no_lanes()};
    for (int j = 0; j < 3; ++j) {
      const int k = (j + 1) % 3, l = (j + 2) % 3;
      const Lanes reach = Lanes(2.0) * absolute(square[j]) * m.half[j] +
                          absolute(x[l]) * select(fixed[k], Lanes(0.0), m.half[k]) +
                          absolute(x[k]) * select(fixed[l], Lanes(0.0), m.half[l]);
      const LaneMask monotone = absolute(g[j]) >= reach;
      const Lanes towards = sign * m.half[j];
      const Lanes t = where(monotone, select(g[j] >= Lanes(0.0), towards, -towards));
      f += t * (g[j] + t * square[j]);  // nothing where t is 0
      g[k] = select(fixed[k], g[k], g[k] + t * x[l]);
      g[l] = select(fixed[l], g[l], g[l] + t * x[k]);
      x[k] = select(monotone, Lanes(0.0), x[k]);
      x[l] = select(monotone, Lanes(0.0), x[l]);
      fixed[j] = monotone;
    }
    Range r{f, f};
    for (int j = 0; j < 3; ++j) {
      const Range more = add_parabola(g[j], square[j], m.half[j], r);
      r = {select(fixed[j], r.lo, more.lo), select(fixed[j], r.hi, more.hi)};
      const Lanes rest = absolute(x[j]) * m.half[(j + 1) % 3] * m.half[(j + 2) % 3];
      r = {r.lo - rest, r.hi + rest};
    }
    end[side] = side == 0 ? r.lo - m.gradient_error[a] : r.hi + m.gradient_error[a];
  }
  return {end[0], end[1]};
}

struct Bernstein {
  Lanes b[4];
};
HWY_INLINE Bernstein bernstein(Lanes a0, Lanes a1, Lanes a2, Lanes a3) {
  const Lanes third(1.0 / 3.0);
  const Lanes even = a0 + a2, odd = a1 + a3;
  const Lanes even_inner = a0 - third * a2, odd_inner = third * a1 - a3;
  return {{even - odd, even_inner - odd_inner, even_inner + odd_inner, even + odd}};
}

// LocalModel::bernstein_range.
Range bernstein_range(const Model& m) {
  const Lanes one(1.0), zero(0.0);
  const Lanes px[4] = {one, m.half[0], m.half[0] * m.half[0], m.half[0] * m.half[0] * m.half[0]};
  const Lanes py[4] = {one, m.half[1], m.half[1] * m.half[1], m.half[1] * m.half[1] * m.half[1]};
  const Lanes pz[4] = {one, m.half[2], m.half[2] * m.half[2], m.half[2] * m.half[2] * m.half[2]};
  Lanes after_x[4][4][4];
  for (int j = 0; j < 4; ++j) {
    for (int k = 0; j + k < 4; ++k) {
      Lanes a[4] = {zero, zero, zero, zero};
      const Lanes scale = py[j] * pz[k];
      for (int i = 0; i + j + k < 4; ++i) a[i] = m.c[kPower[i][j][k]] * scale * px[i];
      const Bernstein b = bernstein(a[0], a[1], a[2], a[3]);
      for (int i = 0; i < 4; ++i) after_x[i][j][k] = b.b[i];
    }
  }
  Range r{after_x[0][0][0], after_x[0][0][0]};
  bool first = true;
  for (int i = 0; i < 4; ++i) {
    Lanes after_y[4][4];
    for (int k = 0; k < 4; ++k) {
      const Bernstein b =
          bernstein(after_x[i][0][k], k < 3 ? after_x[i][1][k] : zero,
                    k < 2 ? after_x[i][2][k] : zero, k < 1 ? after_x[i][3][k] : zero);
      for (int j = 0; j < 4; ++j) after_y[j][k] = b.b[j];
    }
    for (int j = 0; j < 4; ++j) {
      const Bernstein b = bernstein(after_y[j][0], after_y[j][1], after_y[j][2], after_y[j][3]);
      for (const Lanes& value : b.b) {
        r.lo = first ? value : minimum(r.lo, value);
        r.hi = first ? value : maximum(r.hi, value);
        first = false;
      }
    }
  }
  return {r.lo - m.value_error, r.hi + m.value_error};
}

// LocalModel::on_face, `t` from the centre along axis a: -half or +half by lane.
HWY_INLINE Model on_face(const Model& m, int a, Lanes t) {
  Model f = m;
  f.half[a] = Lanes(0.0);
  const Lanes ca = m.c[kX + a], caa = m.c[kSecond[a][a]], caaa = m.c[kThird[a][a][a]];
  f.c[k1] = m.c[k1] + t * (ca + t * (caa + t * caaa));
  f.c[kX + a] = ca + t * (Lanes(2.0) * caa + t * Lanes(3.0) * caaa);
  f.c[kSecond[a][a]] = caa + Lanes(3.0) * t * caaa;
  for (int j = 0; j < 3; ++j) {
    if (j == a) continue;
    f.c[kX + j] = m.c[kX + j] + t * (m.c[kSecond[a][j]] + t * m.c[kThird[a][a][j]]);
    f.c[kSecond[a][j]] = m.c[kSecond[a][j]] + Lanes(2.0) * t * m.c[kThird[a][a][j]];
    for (int k = j; k < 3; ++k)
      if (k != a) f.c[kSecond[j][k]] = m.c[kSecond[j][k]] + t * m.c[kThird[a][j][k]];
  }
  return f;
}

// P at u.
HWY_INLINE Lanes value_at(const Model& m, Lanes x, Lanes y, Lanes z) {
  const auto& c = m.c;
  return c[k1] +
         x * (c[kX] + x * (c[kXX] + x * c[kXXX] + y * c[kXXY] + z * c[kXXZ]) +
              y * (c[kXY] + y * c[kXYY] + z * c[kXYZ]) + z * (c[kXZ] + z * c[kXZZ])) +
         y * (c[kY] + y * (c[kYY] + y * c[kYYY] + z * c[kYYZ]) + z * (c[kYZ] + z * c[kYZZ])) +
         z * (c[kZ] + z * (c[kZZ] + z * c[kZZZ]));
}

// Disjoint lanes; those in none are undecided.
struct Decided {
  LaneMask empty, connected, full;
  LaneMask any_of() const { return empty | connected | full; }
};

// The cascade on the lanes `active`. Axes in `free_axes` extend; `signs` is what is known already,
// and gets to hold what is found out. A face knows its cell's signs.
Decided classify(const Model& m, unsigned free_axes, LaneMask active, Signs& signs) {
  const Lanes zero(0.0);
  Decided d;
  {
    const Range r = plain_range(m);
    d = {active & (r.hi < zero), no_lanes(), active & (r.lo >= zero)};
  }
  LaneMask open = without(active, d.any_of());
  if (!any(open)) return d;
  LaneMask all_known = open, none_known = open;
  for (int axis = 0; axis < 3; ++axis) {
    if ((free_axes >> axis & 1u) == 0) continue;
    if (const LaneMask missing = without(open, signs.known(axis)); any(missing)) {
      const Range slope = gradient_range(m, axis);
      signs.positive[axis] = signs.positive[axis] | (missing & (slope.lo >= zero));
      signs.negative[axis] = signs.negative[axis] | (missing & (slope.hi <= zero));
    }
    all_known = all_known & signs.known(axis);
    none_known = without(none_known, signs.known(axis));
  }
  if (any(all_known)) {
    // F is largest in one corner and smallest in the opposite one.
    Lanes u[3];
    for (int axis = 0; axis < 3; ++axis)
      u[axis] = (free_axes >> axis & 1u) == 0
                    ? zero
                    : select(signs.positive[axis], m.half[axis], -m.half[axis]);
    const Lanes top = value_at(m, u[0], u[1], u[2]), low = value_at(m, -u[0], -u[1], -u[2]);
    const LaneMask empty = all_known & (top + m.value_error < zero);
    const LaneMask full = all_known & (low - m.value_error >= zero);
    const LaneMask connected = without(all_known & (top - m.value_error >= zero), full);
    d = {d.empty | empty, d.connected | connected, d.full | full};
    open = without(open, all_known);
  }
  none_known = none_known & open;
  if (any(none_known)) {
    const Range r = bernstein_range(m);
    d.empty = d.empty | (none_known & (r.hi < zero));
    d.full = d.full | (none_known & (r.lo >= zero));
    open = without(open, none_known);
  }
  for (int axis = 0; axis < 3 && any(open); ++axis) {
    if ((free_axes >> axis & 1u) == 0) continue;
    const LaneMask here = open & signs.known(axis);
    if (!any(here)) continue;
    const Lanes towards = select(signs.positive[axis], m.half[axis], -m.half[axis]);
    Signs of_face = signs;
    const Decided face =
        classify(on_face(m, axis, towards), free_axes & ~(1u << axis), here, of_face);
    d.empty = d.empty | face.empty;
    LaneMask full = face.full;
    if (any(full)) {
      // Full as well if F is not negative where it is smallest.
      const Model opposite = on_face(m, axis, -towards);
      const Range plain = plain_range(opposite);
      const LaneMask unclear = full & (plain.lo < zero) & (plain.hi >= zero);
      LaneMask sure = full & (plain.lo >= zero);
      if (any(unclear)) sure = sure | (unclear & (bernstein_range(opposite).lo >= zero));
      full = full & sure;
    }
    d.full = d.full | full;
    d.connected = d.connected | face.connected | without(face.full, full);
    open = without(open, face.any_of());
  }
  return d;
}

Model load(const ModelBatch& batch, std::size_t first) {
  Model m;
  LaneMask sound = Lanes(0.0) <= Lanes(0.0);
  for (int i = 0; i < kCount; ++i) {
    m.c[i] = Lanes::load(batch.c[i] + first);
    // One comparison a number rather than a maximum, which could lose a NaN.
    sound = sound & (absolute(m.c[i]) <= Lanes(kHuge));
  }
  for (int i = 0; i < 3; ++i) {
    m.half[i] = Lanes::load(batch.half[i] + first);
    m.gradient_error[i] = Lanes::load(batch.gradient_error[i] + first);
    sound = sound & (m.half[i] <= Lanes(kWide));
  }
  m.value_error = Lanes::load(batch.value_error + first);
  const Lanes infinity(std::numeric_limits<double>::infinity());
  for (Lanes& c : m.c) c = where(sound, c);
  for (Lanes& h : m.half) h = where(sound, h);
  m.value_error = select(sound & (m.value_error <= Lanes(kHuge)), m.value_error, infinity);
  for (Lanes& e : m.gradient_error) e = select(sound & (e <= Lanes(kHuge)), e, infinity);
  return m;
}

Signs nothing_known() {
  const LaneMask none = no_lanes();
  return {{none, none, none}, {none, none, none}};
}

unsigned content_of(const Decided& d, std::size_t lane) {
  if (bits_of(d.empty) >> lane & 1u) return static_cast<unsigned>(Content::kEmpty);
  if (bits_of(d.connected) >> lane & 1u) return static_cast<unsigned>(Content::kConnected);
  if (bits_of(d.full) >> lane & 1u) return static_cast<unsigned>(Content::kFull);
  return static_cast<unsigned>(Content::kUndecided);
}

void classify_cells(const ModelBatch& batch, unsigned wanted, BatchContent& out) {
  for (std::size_t first = 0; first < ModelBatch::kSize; first += Lanes::count()) {
    const unsigned here = wanted >> first & ((1u << Lanes::count()) - 1u);
    if (here == 0) continue;
    Signs signs = nothing_known();
    const Decided d = classify(load(batch, first), 7u, lanes_of(here), signs);
    for (std::size_t i = 0; i < Lanes::count(); ++i)
      if (here >> i & 1u) out.cell[first + i] = static_cast<Content>(content_of(d, i));
  }
}

void classify_faces(const ModelBatch& batch, unsigned wanted, BatchContent& out) {
  for (std::size_t first = 0; first < ModelBatch::kSize; first += Lanes::count()) {
    const unsigned here = wanted >> first & ((1u << Lanes::count()) - 1u);
    if (here == 0) continue;
    const Model m = load(batch, first);
    const LaneMask active = lanes_of(here);
    // Signs on the cell hold on its faces.
    Signs signs = nothing_known();
    for (int axis = 0; axis < 3; ++axis) {
      const Range slope = gradient_range(m, axis);
      signs.positive[axis] = slope.lo >= Lanes(0.0);
      signs.negative[axis] = without(slope.hi <= Lanes(0.0), signs.positive[axis]);
    }
    std::uint16_t faces[ModelBatch::kSize] = {};
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        Signs of_face = signs;
        const Model face = on_face(m, axis, side == 0 ? -m.half[axis] : m.half[axis]);
        const Decided d = classify(face, 7u & ~(1u << axis), active, of_face);
        for (std::size_t i = 0; i < Lanes::count(); ++i)
          faces[i] =
              static_cast<std::uint16_t>(faces[i] | content_of(d, i) << (2 * (2 * axis + side)));
      }
    for (std::size_t i = 0; i < Lanes::count(); ++i)
      if (here >> i & 1u) out.faces[first + i] = faces[i];
  }
}

// LocalModel::add_rounding, on sums.
void add_batches(ModelBatch& a, const ModelBatch& b) {
  for (std::size_t i = 0; i < ModelBatch::kSize; i += Lanes::count()) {
    Lanes c[kCount], h[3], gradient[3];
    for (int n = 0; n < kCount; ++n) {
      c[n] = Lanes::load(a.c[n] + i) + Lanes::load(b.c[n] + i);
      c[n].store(a.c[n] + i);
    }
    for (int n = 0; n < 3; ++n) h[n] = Lanes::load(a.half[n] + i);
    Lanes value = absolute(c[k1]), hessian(0.0);
    for (int n = 0; n < 3; ++n) {
      Lanes g = absolute(c[kX + n]);
      for (int j = 0; j < 3; ++j) {
        Lanes s = Lanes(2.0) * absolute(c[kSecond[n][j]]);
        for (int k = 0; k < 3; ++k) s += Lanes(6.0) * absolute(c[kThird[n][j][k]]) * h[k];
        hessian = maximum(hessian, s);
        g += s * h[j];
      }
      gradient[n] = g;
      value += g * h[n];
    }
    const auto finish = [&](double* own, const double* other, Lanes size) {
      const Lanes error = Lanes::load(own + i) + Lanes::load(other + i);
      (error + (Lanes(kSlack) * (size + error) + Lanes(kUnderflow))).store(own + i);
    };
    finish(a.value_error, b.value_error, value);
    for (int n = 0; n < 3; ++n) finish(a.gradient_error[n], b.gradient_error[n], gradient[n]);
    finish(a.hessian_error, b.hessian_error, hessian);
  }
}

}  // namespace
}  // namespace morsel::topology::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>

namespace morsel::topology {

HWY_EXPORT(classify_cells);
HWY_EXPORT(classify_faces);
HWY_EXPORT(add_batches);

void classify_batch(const ModelBatch& models, unsigned wanted, BatchContent& out) {
  HWY_DYNAMIC_DISPATCH(classify_cells)(models, wanted, out);
}

void classify_batch_faces(const ModelBatch& models, unsigned wanted, BatchContent& out) {
  HWY_DYNAMIC_DISPATCH(classify_faces)(models, wanted, out);
}

void ModelBatch::add(const ModelBatch& other) { HWY_DYNAMIC_DISPATCH(add_batches)(*this, other); }

void ModelBatch::start(const Box& parent) {
  constexpr double kEpsilon = 0x1p-52;
  *this = {};
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < kSize; ++i) {
      const Box box = child_box(parent, i);
      const double middle = topology::centre(box)[axis], lo = box.min[axis], hi = box.max[axis];
      const double reach = std::max(hi - middle, middle - lo);
      // Exact for the dyadic boxes of the topology stage: then no widening is needed.
      const bool exact = hi - middle == middle - lo && middle + reach == hi && middle - reach == lo;
      centre[axis][i] = middle;
      half[axis][i] = exact ? reach : reach * (1.0 + 4.0 * kEpsilon);
    }
  }
}

LocalModel ModelBatch::operator[](int i) const {
  LocalModel m;
  for (int n = 0; n < monomial::kCount; ++n) m.c[static_cast<std::size_t>(n)] = c[n][i];
  for (int axis = 0; axis < 3; ++axis) {
    m.centre[axis] = centre[axis][i];
    m.half[axis] = half[axis][i];
    m.gradient_error[axis] = gradient_error[axis][i];
  }
  m.value_error = value_error[i];
  m.hessian_error = hessian_error[i];
  return m;
}

void ModelBatch::set(int i, const LocalModel& m) {
  for (int n = 0; n < monomial::kCount; ++n) c[n][i] = m.c[static_cast<std::size_t>(n)];
  for (int axis = 0; axis < 3; ++axis) {
    centre[axis][i] = m.centre[axis];
    half[axis][i] = m.half[axis];
    gradient_error[axis][i] = m.gradient_error[axis];
  }
  value_error[i] = m.value_error;
  hessian_error[i] = m.hessian_error;
}

}  // namespace morsel::topology
#endif
