// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/sum.h"

#include "hypertexture_geom/field/tape_builder.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;
using topology::ScalarField;

double value_of(const ScalarField& a, const ScalarField& b, const Imath::V3d& x) {
  return a.value(x) + b.value(x);
}

Jet jet_of(const ScalarField& a, const ScalarField& b, const Imath::V3d& x) {
  Jet sum = a.jet(x);
  const Jet other = b.jet(x);
  sum.value += other.value;
  sum.gradient += other.gradient;
  for (int i = 0; i < 6; ++i) sum.hessian[i] += other.hessian[i];
  return sum;
}

LocalModel model_of(const ScalarField& a, const ScalarField& b, const Box& box) {
  LocalModel sum = a.model(box);
  const LocalModel other = b.model(box);
  for (int i = 0; i < topology::monomial::kCount; ++i) sum.c[i] += other.c[i];
  sum.value_error += other.value_error;
  sum.gradient_error += other.gradient_error;
  sum.hessian_error += other.hessian_error;
  sum.add_rounding();
  return sum;
}

void child_models_of(const ScalarField& a, const ScalarField& b, const Box& box, unsigned wanted,
                     topology::ModelBatch& out) {
  topology::ModelBatch other;
  a.child_models(box, wanted, out);
  b.child_models(box, wanted, other);
  out.add(other);
}

// The sum on a box where both terms have been restricted.
class LocalSum final : public Term {
 public:
  LocalSum(std::unique_ptr<ScalarField> a, std::unique_ptr<ScalarField> b)
      : a_(std::move(a)), b_(std::move(b)) {}

  double value(const Imath::V3d& x) const override { return value_of(*a_, *b_, x); }
  Jet jet(const Imath::V3d& x) const override { return jet_of(*a_, *b_, x); }
  LocalModel model(const Box& box) const override { return model_of(*a_, *b_, box); }
  void child_models(const Box& box, unsigned wanted, topology::ModelBatch& out) const override {
    child_models_of(*a_, *b_, box, wanted, out);
  }
  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    return std::make_unique<LocalSum>(a_->restricted_to(box), b_->restricted_to(box));
  }
  TapeValue emit(TapeBuilder& tape) const override {
    const TapeValue a = tape.field(*a_);
    return tape.add(a, tape.field(*b_));
  }

 private:
  std::unique_ptr<ScalarField> a_, b_;
};

class Sum final : public Expression {
 public:
  Sum(std::shared_ptr<const Expression> a, std::shared_ptr<const Expression> b)
      : a_(std::move(a)), b_(std::move(b)) {}

  double value(const Imath::V3d& x) const override { return value_of(*a_, *b_, x); }
  Jet jet(const Imath::V3d& x) const override { return jet_of(*a_, *b_, x); }
  LocalModel model(const Box& box) const override { return model_of(*a_, *b_, box); }
  void child_models(const Box& box, unsigned wanted, topology::ModelBatch& out) const override {
    child_models_of(*a_, *b_, box, wanted, out);
  }
  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    return std::make_unique<LocalSum>(a_->restricted_to(box), b_->restricted_to(box));
  }
  TapeValue emit(TapeBuilder& tape) const override {
    const TapeValue a = tape.field(*a_);
    return tape.add(a, tape.field(*b_));
  }

  Interval expected_range() const override { return a_->expected_range() + b_->expected_range(); }

  // Where the sum reaches the level, each term reaches it less the other's maximum.
  std::optional<Box> superlevel_box(double level) const override {
    const std::optional<Box> in_a = a_->superlevel_box(level - b_->expected_range().hi);
    const std::optional<Box> in_b = b_->superlevel_box(level - a_->expected_range().hi);
    if (!in_a) return in_b;
    if (!in_b) return in_a;
    Box both;
    for (int i = 0; i < 3; ++i) {
      both.min[i] = std::max(in_a->min[i], in_b->min[i]);
      both.max[i] = std::min(in_a->max[i], in_b->max[i]);
      if (both.min[i] > both.max[i]) return Box();
    }
    return both;
  }

 private:
  std::shared_ptr<const Expression> a_, b_;
};

}  // namespace

std::unique_ptr<Expression> make_sum(std::shared_ptr<const Expression> a,
                                     std::shared_ptr<const Expression> b) {
  return std::make_unique<Sum>(std::move(a), std::move(b));
}

}  // namespace morsel::geom
