// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/density_boolean.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "hypertexture_geom/field/formula.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;
using topology::ScalarField;

// F = (a + other b + outward sqrt((a - other b)^2 + k^2)) / 2: smax(a, b) for (1, 1), smin(a, b)
// for (1, -1), smin(a, -b) for (-1, -1).
struct Join {
  double other, outward, width;

  template <class Value>
  Value operator()(const Value& a, const Value& b) const {
    const Value c = scale(b, other);
    const Value hyperbola = add_constant(smooth_abs(add(a, scale(c, -1.0)), width), width);
    return scale(add(add(a, c), scale(hyperbola, outward)), 0.5);
  }

  // Of the range of F, given those of a and b; infinite ends are allowed.
  Interval range(Interval a, Interval b) const {
    const Interval c = other > 0.0 ? b : -b;
    const double slack = 0.5 * width * (1.0 + 1e-12);
    return outward > 0.0 ? Interval{std::max(a.lo, c.lo), std::max(a.hi, c.hi) + slack}
                         : Interval{std::min(a.lo, c.lo) - slack, std::min(a.hi, c.hi)};
  }
};

// Two fields joined on a box where both are defined.
class LocalBoolean final : public ScalarField {
 public:
  LocalBoolean(std::unique_ptr<ScalarField> a, std::unique_ptr<ScalarField> b, const Join& join)
      : a_(std::move(a)), b_(std::move(b)), join_(join) {}

  double value(const Imath::V3d& x) const override { return join_(a_->value(x), b_->value(x)); }
  Jet jet(const Imath::V3d& x) const override { return join_(a_->jet(x), b_->jet(x)); }
  LocalModel model(const Box& box) const override { return join_(a_->model(box), b_->model(box)); }
  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    return std::make_unique<LocalBoolean>(a_->restricted_to(box), b_->restricted_to(box), join_);
  }

 private:
  std::unique_ptr<ScalarField> a_, b_;
  Join join_;
};

class Boolean final : public Expression {
 public:
  Boolean(std::shared_ptr<const Expression> a, std::shared_ptr<const Expression> b,
          const Join& join)
      : a_(std::move(a)), b_(std::move(b)), join_(join) {}

  double value(const Imath::V3d& x) const override { return join_(a_->value(x), b_->value(x)); }
  Jet jet(const Imath::V3d& x) const override { return join_(a_->jet(x), b_->jet(x)); }
  LocalModel model(const Box& box) const override { return join_(a_->model(box), b_->model(box)); }
  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    return std::make_unique<LocalBoolean>(a_->restricted_to(box), b_->restricted_to(box), join_);
  }

  Interval expected_range() const override {
    return join_.range(a_->expected_range(), b_->expected_range());
  }

  // smin(a, c) <= a, c; smax(a, c) <= max(a, c) + k / 2.
  std::optional<Box> superlevel_box(double level) const override {
    if (level > expected_range().hi) return Box();
    const bool max = join_.outward > 0.0;
    if (max) level -= 0.5 * join_.width * (1.0 + 1e-12);
    const std::optional<Box> in_a = a_->superlevel_box(level);
    if (join_.other < 0.0) return in_a;
    const std::optional<Box> in_b = b_->superlevel_box(level);
    if (max) {
      if (!in_a || !in_b) return std::nullopt;
      Box both = *in_a;
      both.extendBy(*in_b);
      return both;
    }
    if (!in_a) return in_b;
    if (!in_b) return in_a;
    Box common;
    for (int i = 0; i < 3; ++i) {
      common.min[i] = std::max(in_a->min[i], in_b->min[i]);
      common.max[i] = std::min(in_a->max[i], in_b->max[i]);
      if (common.min[i] > common.max[i]) return Box();
    }
    return common;
  }

 private:
  std::shared_ptr<const Expression> a_, b_;
  Join join_;
};

using Parts = std::vector<std::shared_ptr<const Expression>>;

// Parts [first, last) joined as a balanced tree.
std::shared_ptr<const Expression> joined(const Parts& parts, std::size_t first, std::size_t last,
                                         const Join& join) {
  if (last - first == 1) return parts[first];
  const std::size_t middle = first + (last - first + 1) / 2;
  return std::make_shared<Boolean>(joined(parts, first, middle, join),
                                   joined(parts, middle, last, join), join);
}

// The root, of which somebody else is to be the only owner.
std::unique_ptr<Expression> join_all(const Parts& parts, const Join& join) {
  const std::size_t middle = (parts.size() + 1) / 2;
  return std::make_unique<Boolean>(joined(parts, 0, middle, join),
                                   joined(parts, middle, parts.size(), join), join);
}

}  // namespace

std::unique_ptr<Expression> make_smooth_union(const Parts& parts, double width) {
  return join_all(parts, {1.0, 1.0, width});
}

std::unique_ptr<Expression> make_smooth_intersection(const Parts& parts, double width) {
  return join_all(parts, {1.0, -1.0, width});
}

std::unique_ptr<Expression> make_smooth_difference(std::shared_ptr<const Expression> a,
                                                   std::shared_ptr<const Expression> b,
                                                   double width) {
  return std::make_unique<Boolean>(std::move(a), std::move(b), Join{-1.0, -1.0, width});
}

}  // namespace morsel::geom
