// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <vector>

#include "hypertexture_geom/field/impulse_list.h"
#include "hypertexture_geom/field/perlin_lattice.h"
#include "hypertexture_geom/field/sparse_convolution.h"
#include "hypertexture_geom/field/tape.h"
#include "hypertexture_geom/field/term.h"
#include "topology/box.h"
#include "topology/interval.h"
#include "topology/scalar_field.h"

namespace morsel::geom {

class TapeBuilder;

// A value that a tape computes, with what is known of it on the box: enclosures of the exact value
// and slopes, and bounds on how far the computed ones are off.
struct TapeValue {
  TapeBuilder* builder = nullptr;
  std::uint32_t id = 0;
  topology::Interval range;
  topology::Interval slope[3];
  double error = 0.0;
  double slope_error[3] = {};
};

// Writes a tape and proves its errors: each operation takes enclosures and error bounds of its
// operands and returns those of its result, rounding and flush-to-zero included.
class TapeBuilder {
 public:
  // For arithmetic with this unit roundoff (2^-24 or 2^-53).
  TapeBuilder(const topology::Box& box, double unit_roundoff);

  // Where the point is, and the centre that its coordinates are relative to.
  const topology::Box& box() const { return scope_.box; }
  const Imath::V3d& centre() const { return scope_.centre; }
  bool single_precision() const { return unit_ > 0x1p-30; }

  // Any field that is defined on the current box.
  TapeValue field(const topology::ScalarField& f);

  // Functions of the point.
  TapeValue constant(double c);
  TapeValue linear(const Imath::V3d& row, const Imath::V3d& origin);  // row . (x - origin)
  // constant + sum_k (rows[k] . (x - origin))^2
  TapeValue squares(const Imath::V3d (&rows)[3], const Imath::V3d& origin, double constant);
  TapeValue impulses(const ImpulseList& list);
  // One octave of sparse convolution, nowhere above `bound`, whose impulses are hashed at every
  // point. Single precision only.
  TapeValue impulse_process(const SparseConvolutionParameters& parameters, std::uint32_t octave,
                            double bound);
  // One octave of Perlin noise, amplitude n(frequency x + lattice.offset()): from a table of the
  // directions on the box, or, on one that is many cells wide, hashed (single precision only).
  static bool tabulates_perlin(const topology::Box& box, double frequency);
  TapeValue perlin(double amplitude, double frequency, const PerlinLattice& lattice);
  // Evaluated in double precision by the field itself. It is taken to be as accurate as ScalarField
  // has it, where what it is put together from is no larger than its model allows of |F| (and of
  // slopes) on the box, or than `size` (`steepness`).
  TapeValue opaque(const topology::ScalarField& f, double size = 0.0, double steepness = 0.0);

  // Functions of values.
  TapeValue add(const TapeValue& a, const TapeValue& b);
  TapeValue multiply_add(const TapeValue& a, double factor, double summand);
  TapeValue multiply(const TapeValue& a, const TapeValue& b);
  TapeValue root(const TapeValue& a, double least);  // sqrt(a), a >= least > 0
  TapeValue smooth_abs(const TapeValue& a, double k);
  TapeValue soft_sign(const TapeValue& a, double k);
  TapeValue smooth_step(const TapeValue& a);

  // `f` at the point displaced by w, within `box` when computed exactly. When it may be computed to
  // be outside by more than `slack`, beyond which nothing is known of f, no error is guaranteed.
  TapeValue displaced(const TapeValue (&w)[3], const topology::Box& box, double slack,
                      const topology::ScalarField& f);

  // The finished tape that computes `result`.
  template <class T>
  Tape<T> finish(const TapeValue& result) const;

 private:
  // What an instruction at the current point computes, before the chain rule: bounds in terms of
  // that point's own coordinates; `bend` bounds the second derivatives.
  struct Local {
    topology::Interval range, slope[3];
    double error = 0.0, slope_error[3] = {}, bend = 0.0;
  };
  struct Scope {
    topology::Box box;
    Imath::V3d centre{0.0}, reach{0.0};  // |x - centre| <= reach, coordinate by coordinate
    bool is_input = true;
    TapeValue y[3];
  };
  struct Step {
    TapeOp op = TapeOp::kConstant;
    std::uint32_t a = 0, b = 0, point[3] = {};
    int operands = 0;
    bool at_input = true;
    std::size_t constants = 0, words = 0;
    std::uint32_t count = 0;
  };

  static Scope scope_on(const topology::Box& box);
  Step step(TapeOp op) const;
  TapeValue append(const Step& step);
  TapeValue place(const Step& step, const Local& local);
  TapeValue composed(const Step& step, const TapeValue& a, topology::Interval range,
                     topology::Interval slope, double bend, double rounding, double slope_rounding);
  void check(TapeValue& v) const;

  double unit_;
  Scope scope_;
  std::vector<Step> steps_;
  std::vector<double> constants_;
  std::vector<std::int32_t> words_;
  std::vector<OpaqueField> opaque_;
};

}  // namespace morsel::geom
