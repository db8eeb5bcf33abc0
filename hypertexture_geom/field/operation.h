// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "hypertexture_geom/field/expression.h"
#include "hypertexture_geom/field/tape_builder.h"

// An operation on other expressions, written once for the expressions themselves and for their
// restrictions to a box. `Operation` is a copyable class with, for arguments f[i]-> of any kind of
// field,
//   double value(const F& f, const Imath::V3d& x) const
//   topology::Jet jet(const F& f, const Imath::V3d& x) const
//   topology::LocalModel model(const F& f, const topology::Box& box) const
//   std::vector<std::unique_ptr<topology::ScalarField>> restricted(const F& f, const Box&) const
//   TapeValue emit(const F& f, TapeBuilder& tape) const
// and, for arguments that are expressions, what Expression has:
//   topology::Interval expected_range(const Expressions& f) const
//   std::optional<topology::Box> superlevel_box(const Expressions& f, double level) const
//   Imath::V3d source_of(const Expressions& f, const Imath::V3d& x) const      (may be absent)
namespace morsel::geom {

using Expressions = std::vector<std::shared_ptr<const Expression>>;
using RestrictedFields = std::vector<std::unique_ptr<topology::ScalarField>>;

template <class Operation>
class RestrictedOperation final : public Term {
 public:
  RestrictedOperation(Operation operation, RestrictedFields f)
      : operation_(std::move(operation)), f_(std::move(f)) {}

  double value(const Imath::V3d& x) const override { return operation_.value(f_, x); }
  topology::Jet jet(const Imath::V3d& x) const override { return operation_.jet(f_, x); }
  topology::LocalModel model(const topology::Box& box) const override {
    return operation_.model(f_, box);
  }
  std::unique_ptr<ScalarField> restricted_to(const topology::Box& box) const override {
    return std::make_unique<RestrictedOperation>(operation_, operation_.restricted(f_, box));
  }
  TapeValue emit(TapeBuilder& tape) const override { return operation_.emit(f_, tape); }

 private:
  Operation operation_;
  RestrictedFields f_;
};

template <class Operation>
class OperationExpression final : public Expression {
 public:
  OperationExpression(Operation operation, Expressions f)
      : operation_(std::move(operation)), f_(std::move(f)) {}

  double value(const Imath::V3d& x) const override { return operation_.value(f_, x); }
  topology::Jet jet(const Imath::V3d& x) const override { return operation_.jet(f_, x); }
  topology::LocalModel model(const topology::Box& box) const override {
    return operation_.model(f_, box);
  }
  std::unique_ptr<ScalarField> restricted_to(const topology::Box& box) const override {
    return std::make_unique<RestrictedOperation<Operation>>(operation_,
                                                            operation_.restricted(f_, box));
  }
  TapeValue emit(TapeBuilder& tape) const override { return operation_.emit(f_, tape); }
  topology::Interval expected_range() const override { return operation_.expected_range(f_); }
  std::optional<topology::Box> superlevel_box(double level) const override {
    return operation_.superlevel_box(f_, level);
  }
  Imath::V3d source_of(const Imath::V3d& x) const override {
    if constexpr (requires { operation_.source_of(f_, x); })
      return operation_.source_of(f_, x);
    else
      return x;
  }

 private:
  Operation operation_;
  Expressions f_;
};

}  // namespace morsel::geom
