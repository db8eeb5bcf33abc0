// SPDX-License-Identifier: Apache-2.0
// The interpreter of tapes, compiled by Highway for every instruction set and picked at run time:
// the file is included once for each target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hypertexture_geom/field/tape_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <algorithm>
#include <type_traits>

#include "hypertexture_geom/field/integer_hash.h"
#include "hypertexture_geom/field/perlin_lattice.h"
#include "hypertexture_geom/field/tape.h"

HWY_BEFORE_NAMESPACE();
namespace morsel::geom::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMostLanes = 16;
constexpr std::size_t kChunk = 64;          // points that go through the tape together
constexpr std::size_t kFileOnStack = 8192;  // numbers in the register file before it is allocated

// The components of Perlin's directions, one table each.
struct DirectionBytes {
  std::uint8_t of[3][16] = {};
  constexpr DirectionBytes() {
    for (int n = 0; n < kPerlinDirections; ++n)
      for (int a = 0; a < 3; ++a)
        of[a][n] = static_cast<std::uint8_t>(static_cast<int>(kPerlinDirection[n][a]) & 255);
  }
};

// One chunk of points on its way through a tape, in vectors of at most kLanes points: of one where
// there is one point, as roots and quotients of wide vectors take longer than a number's. With
// kGradient, registers are a value and three derivatives, else a value.
template <class T, bool kGradient, std::size_t kLanes>
class Machine {
 public:
  using D = hn::CappedTag<T, kLanes>;
  using V = hn::Vec<D>;

  Machine(const Tape<T>& tape, T* file, std::size_t stride, const T* const (&x)[3],
          std::size_t points)
      : tape_(tape), file_(file), stride_(stride), points_(points), x_{x[0], x[1], x[2]} {}

  T* reg(std::uint16_t r, int component = 0) const {
    return file_ +
           (static_cast<std::size_t>(r) * kComponents + static_cast<std::size_t>(component)) *
               stride_;
  }

  void run() const {
    for (const TapeInstruction& in : tape_.instructions) {
      const T* c = tape_.constants.data() + in.constants;
      switch (in.op) {
        case TapeOp::kConstant:
          constant(in, c);
          break;
        case TapeOp::kLinear:
          linear(in, c);
          break;
        case TapeOp::kSquares:
          squares(in, c);
          break;
        case TapeOp::kImpulses:
          impulses(in, c);
          break;
        case TapeOp::kProcess:
          process(in, c);
          break;
        case TapeOp::kPerlin:
          perlin(in, c);
          break;
        case TapeOp::kPerlinHash:
          perlin_hash(in, c);
          break;
        case TapeOp::kOpaque:
          opaque(in);
          break;
        case TapeOp::kMultiplyAdd:
          multiply_add(in, c);
          break;
        case TapeOp::kAdd:
          add(in);
          break;
        case TapeOp::kMultiply:
          multiply(in);
          break;
        case TapeOp::kRoot:
          root(in, c);
          break;
        case TapeOp::kSmoothAbs:
          smooth_abs(in, c);
          break;
        case TapeOp::kSoftSign:
          soft_sign(in, c);
          break;
        case TapeOp::kSmoothStep:
          smooth_step(in);
          break;
      }
    }
  }

 private:
  static constexpr int kComponents = kGradient ? 4 : 1;

  static V set(T value) { return hn::Set(D(), value); }
  static V load(const T* p) { return hn::LoadU(D(), p); }
  static void store(V v, T* p) { hn::StoreU(v, D(), p); }

  template <class F>
  void for_vectors(const F& f) const {
    const std::size_t lanes = hn::Lanes(D());
    for (std::size_t i = 0; i < points_; i += lanes) f(i);
  }

  V coordinate(const TapeInstruction& in, int axis, std::size_t i) const {
    return load((in.point[axis] == TapeInstruction::kInput ? x_[axis] : reg(in.point[axis])) + i);
  }

  // Stores derivatives with respect to the instruction's own point: by the chain rule where that
  // point is not the input.
  void store_gradient(const TapeInstruction& in, std::size_t i, V gx, V gy, V gz) const {
    if (in.point[0] == TapeInstruction::kInput) {
      store(gx, reg(in.out, 1) + i);
      store(gy, reg(in.out, 2) + i);
      store(gz, reg(in.out, 3) + i);
      return;
    }
    for (int k = 1; k <= 3; ++k) {
      const V sum = hn::MulAdd(gz, load(reg(in.point[2], k) + i),
                               hn::MulAdd(gy, load(reg(in.point[1], k) + i),
                                          hn::Mul(gx, load(reg(in.point[0], k) + i))));
      store(sum, reg(in.out, k) + i);
    }
  }

  // phi(a) with phi' = slope.
  void store_composed(const TapeInstruction& in, std::size_t i, V value, V slope) const {
    if constexpr (kGradient)
      for (int k = 1; k <= 3; ++k)
        store(hn::Mul(slope, load(reg(in.a, k) + i)), reg(in.out, k) + i);
    store(value, reg(in.out) + i);
  }

  void constant(const TapeInstruction& in, const T* c) const {
    for_vectors([&](std::size_t i) {
      store(set(c[0]), reg(in.out) + i);
      if constexpr (kGradient)
        for (int k = 1; k <= 3; ++k) store(set(T(0)), reg(in.out, k) + i);
    });
  }

  void linear(const TapeInstruction& in, const T* c) const {
    for_vectors([&](std::size_t i) {
      const V sum = hn::MulAdd(set(c[0]), coordinate(in, 0, i),
                               hn::MulAdd(set(c[1]), coordinate(in, 1, i),
                                          hn::MulAdd(set(c[2]), coordinate(in, 2, i), set(c[3]))));
      if constexpr (kGradient) store_gradient(in, i, set(c[0]), set(c[1]), set(c[2]));
      store(sum, reg(in.out) + i);
    });
  }

  void squares(const TapeInstruction& in, const T* c) const {
    for_vectors([&](std::size_t i) {
      const V x = coordinate(in, 0, i), y = coordinate(in, 1, i), z = coordinate(in, 2, i);
      V sum = set(c[12]), gx = set(T(0)), gy = gx, gz = gx;
      for (int k = 0; k < 3; ++k) {
        const T* r = c + 4 * k;
        const V u =
            hn::MulAdd(set(r[0]), x, hn::MulAdd(set(r[1]), y, hn::MulAdd(set(r[2]), z, set(r[3]))));
        sum = hn::MulAdd(u, u, sum);
        if constexpr (kGradient) {
          const V twice = hn::Add(u, u);
          gx = hn::MulAdd(twice, set(r[0]), gx);
          gy = hn::MulAdd(twice, set(r[1]), gy);
          gz = hn::MulAdd(twice, set(r[2]), gz);
        }
      }
      if constexpr (kGradient) store_gradient(in, i, gx, gy, gz);
      store(sum, reg(in.out) + i);
    });
  }

  // Sums of w q^3 and, for the gradient, of w s q^2 (x - centre).
  struct ImpulseSums {
    V value, gx, gy, gz;
  };
  template <class DD, class VV, class Sums>
  static void add_impulse(DD d, VV dx, VV dy, VV dz, VV s, VV w, Sums& sums) {
    const auto square = hn::MulAdd(dz, dz, hn::MulAdd(dy, dy, hn::Mul(dx, dx)));
    const auto q = hn::Max(hn::Zero(d), hn::NegMulAdd(square, s, hn::Set(d, T(1))));
    const auto wqq = hn::Mul(hn::Mul(w, q), q);
    sums.value = hn::MulAdd(wqq, q, sums.value);
    if constexpr (kGradient) {
      const auto g = hn::Mul(wqq, s);
      sums.gx = hn::MulAdd(g, dx, sums.gx);
      sums.gy = hn::MulAdd(g, dy, sums.gy);
      sums.gz = hn::MulAdd(g, dz, sums.gz);
    }
  }

  void impulses(const TapeInstruction& in, const T* c) const {
    if (points_ == 1) return impulses_across_lanes(in, c);
    constexpr std::size_t kB = kTapeBlock;
    const std::size_t lanes = hn::Lanes(D());
    const V zero = hn::Zero(D()), six = set(T(-6));
    const auto sums_of = [&](const T* block, std::size_t k, V x, V y, V z, ImpulseSums& sums) {
      add_impulse(D(), hn::Sub(x, set(block[k])), hn::Sub(y, set(block[kB + k])),
                  hn::Sub(z, set(block[2 * kB + k])), set(block[3 * kB + k]),
                  set(block[4 * kB + k]), sums);
    };
    const auto finish = [&](std::size_t i, const ImpulseSums& sums) {
      if constexpr (kGradient)
        store_gradient(in, i, hn::Mul(six, sums.gx), hn::Mul(six, sums.gy), hn::Mul(six, sums.gz));
      store(sums.value, reg(in.out) + i);
    };
    // Two vectors at a time, so that loads and broadcasts are shared.
    std::size_t i = 0;
    for (; i + lanes < points_; i += 2 * lanes) {
      const V x = coordinate(in, 0, i), y = coordinate(in, 1, i), z = coordinate(in, 2, i);
      const V x2 = coordinate(in, 0, i + lanes), y2 = coordinate(in, 1, i + lanes),
              z2 = coordinate(in, 2, i + lanes);
      ImpulseSums sums{zero, zero, zero, zero}, sums2{zero, zero, zero, zero};
      for (std::size_t b = 0; b < in.count; ++b)
        for (std::size_t k = 0; k < kB; ++k) {
          sums_of(c + b * 5 * kB, k, x, y, z, sums);
          sums_of(c + b * 5 * kB, k, x2, y2, z2, sums2);
        }
      finish(i, sums);
      finish(i + lanes, sums2);
    }
    if (i >= points_) return;
    const V x = coordinate(in, 0, i), y = coordinate(in, 1, i), z = coordinate(in, 2, i);
    ImpulseSums sums{zero, zero, zero, zero};
    for (std::size_t b = 0; b < in.count; ++b)
      for (std::size_t k = 0; k < kB; ++k) sums_of(c + b * 5 * kB, k, x, y, z, sums);
    finish(i, sums);
  }

  // One point, an impulse in every lane.
  void impulses_across_lanes(const TapeInstruction& in, const T* c) const {
    using L = hn::CappedTag<T, kTapeBlock>;
    const L d;
    const std::size_t lanes = hn::Lanes(d);
    const auto x = hn::Set(d, first_coordinate(in, 0)), y = hn::Set(d, first_coordinate(in, 1)),
               z = hn::Set(d, first_coordinate(in, 2)), zero = hn::Zero(d);
    struct {
      hn::Vec<L> value, gx, gy, gz;
    } sums{zero, zero, zero, zero};
    constexpr std::size_t kB = kTapeBlock;
    for (std::size_t b = 0; b < in.count; ++b)
      for (std::size_t k = 0; k < kB; k += lanes) {
        const T* p = c + b * 5 * kB + k;
        add_impulse(d, hn::Sub(x, hn::LoadU(d, p)), hn::Sub(y, hn::LoadU(d, p + kB)),
                    hn::Sub(z, hn::LoadU(d, p + 2 * kB)), hn::LoadU(d, p + 3 * kB),
                    hn::LoadU(d, p + 4 * kB), sums);
      }
    const auto total = [&](hn::Vec<L> v) { return set(hn::GetLane(hn::SumOfLanes(d, v))); };
    if constexpr (kGradient) {
      const V six = set(T(-6));
      store_gradient(in, 0, hn::Mul(six, total(sums.gx)), hn::Mul(six, total(sums.gy)),
                     hn::Mul(six, total(sums.gz)));
    }
    store(total(sums.value), reg(in.out));
  }

  T first_coordinate(const TapeInstruction& in, int axis) const {
    return *(in.point[axis] == TapeInstruction::kInput ? x_[axis] : reg(in.point[axis]));
  }

  // Hashing is done with 32-bit lanes, for T = float.
  using DU = hn::RebindToUnsigned<hn::CappedTag<float, kLanes>>;
  using VU = hn::Vec<DU>;
  static VU word(std::uint32_t w) { return hn::Set(DU(), w); }
  static VU scramble_lanes(VU h) {  // as scramble() of integer_hash.h
    h = hn::Xor(h, hn::ShiftRight<16>(h));
    h = hn::Mul(h, word(0x21f0aaadu));
    h = hn::Xor(h, hn::ShiftRight<15>(h));
    h = hn::Mul(h, word(0x735a2d97u));
    return hn::Xor(h, hn::ShiftRight<15>(h));
  }
  // h / 2^32 without its lowest 8 bits.
  static V fraction(VU h) {
    const hn::RebindToSigned<DU> di;
    const auto upper = hn::BitCast(di, hn::ShiftRight<8>(h));
    return hn::Mul(hn::ConvertTo(D(), upper), set(T(0x1p-24)));
  }

  void process(const TapeInstruction& in, const T* c) const {
    if constexpr (std::is_same_v<T, float>) {
      const std::int32_t* w = tape_.words.data() + in.words;
      const hn::RebindToSigned<DU> di;
      for_vectors([&](std::size_t i) {
        V t[3];
        VU cell[3];
        for (int a = 0; a < 3; ++a) {
          const V q = hn::MulAdd(set(c[0]), coordinate(in, a, i), set(c[1 + a]));
          const V corner = hn::Floor(q);
          t[a] = hn::Sub(q, corner);
          cell[a] = hn::Add(hn::BitCast(DU(), hn::ConvertTo(di, corner)),
                            word(static_cast<std::uint32_t>(w[a])));
        }
        const V zero = hn::Zero(D()), one = set(T(1));
        ImpulseSums sums{zero, zero, zero, zero};
        const VU key = word(static_cast<std::uint32_t>(w[3]));
        for (int ci = -1; ci <= 1; ++ci) {
          const VU hi =
              scramble_lanes(hn::Add(key, hn::Add(cell[0], word(static_cast<std::uint32_t>(ci)))));
          const V tx = hn::Sub(t[0], set(T(ci)));
          for (int cj = -1; cj <= 1; ++cj) {
            const VU hj = scramble_lanes(
                hn::Xor(hi, hn::Mul(hn::Add(cell[1], word(static_cast<std::uint32_t>(cj))),
                                    word(0x85ebca6bu))));
            const V ty = hn::Sub(t[1], set(T(cj)));
            for (int ck = -1; ck <= 1; ++ck) {
              const VU hk = scramble_lanes(
                  hn::Add(hj, hn::Mul(hn::Add(cell[2], word(static_cast<std::uint32_t>(ck))),
                                      word(0xc2b2ae35u))));
              const V tz = hn::Sub(t[2], set(T(ck)));
              for (int n = 0; n < w[4]; ++n) {
                const VU h = scramble_lanes(hn::Xor(hk, word(static_cast<std::uint32_t>(n))));
                const V dx = hn::Sub(tx, fraction(scramble_lanes(hn::Add(h, word(0x68bc21ebu)))));
                const V dy = hn::Sub(ty, fraction(scramble_lanes(hn::Add(h, word(0x02e5be93u)))));
                const V dz = hn::Sub(tz, fraction(scramble_lanes(hn::Add(h, word(0x967a889bu)))));
                const V weight = hn::MulSub(
                    set(T(2)), fraction(scramble_lanes(hn::Add(h, word(0xb5297a4du)))), one);
                add_impulse(D(), dx, dy, dz, one, weight, sums);
              }
            }
          }
        }
        const V scale = set(c[4]);
        if constexpr (kGradient) {
          const V outer = set(T(-6) * c[4] * c[0]);
          store_gradient(in, i, hn::Mul(outer, sums.gx), hn::Mul(outer, sums.gy),
                         hn::Mul(outer, sums.gz));
        }
        store(hn::Mul(scale, sums.value), reg(in.out) + i);
      });
    }
  }

  // 32-bit integers, as many as DF has lanes.
  template <class DF>
  using Integers = hn::Rebind<std::int32_t, DF>;
  using DI = Integers<D>;
  using VI = hn::Vec<DI>;
  template <class DF>
  static hn::Vec<Integers<DF>> to_integers(DF, hn::Vec<DF> v) {
    if constexpr (sizeof(T) == 4)
      return hn::ConvertTo(Integers<DF>(), v);
    else
      return hn::DemoteTo(Integers<DF>(), v);
  }
  template <class DF>
  static hn::Vec<DF> from_integers(DF, hn::Vec<Integers<DF>> v) {
    if constexpr (sizeof(T) == 4)
      return hn::ConvertTo(DF(), v);
    else
      return hn::PromoteTo(DF(), v);
  }

  // Perlin's directions of these indices (0 to 11).
  template <class DF>
  static void directions(DF, hn::Vec<Integers<DF>> index, hn::Vec<DF> (&e)[3]) {
#if HWY_TARGET == HWY_SCALAR
    for (int a = 0; a < 3; ++a)
      e[a] = hn::Set(DF(), static_cast<T>(kPerlinDirection[hn::GetLane(index)][a]));
#else
    // A table of 16 bytes for each component, looked up in the highest byte of each lane, from
    // where a shift extends the sign.
    static constexpr DirectionBytes kTable;
    using D8 = hn::Repartition<std::uint8_t, Integers<DF>>;
    const auto top = hn::BitCast(D8(), hn::ShiftLeft<24>(index));
    const auto look_up = [&](const std::uint8_t* table) {
      if constexpr (hn::MaxLanes(D8()) >= 16)
        return hn::TableLookupBytes(hn::LoadDup128(D8(), table), top);
      else
        return hn::TableLookupBytes(hn::LoadU(hn::Full128<std::uint8_t>(), table), top);
    };
    for (int a = 0; a < 3; ++a)
      e[a] = from_integers(DF(),
                           hn::ShiftRight<24>(hn::BitCast(Integers<DF>(), look_up(kTable.of[a]))));
#endif
  }

  // Perlin's interpolation between the corners of a cell that t is in, the gradient at a corner
  // being corner(c) as three vectors: value and derivatives with respect to t.
  struct PerlinSums {
    V value, g[3];
  };
  template <class Corner>
  static PerlinSums perlin_cell(const V (&t)[3], const Corner& corner) {
    const V one = set(T(1)), zero = hn::Zero(D());
    V fade[3], slope[3], s[3];
    for (int a = 0; a < 3; ++a) {
      const V q = hn::MulAdd(t[a], hn::MulAdd(t[a], set(T(6)), set(T(-15))), set(T(10)));
      fade[a] = hn::Mul(hn::Mul(t[a], t[a]), hn::Mul(t[a], q));
      s[a] = hn::Sub(t[a], one);
      if constexpr (kGradient) {
        const V rest = hn::Mul(t[a], s[a]);
        slope[a] = hn::Mul(set(T(30)), hn::Mul(rest, rest));
      }
    }
    // Interpolated along x, then y, then z; a vector each for the value and the interpolated
    // gradient.
    V v[8], g[3][8];
    for (int n = 0; n < 8; ++n) {
      V e[3];
      corner(n, e);
      v[n] = hn::MulAdd(e[0], n & 1 ? s[0] : t[0],
                        hn::MulAdd(e[1], n & 2 ? s[1] : t[1], hn::Mul(e[2], n & 4 ? s[2] : t[2])));
      if constexpr (kGradient)
        for (int a = 0; a < 3; ++a) g[a][n] = e[a];
    }
    if constexpr (!kGradient) {
      for (int n = 0; n < 8; n += 2) v[n] = hn::MulAdd(fade[0], hn::Sub(v[n + 1], v[n]), v[n]);
      for (int n = 0; n < 8; n += 4) v[n] = hn::MulAdd(fade[1], hn::Sub(v[n + 2], v[n]), v[n]);
      return {hn::MulAdd(fade[2], hn::Sub(v[4], v[0]), v[0]), {zero, zero, zero}};
    } else {
      for (int axis = 0; axis < 3; ++axis) {
        const int step = 1 << axis;
        for (int n = 0; n < 8; n += 2 * step) {
          const V difference = hn::Sub(v[n + step], v[n]);
          for (int a = 0; a < 3; ++a)
            g[a][n] = hn::MulAdd(fade[axis], hn::Sub(g[a][n + step], g[a][n]), g[a][n]);
          g[axis][n] = hn::MulAdd(slope[axis], difference, g[axis][n]);
          v[n] = hn::MulAdd(fade[axis], difference, v[n]);
        }
      }
      return {v[0], {g[0][0], g[1][0], g[2][0]}};
    }
  }

  void store_perlin(const TapeInstruction& in, const T* c, std::size_t i,
                    const PerlinSums& n) const {
    if constexpr (kGradient) {
      const V outer = set(c[4] * c[0]);
      store_gradient(in, i, hn::Mul(outer, n.g[0]), hn::Mul(outer, n.g[1]), hn::Mul(outer, n.g[2]));
    }
    store(hn::Mul(set(c[4]), n.value), reg(in.out) + i);
  }

  void perlin(const TapeInstruction& in, const T* c) const {
    if (points_ == 1) return perlin_across_lanes(in, c);
    const std::int32_t* w = tape_.words.data() + in.words;
    const std::int32_t* table = w + 3;
    const std::int32_t stride[3] = {1, w[0], w[0] * w[1]};
    const bool single = w[0] == 1 && w[1] == 1 && w[2] == 1;
    for_vectors([&](std::size_t i) {
      V t[3], place = hn::Zero(D());
      for (int a = 0; a < 3; ++a) {
        t[a] = hn::MulAdd(set(c[0]), coordinate(in, a, i), set(c[1 + a]));
        if (w[a] == 1) continue;
        const V cell = hn::Min(hn::Max(hn::Floor(t[a]), hn::Zero(D())), set(T(w[a] - 1)));
        t[a] = hn::Sub(t[a], cell);
        place = hn::MulAdd(cell, set(T(stride[a])), place);
      }
      if (single) {
        const auto corner = [&](int n, V(&e)[3]) {
          const double* g = kPerlinDirection[corner_of(table[0], n)];
          for (int a = 0; a < 3; ++a) e[a] = set(static_cast<T>(g[a]));
        };
        store_perlin(in, c, i, perlin_cell(t, corner));
        return;
      }
      VI corners = hn::GatherIndex(DI(), table, to_integers(D(), place));
      const auto corner = [&](int, V(&e)[3]) {  // asked for in order
        directions(D(), hn::And(corners, hn::Set(DI(), 15)), e);
        corners = hn::ShiftRight<4>(corners);
      };
      store_perlin(in, c, i, perlin_cell(t, corner));
    });
  }

  static unsigned corner_of(std::int32_t cell, int n) {
    return (static_cast<std::uint32_t>(cell) >> (4 * n)) & 15u;
  }

  // One point, a corner of its cell in every lane.
  void perlin_across_lanes(const TapeInstruction& in, const T* c) const {
    using L = hn::CappedTag<T, 8>;
    const L d;
    const std::int32_t* w = tape_.words.data() + in.words;
    const std::int32_t stride[3] = {1, w[0], w[0] * w[1]};
    T t[3], fade[3], slope[3];
    std::int32_t place = 0;
    for (int a = 0; a < 3; ++a) {
      t[a] = c[0] * first_coordinate(in, a) + c[1 + a];
      // 0 for NaN; what is beyond an int must not be made one.
      const T inside = t[a] > T(0) ? std::min(t[a], static_cast<T>(w[a] - 1)) : T(0);
      const auto cell = static_cast<std::int32_t>(inside);
      t[a] -= static_cast<T>(cell);
      place += cell * stride[a];
      const T rest = t[a] * (T(1) - t[a]);
      fade[a] = t[a] * t[a] * t[a] * (T(10) + t[a] * (T(-15) + T(6) * t[a]));
      slope[a] = T(30) * rest * rest;
    }
    HWY_ALIGN std::int32_t corners[8];
    for (int n = 0; n < 8; ++n) corners[n] = static_cast<std::int32_t>(corner_of(w[3 + place], n));
    static constexpr T kBit[3][8] = {
        {0, 1, 0, 1, 0, 1, 0, 1}, {0, 0, 1, 1, 0, 0, 1, 1}, {0, 0, 0, 0, 1, 1, 1, 1}};
    using VL = hn::Vec<L>;
    VL value = hn::Zero(d), g[3] = {value, value, value};
    for (std::size_t k = 0; k < 8; k += hn::Lanes(d)) {
      VL e[3], weight[3], change[3], dot = hn::Zero(d);
      directions(d, hn::LoadU(Integers<L>(), corners + k), e);
      for (int a = 0; a < 3; ++a) {
        const VL bit = hn::LoadU(d, kBit[a] + k);
        dot = hn::MulAdd(e[a], hn::Sub(hn::Set(d, t[a]), bit), dot);
        weight[a] = hn::MulAdd(hn::Set(d, T(2) * fade[a] - T(1)), bit, hn::Set(d, T(1) - fade[a]));
        change[a] = hn::MulAdd(hn::Set(d, T(2) * slope[a]), bit, hn::Set(d, -slope[a]));
      }
      const VL xy = hn::Mul(weight[0], weight[1]), all = hn::Mul(xy, weight[2]);
      value = hn::MulAdd(all, dot, value);
      if constexpr (kGradient) {
        const VL others[3] = {hn::Mul(weight[1], weight[2]), hn::Mul(weight[0], weight[2]), xy};
        for (int a = 0; a < 3; ++a)
          g[a] = hn::MulAdd(all, e[a], hn::MulAdd(hn::Mul(others[a], change[a]), dot, g[a]));
      }
    }
    const auto total = [&](VL v) { return set(hn::GetLane(hn::SumOfLanes(d, v))); };
    PerlinSums sums{total(value), {set(T(0)), set(T(0)), set(T(0))}};
    if constexpr (kGradient)
      for (int a = 0; a < 3; ++a) sums.g[a] = total(g[a]);
    store_perlin(in, c, 0, sums);
  }

  void perlin_hash(const TapeInstruction& in, const T* c) const {
    if constexpr (std::is_same_v<T, float>) {
      const std::int32_t* w = tape_.words.data() + in.words;
      for_vectors([&](std::size_t i) {
        V t[3];
        VU cell[3];
        for (int a = 0; a < 3; ++a) {
          const V q = hn::MulAdd(set(c[0]), coordinate(in, a, i), set(c[1 + a]));
          const V corner = hn::Floor(q);
          t[a] = hn::Sub(q, corner);
          cell[a] = hn::Add(hn::BitCast(DU(), hn::ConvertTo(DI(), corner)),
                            word(static_cast<std::uint32_t>(w[a])));
        }
        VU hx[2], hy[4];
        for (int n = 0; n < 2; ++n)
          hx[n] = scramble_lanes(hn::Add(word(static_cast<std::uint32_t>(w[3])),
                                         hn::Add(cell[0], word(static_cast<std::uint32_t>(n)))));
        for (int n = 0; n < 4; ++n)
          hy[n] = scramble_lanes(
              hn::Xor(hx[n & 1], hn::Mul(hn::Add(cell[1], word(static_cast<std::uint32_t>(n >> 1))),
                                         word(0x85ebca6bu))));
        store_perlin(
            in, c, i, perlin_cell(t, [&](int n, V(&e)[3]) {
              const VU h = scramble_lanes(hn::Add(
                  hy[n & 3], hn::Mul(hn::Add(cell[2], word(static_cast<std::uint32_t>(n >> 2))),
                                     word(0xc2b2ae35u))));
              // floor(12 h / 2^32) without 64-bit products.
              const VU lower =
                  hn::ShiftRight<16>(hn::Mul(hn::And(h, word(0xffffu)), word(kPerlinDirections)));
              const VU direction = hn::ShiftRight<16>(
                  hn::Add(hn::Mul(hn::ShiftRight<16>(h), word(kPerlinDirections)), lower));
              directions(D(), hn::BitCast(DI(), direction), e);
            }));
      });
    }
  }

  void opaque(const TapeInstruction& in) const {
    const OpaqueField& f = tape_.opaque[in.count];
    HWY_ALIGN T g[3][kLanes] = {};
    const std::size_t lanes = hn::Lanes(D());
    for (std::size_t first = 0; first < points_; first += lanes) {
      for (std::size_t l = 0; l < lanes; ++l) {
        const std::size_t i = std::min(first + l, points_ - 1);
        Imath::V3d x = f.centre;
        for (int a = 0; a < 3; ++a)
          x[a] += (in.point[a] == TapeInstruction::kInput ? x_[a] : reg(in.point[a]))[i];
        if constexpr (kGradient) {
          const topology::Jet jet = f.field->jet(x);
          reg(in.out)[first + l] = static_cast<T>(jet.value);
          for (int a = 0; a < 3; ++a) g[a][l] = static_cast<T>(jet.gradient[a]);
        } else {
          reg(in.out)[first + l] = static_cast<T>(f.field->value(x));
        }
      }
      if constexpr (kGradient) store_gradient(in, first, load(g[0]), load(g[1]), load(g[2]));
    }
  }

  void multiply_add(const TapeInstruction& in, const T* c) const {
    for_vectors([&](std::size_t i) {
      store_composed(in, i, hn::MulAdd(set(c[0]), load(reg(in.a) + i), set(c[1])), set(c[0]));
    });
  }

  void add(const TapeInstruction& in) const {
    for (int k = 0; k < kComponents; ++k)
      for_vectors([&](std::size_t i) {
        store(hn::Add(load(reg(in.a, k) + i), load(reg(in.b, k) + i)), reg(in.out, k) + i);
      });
  }

  void multiply(const TapeInstruction& in) const {
    for_vectors([&](std::size_t i) {
      const V a = load(reg(in.a) + i), b = load(reg(in.b) + i);
      if constexpr (kGradient)
        for (int k = 1; k <= 3; ++k)
          store(hn::MulAdd(a, load(reg(in.b, k) + i), hn::Mul(b, load(reg(in.a, k) + i))),
                reg(in.out, k) + i);
      store(hn::Mul(a, b), reg(in.out) + i);
    });
  }

  void root(const TapeInstruction& in, const T* c) const {
    for_vectors([&](std::size_t i) {
      const V r = hn::Sqrt(hn::Max(load(reg(in.a) + i), set(c[0])));
      store_composed(in, i, r, kGradient ? hn::Div(set(T(0.5)), r) : r);
    });
  }

  void smooth_abs(const TapeInstruction& in, const T* c) const {
    for_vectors([&](std::size_t i) {
      const V t = load(reg(in.a) + i), k = set(c[0]);
      const V r = hn::Sqrt(hn::MulAdd(t, t, hn::Mul(k, k)));
      store_composed(in, i, hn::Mul(t, hn::Div(t, hn::Add(r, k))), kGradient ? hn::Div(t, r) : t);
    });
  }

  void soft_sign(const TapeInstruction& in, const T* c) const {
    for_vectors([&](std::size_t i) {
      const V t = load(reg(in.a) + i), k = set(c[0]);
      const V inverse = hn::Div(set(T(1)), hn::Sqrt(hn::MulAdd(t, t, hn::Mul(k, k))));
      const V part = hn::Mul(k, inverse);
      store_composed(in, i, hn::Mul(t, inverse), hn::Mul(hn::Mul(part, part), inverse));
    });
  }

  void smooth_step(const TapeInstruction& in) const {
    for_vectors([&](std::size_t i) {
      const V one = set(T(1));
      const V t = hn::Min(hn::Max(load(reg(in.a) + i), hn::Zero(D())), one);
      const V q = hn::MulAdd(t, hn::MulAdd(t, set(T(6)), set(T(-15))), set(T(10)));
      const V rest = hn::Mul(t, hn::Sub(one, t));
      store_composed(in, i, hn::Mul(hn::Mul(t, t), hn::Mul(t, q)),
                     hn::Mul(set(T(30)), hn::Mul(rest, rest)));
    });
  }

  const Tape<T>& tape_;
  T* file_;
  std::size_t stride_, points_;
  const T* x_[3];
};

template <class T, bool kGradient>
void run_all(const Tape<T>& tape, const T* const (&x)[3], std::size_t count, T* value,
             T* const* gradient) {
  constexpr std::size_t kComponents = kGradient ? 4 : 1;
  const std::size_t stride = count == 1 ? 1 : kChunk;
  const std::size_t size = tape.registers * kComponents * stride;
  HWY_ALIGN T on_stack[kFileOnStack];
  std::vector<T> allocated;
  T* file = on_stack;
  if (size > kFileOnStack) {
    allocated.resize(size);
    file = allocated.data();
  }
  if (count == 1) {
    const Machine<T, kGradient, 1> machine(tape, file, stride, x, 1);
    machine.run();
    *value = *machine.reg(tape.result);
    if constexpr (kGradient)
      for (int a = 0; a < 3; ++a) *gradient[a] = *machine.reg(tape.result, 1 + a);
    return;
  }
  HWY_ALIGN T padded[3][kChunk];
  for (std::size_t first = 0; first < count; first += kChunk) {
    const std::size_t n = std::min(kChunk, count - first);
    const std::size_t lanes = std::min(kMostLanes, hn::Lanes(hn::CappedTag<T, kMostLanes>()));
    const std::size_t end = (n + lanes - 1) / lanes * lanes;
    const T* in[3];
    for (std::size_t a = 0; a < 3; ++a) {
      in[a] = x[a] + first;
      if (end == n) continue;
      std::copy(in[a], in[a] + n, padded[a]);
      std::fill(padded[a] + n, padded[a] + end, in[a][n - 1]);
      in[a] = padded[a];
    }
    const Machine<T, kGradient, kMostLanes> machine(tape, file, stride, in, n);
    machine.run();
    const T* result = machine.reg(tape.result);
    std::copy(result, result + n, value + first);
    if constexpr (kGradient)
      for (int a = 0; a < 3; ++a) {
        const T* slope = machine.reg(tape.result, 1 + a);
        std::copy(slope, slope + n, gradient[a] + first);
      }
  }
}

void run_float(const Tape<float>& tape, const float* const (&x)[3], std::size_t count, float* value,
               float* const* gradient) {
  if (gradient == nullptr)
    run_all<float, false>(tape, x, count, value, gradient);
  else
    run_all<float, true>(tape, x, count, value, gradient);
}

void run_double(const Tape<double>& tape, const double* const (&x)[3], std::size_t count,
                double* value, double* const* gradient) {
  if (gradient == nullptr)
    run_all<double, false>(tape, x, count, value, gradient);
  else
    run_all<double, true>(tape, x, count, value, gradient);
}

}  // namespace
}  // namespace morsel::geom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace morsel::geom {

HWY_EXPORT(run_float);
HWY_EXPORT(run_double);

template <>
void run_tape(const Tape<float>& tape, const float* const (&x)[3], std::size_t count, float* value,
              float* const* gradient) {
  HWY_DYNAMIC_DISPATCH(run_float)(tape, x, count, value, gradient);
}

template <>
void run_tape(const Tape<double>& tape, const double* const (&x)[3], std::size_t count,
              double* value, double* const* gradient) {
  HWY_DYNAMIC_DISPATCH(run_double)(tape, x, count, value, gradient);
}

}  // namespace morsel::geom
#endif
