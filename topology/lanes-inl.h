// SPDX-License-Identifier: Apache-2.0
// Vectors of doubles with ordinary operators, for the files that Highway compiles once for each
// instruction set: to be included between <hwy/foreach_target.h> and HWY_BEFORE_NAMESPACE. A batch
// of 8 is worked through in chunks of Lanes::count().
#if defined(MORSEL_TOPOLOGY_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MORSEL_TOPOLOGY_LANES_INL_H_
#undef MORSEL_TOPOLOGY_LANES_INL_H_
#else
#define MORSEL_TOPOLOGY_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace morsel::topology::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using LanesTag = hn::CappedTag<double, 8>;

struct LaneMask {
  hn::Mask<LanesTag> m;
};

struct Lanes {
  using Vector = hn::Vec<LanesTag>;
  Vector v;

  // Without a value: the implicit constructors of what holds Lanes belong to no instruction set,
  // and could not call a constructor that does.
  Lanes() = default;
  HWY_INLINE explicit Lanes(Vector x) : v(x) {}
  HWY_INLINE Lanes(double x)
      : v(hn::Set(LanesTag(), x)) {}  // NOLINT: numbers mix with vectors of numbers
  static constexpr std::size_t count() { return hn::MaxLanes(LanesTag()); }
  static HWY_INLINE Lanes load(const double* p) { return Lanes(hn::LoadU(LanesTag(), p)); }
  HWY_INLINE void store(double* p) const { hn::StoreU(v, LanesTag(), p); }
};

HWY_INLINE Lanes operator+(Lanes a, Lanes b) { return Lanes(hn::Add(a.v, b.v)); }
HWY_INLINE Lanes operator-(Lanes a, Lanes b) { return Lanes(hn::Sub(a.v, b.v)); }
HWY_INLINE Lanes operator*(Lanes a, Lanes b) { return Lanes(hn::Mul(a.v, b.v)); }
HWY_INLINE Lanes operator/(Lanes a, Lanes b) { return Lanes(hn::Div(a.v, b.v)); }
HWY_INLINE Lanes operator-(Lanes a) { return Lanes(hn::Neg(a.v)); }
HWY_INLINE void operator+=(Lanes& a, Lanes b) { a = a + b; }
HWY_INLINE void operator-=(Lanes& a, Lanes b) { a = a - b; }
HWY_INLINE Lanes multiply_add(Lanes a, Lanes b, Lanes c) {
  return Lanes(hn::MulAdd(a.v, b.v, c.v));
}
HWY_INLINE Lanes absolute(Lanes a) { return Lanes(hn::Abs(a.v)); }
HWY_INLINE Lanes minimum(Lanes a, Lanes b) { return Lanes(hn::Min(a.v, b.v)); }
HWY_INLINE Lanes maximum(Lanes a, Lanes b) { return Lanes(hn::Max(a.v, b.v)); }
HWY_INLINE Lanes square_root(Lanes a) { return Lanes(hn::Sqrt(a.v)); }
HWY_INLINE LaneMask operator<(Lanes a, Lanes b) { return {hn::Lt(a.v, b.v)}; }
HWY_INLINE LaneMask operator<=(Lanes a, Lanes b) { return {hn::Le(a.v, b.v)}; }
HWY_INLINE LaneMask operator>(Lanes a, Lanes b) { return {hn::Gt(a.v, b.v)}; }
HWY_INLINE LaneMask operator>=(Lanes a, Lanes b) { return {hn::Ge(a.v, b.v)}; }
HWY_INLINE LaneMask operator&(LaneMask a, LaneMask b) { return {hn::And(a.m, b.m)}; }
HWY_INLINE LaneMask operator|(LaneMask a, LaneMask b) { return {hn::Or(a.m, b.m)}; }
// a and not b.
HWY_INLINE LaneMask without(LaneMask a, LaneMask b) { return {hn::AndNot(b.m, a.m)}; }
HWY_INLINE bool any(LaneMask m) { return !hn::AllFalse(LanesTag(), m.m); }
HWY_INLINE Lanes select(LaneMask m, Lanes yes, Lanes no) {
  return Lanes(hn::IfThenElse(m.m, yes.v, no.v));
}
HWY_INLINE Lanes where(LaneMask m, Lanes yes) { return Lanes(hn::IfThenElseZero(m.m, yes.v)); }
HWY_INLINE LaneMask no_lanes() { return Lanes(0.0) < Lanes(0.0); }
// Bit i of `bits` for lane i.
HWY_INLINE LaneMask lanes_of(unsigned bits) {
  std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
  return {hn::LoadMaskBits(LanesTag(), bytes)};
}
HWY_INLINE unsigned bits_of(LaneMask m) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(LanesTag(), m.m, bytes);
  return bytes[0];
}

}  // namespace morsel::topology::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
