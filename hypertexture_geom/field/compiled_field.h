// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstddef>
#include <memory>
#include <utility>

#include "hypertexture_geom/field/tape.h"
#include "topology/box.h"
#include "topology/scalar_field.h"

namespace morsel::geom {

// F on a box, made for evaluating it fast: only the terms that reach the box, their constants next
// to one another relative to the box's centre, run by the widest vectors of the machine (Highway
// picks at run time). T is float or double. Immutable; every method may be called from several
// threads at once.
//
// Points are given by their coordinates relative to centre(), exactly as numbers of type T; what
// rounding an absolute position to them costs is the caller's. They must be in the box. Batches are
// evaluated a vector of points at a time, single points with eight terms in a vector.
//
// Guaranteed, rounding and flush-to-zero included, at every point of the box:
//   |value - F| <= value_error(),  |gradient_i - dF/dx_i| <= gradient_error()[i].
// Nothing can be proved of a field that is not a Term, whose value() and jet() are called instead:
// there the bounds hold if these keep to ScalarField's convention with an M no larger than what
// model() allows of |F| and of the slopes on the box.
//
// On boxes as wide as the radius of the finest kernel, equation (13) with amplitude 0.8, one layer
// and three, near the origin:
//   float    stated 9e-5 and 1e-4 for the value, 9e-4 and 2.6e-3 for a slope; seen 6e-7
//   double   stated 2e-13 for the value, 2e-12 and 6e-12 for a slope; seen 2e-15
// and no more with Perlin noise, where 1e-6 and 4e-15 are seen. A thousand and a million units away
// the errors in float are the same, while in double those of Perlin noise grow as the spacing of
// coordinates does, a 10^-16th of the distance, times the slope. `compiled_field_test
// --gtest_filter=*ErrorsAreSmall*` prints all of these and fails if they are exceeded. What it
// compares with is another implementation, in long double.
//
// The bounds are infinite where a local model is (a term that can only be evaluated in double
// precision, on a wide box), where a point that a warp moves is too uncertain, and in float where a
// number exceeds 10^12, as squares of distances from an object do that is 10^6 away.
template <class T>
class CompiledField {
 public:
  // `field` itself, if it has to be asked, is kept alive by the caller only while this runs:
  // restrictions are kept here.
  CompiledField(const topology::ScalarField& field, const topology::Box& box);

  // All that it consists of when it does not refer to a field: to be kept elsewhere, and made one
  // of again. A tape that comes from a file has to be looked at first, see tape_check.h.
  struct Parts {
    topology::Box box;
    Imath::V3d centre{0.0};
    double value_error = 0.0;
    Imath::V3d gradient_error{0.0};
    Tape<T> tape;
  };
  explicit CompiledField(Parts parts)
      : box_(parts.box),
        centre_(parts.centre),
        value_error_(parts.value_error),
        gradient_error_(parts.gradient_error),
        tape_(std::move(parts.tape)) {}
  const Tape<T>& tape() const { return tape_; }
  // Some of its terms are evaluated by the field itself, restricted.
  bool refers_to_field() const { return restricted_ != nullptr; }

  const topology::Box& box() const { return box_; }
  const Imath::V3d& centre() const { return centre_; }
  double value_error() const { return value_error_; }
  const Imath::V3d& gradient_error() const { return gradient_error_; }

  // F at `count` points with coordinates x[0][i], x[1][i], x[2][i].
  void values(const T* const (&x)[3], std::size_t count, T* value) const {
    run_tape<T>(tape_, x, count, value, nullptr);
  }
  // F and its gradient: gradient[axis][i].
  void gradients(const T* const (&x)[3], std::size_t count, T* value,
                 T* const (&gradient)[3]) const {
    run_tape<T>(tape_, x, count, value, gradient);
  }
  T value(const Imath::Vec3<T>& x) const {
    const T* const p[3] = {&x.x, &x.y, &x.z};
    T v;
    values(p, 1, &v);
    return v;
  }
  T value_and_gradient(const Imath::Vec3<T>& x, Imath::Vec3<T>& gradient) const {
    const T* const p[3] = {&x.x, &x.y, &x.z};
    T* const g[3] = {&gradient.x, &gradient.y, &gradient.z};
    T v;
    gradients(p, 1, &v, g);
    return v;
  }

  // Memory in use, this object included; not that of fields that are evaluated in double precision.
  std::size_t bytes() const;

 private:
  topology::Box box_;
  Imath::V3d centre_;
  double value_error_ = 0.0;
  Imath::V3d gradient_error_{0.0};
  Tape<T> tape_;
  std::unique_ptr<topology::ScalarField> restricted_;  // if the tape refers to its parts
};

extern template class CompiledField<float>;
extern template class CompiledField<double>;

}  // namespace morsel::geom
