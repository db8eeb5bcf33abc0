// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <memory>

#include "topology/box.h"
#include "topology/local_model.h"
#include "topology/model_batch.h"

namespace morsel::topology {

// F, its gradient and its Hessian at one point.
struct Jet {
  double value = 0.0;
  Imath::V3d gradient{0.0};
  // Symmetric second derivatives: xx, yy, zz, xy, xz, yz.
  double hessian[6] = {};
};

// How far value() and jet() may be off: see there.
inline constexpr double kFieldAccuracy = 1e-13;

// A scalar field F: R^3 -> R, twice continuously differentiable and finite. Its surface is F = 0
// and its solid is S = {F >= 0}. This is all that topology knows of a field. Fields are immutable;
// every method may be called from several threads at once.
//
// Proofs of topology rest on model() alone, whose bounds include rounding. value() and jet() give
// the numbers of ordinary floating point, without a bound of their own; what relies on their
// accuracy relies on the convention stated with them, which implementations are to keep.
class ScalarField {
 public:
  virtual ~ScalarField() = default;

  // F at `x`: within kFieldAccuracy (1 + M) of F at some point whose coordinates are at most four
  // units in the last place from those of x, where M is the size of the largest number that F is
  // put together from there (without cancellation, |F| itself).
  virtual double value(const Imath::V3d& x) const = 0;

  // F with first and second derivatives at `x`. The value as value()'s, though perhaps rounded
  // otherwise; each slope likewise with M the largest slope that it is put together from. Second
  // derivatives: to within rounding, no figure is promised.
  virtual Jet jet(const Imath::V3d& x) const = 0;

  // A cubic polynomial about the box's centre with bounds on its distance from F that hold
  // everywhere on the closed box, rounding included. A box without extent along an axis is allowed.
  virtual LocalModel model(const Box& box) const = 0;

  // The models of those of the box's eight children whose bit is set in `wanted`, as model(child)
  // would give them up to rounding. Worth overriding where vector instructions make eight models
  // cheaper together than one by one.
  virtual void child_models(const Box& box, unsigned wanted, ModelBatch& out) const {
    for (int i = 0; i < ModelBatch::kSize; ++i)
      if ((wanted >> i) & 1u) out.set(i, model(child_box(box, i)));
  }

  // A field that equals F on `box` (and nowhere else need it be defined), cheaper to evaluate
  // there. Calls on boxes within `box` may be chained.
  virtual std::unique_ptr<ScalarField> restricted_to(const Box& box) const = 0;
};

}  // namespace morsel::topology
