// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/density_boolean.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "hypertexture_geom/field/formula.h"
#include "hypertexture_geom/field/operation.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;

// The smooth maximum's weights: its gradient is weight grad a + (1 - weight) grad c.
struct Weights {
  double a, c;       // the most that either is on the box
  double slope;      // of the weight of a, as t = a - c changes: k^2 / (2 r^3), r = sqrt(t^2 + k^2)
  double curvature;  // bound on that slope's derivative, 3 k^2 |t| / (2 r^5)
};

Weights weights(Interval t, double outward, double k) {
  constexpr double kUp = 1.0 + 1e-12;
  // (1 - t / r) / 2 for t > 0, without cancellation; the underflow of 1 / r^2 is covered.
  const auto smaller = [k](double size) {
    const double r = std::sqrt(size * size + k * k);
    return 0.5 * k * (k / r) / (r + size) * kUp + 1e-290;
  };
  const auto of_larger = [&](double difference) {  // weight of the one that is larger by this
    return difference > 0.0 ? 1.0 : smaller(-difference);
  };
  Weights w;
  w.a = of_larger(outward > 0.0 ? t.hi : -t.lo);
  w.c = of_larger(outward > 0.0 ? -t.lo : t.hi);
  const double least = t.mignitude(), r = std::sqrt(least * least + k * k);
  w.slope = 0.5 * (k / r) * (k / r) / r * kUp;
  w.curvature = 1.5 * (k / r) * (k / r) / (r * r) * kUp;
  return w;
}

// F = (a + other b + outward sqrt((a - other b)^2 + k^2)) / 2: smax(a, b) for (1, 1), smin(a, b)
// for (1, -1), smin(a, -b) for (-1, -1). An operation on two fields (operation.h).
struct Join {
  double other, outward, width;

  template <class Value>
  Value of(const Value& a, const Value& c) const {
    const Value hyperbola = add_constant(smooth_abs(add(a, scale(c, -1.0)), width), width);
    return scale(add(add(a, c), scale(hyperbola, outward)), 0.5);
  }

  template <class F>
  double value(const F& f, const Imath::V3d& x) const {
    return of(f[0]->value(x), other * f[1]->value(x));
  }

  template <class F>
  Jet jet(const F& f, const Imath::V3d& x) const {
    return of(f[0]->jet(x), scale(f[1]->jet(x), other));
  }

  // The polynomials are joined as if they were exact, and their errors enter by the weight that
  // each part has: where one part is far above the other, the other's error hardly counts. With
  // e, g, h the errors of value, gradient and Hessian, t = a - c, and the weight off by at most
  // weights.slope (e_a + e_c):
  //   grad F = w grad a + (1 - w) grad c,
  //   Hess F = w Hess a + (1 - w) Hess c + outward slope(t) grad t grad t^T.
  template <class F>
  LocalModel model(const F& f, const Box& box) const {
    const LocalModel a = f[0]->model(box);
    LocalModel c = f[1]->model(box);
    if (other < 0.0) c = negate(c);
    const auto exact = [](LocalModel m) {
      m.value_error = m.hessian_error = 0.0;
      m.gradient_error = Imath::V3d(0.0);
      return m;
    };
    const LocalModel polynomial_a = exact(a), polynomial_c = exact(c);
    const LocalModel t = subtract(polynomial_a, polynomial_c);
    LocalModel m = of(polynomial_a, polynomial_c);
    const double e = (a.value_error + c.value_error) * (1.0 + 1e-12);
    const Interval reach = t.range() + Interval{-e, e};
    const Weights w = weights(reach, outward, width);
    double steepest = 0.0, largest = 0.0, bend = 0.0;
    Imath::V3d gradient;
    for (int i = 0; i < 3; ++i) {
      const double slope = t.gradient_range(i).magnitude();
      gradient[i] = w.a * a.gradient_error[i] + w.c * c.gradient_error[i] + w.slope * e * slope;
      steepest = std::max(steepest, slope);
      largest = std::max(largest, a.gradient_error[i] + c.gradient_error[i]);
      for (int j = 0; j <= i; ++j) bend = std::max(bend, t.hessian_range(i, j).magnitude());
    }
    constexpr double kUp = 1.0 + 1e-12;
    m.value_error += (w.a * a.value_error + w.c * c.value_error) * kUp;
    m.gradient_error += gradient * kUp;
    m.hessian_error +=
        (w.a * a.hessian_error + w.c * c.hessian_error + w.slope * e * bend +
         w.curvature * e * steepest * steepest + w.slope * largest * (2.0 * steepest + largest)) *
        kUp;
    forget_nans(m);
    return m;
  }

  template <class F>
  RestrictedFields restricted(const F& f, const Box& box) const {
    RestrictedFields r;
    r.push_back(f[0]->restricted_to(box));
    r.push_back(f[1]->restricted_to(box));
    return r;
  }

  template <class F>
  TapeValue emit(const F& f, TapeBuilder& tape) const {
    const TapeValue a = tape.field(*f[0]);
    return of(a, scale(tape.field(*f[1]), other));
  }

  Interval expected_range(const Expressions& f) const {
    const Interval a = f[0]->expected_range(), b = f[1]->expected_range(), c = other > 0.0 ? b : -b;
    const double slack = 0.5 * width * (1.0 + 1e-12);
    return outward > 0.0 ? Interval{std::max(a.lo, c.lo), std::max(a.hi, c.hi) + slack}
                         : Interval{std::min(a.lo, c.lo) - slack, std::min(a.hi, c.hi)};
  }

  // smin(a, c) <= a, c; smax(a, c) <= max(a, c) + k / 2.
  std::optional<Box> superlevel_box(const Expressions& f, double level) const {
    if (level > expected_range(f).hi) return Box();
    const bool max = outward > 0.0;
    if (max) level -= 0.5 * width * (1.0 + 1e-12);
    const std::optional<Box> in_a = f[0]->superlevel_box(level);
    if (other < 0.0) return in_a;
    const std::optional<Box> in_b = f[1]->superlevel_box(level);
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
};

std::unique_ptr<Expression> join(std::shared_ptr<const Expression> a,
                                 std::shared_ptr<const Expression> b, const Join& how) {
  return std::make_unique<OperationExpression<Join>>(how, Expressions{std::move(a), std::move(b)});
}

// Parts [first, last) joined as a balanced tree.
std::shared_ptr<const Expression> joined(const Expressions& parts, std::size_t first,
                                         std::size_t last, const Join& how) {
  if (last - first == 1) return parts[first];
  const std::size_t middle = first + (last - first + 1) / 2;
  return join(joined(parts, first, middle, how), joined(parts, middle, last, how), how);
}

std::unique_ptr<Expression> join_all(const Expressions& parts, const Join& how) {
  const std::size_t middle = (parts.size() + 1) / 2;
  return join(joined(parts, 0, middle, how), joined(parts, middle, parts.size(), how), how);
}

}  // namespace

std::unique_ptr<Expression> make_smooth_union(const Expressions& parts, double width) {
  return join_all(parts, {1.0, 1.0, width});
}

std::unique_ptr<Expression> make_smooth_intersection(const Expressions& parts, double width) {
  return join_all(parts, {1.0, -1.0, width});
}

std::unique_ptr<Expression> make_smooth_difference(std::shared_ptr<const Expression> a,
                                                   std::shared_ptr<const Expression> b,
                                                   double width) {
  return join(std::move(a), std::move(b), {-1.0, -1.0, width});
}

}  // namespace morsel::geom
