// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <utility>

#include "topology/scalar_field.h"

namespace morsel::topology::testing {

// A field that calls `after` when its models, and those of all its restrictions, have been asked
// for `count` times.
class Counted final : public ScalarField {
 public:
  struct Trigger {
    std::atomic<int> count;
    std::function<void()> after;
  };
  Counted(std::shared_ptr<const ScalarField> field, Trigger& trigger)
      : field_(std::move(field)), trigger_(&trigger) {}
  double value(const Imath::V3d& x) const override { return field_->value(x); }
  Jet jet(const Imath::V3d& x) const override { return field_->jet(x); }
  LocalModel model(const Box& box) const override {
    if (--trigger_->count == 0) trigger_->after();
    return field_->model(box);
  }
  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    return std::make_unique<Counted>(field_->restricted_to(box), *trigger_);
  }

 private:
  std::shared_ptr<const ScalarField> field_;
  Trigger* trigger_;
};

}  // namespace morsel::topology::testing
