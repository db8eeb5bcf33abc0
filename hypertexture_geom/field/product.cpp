// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/product.h"

#include <algorithm>

#include "hypertexture_geom/field/jet_algebra.h"
#include "hypertexture_geom/field/model_algebra.h"
#include "hypertexture_geom/field/operation.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;

// A mask whose value and derivatives are nowhere above this counts as 0: a model's allowance for
// underflow, and no field has derivatives that make anything of it.
constexpr double kNothing = 1e-280;
constexpr double kNothingTimesField = 1e-240;

bool vanishes(const LocalModel& mask) {
  if (!(mask.range().magnitude() < kNothing)) return false;
  for (int i = 0; i < 3; ++i) {
    if (!(mask.gradient_range(i).magnitude() < kNothing)) return false;
    for (int j = 0; j <= i; ++j)
      if (!(mask.hessian_range(i, j).magnitude() < kNothing)) return false;
  }
  return true;
}

// Arguments: the mask, what it applies to; none where the mask vanishes.
struct Masked {
  template <class F>
  double value(const F& f, const Imath::V3d& x) const {
    if (f.empty()) return 0.0;
    const double mask = f[0]->value(x);
    return mask == 0.0 ? 0.0 : mask * f[1]->value(x);
  }

  template <class F>
  Jet jet(const F& f, const Imath::V3d& x) const {
    if (f.empty()) return {};
    const Jet mask = f[0]->jet(x);
    return mask.value == 0.0 ? Jet() : jets::operator*(mask, f[1]->jet(x));
  }

  template <class F>
  LocalModel model(const F& f, const Box& box) const {
    if (!f.empty()) {
      const LocalModel mask = f[0]->model(box);
      if (!vanishes(mask)) return product(mask, f[1]->model(box));
    }
    LocalModel zero = constant_model(box, 0.0, kNothingTimesField);
    zero.gradient_error += Imath::V3d(kNothingTimesField);
    zero.hessian_error += kNothingTimesField;
    return zero;
  }

  template <class F>
  RestrictedFields restricted(const F& f, const Box& box) const {
    RestrictedFields r;
    if (f.empty() || vanishes(f[0]->model(box))) return r;
    r.push_back(f[0]->restricted_to(box));
    r.push_back(f[1]->restricted_to(box));
    return r;
  }

  template <class F>
  TapeValue emit(const F& f, TapeBuilder& tape) const {
    if (f.empty()) return tape.constant(0.0);
    const TapeValue mask = tape.field(*f[0]);
    return tape.multiply(mask, tape.field(*f[1]));
  }

  Interval expected_range(const Expressions& f) const {
    return f[0]->expected_range() * f[1]->expected_range();
  }

  // mask f >= level > 0 needs mask >= level / (the most that f is): masks are not negative.
  std::optional<Box> superlevel_box(const Expressions& f, double level) const {
    if (expected_range(f).hi < level) return Box();
    const double most = f[1]->expected_range().hi;
    if (!(level > 0.0) || !(most > 0.0)) return std::nullopt;
    return f[0]->superlevel_box(level / most * (1.0 - 1e-12));
  }
};

}  // namespace

std::unique_ptr<Expression> make_masked(std::shared_ptr<const Expression> mask,
                                        std::shared_ptr<const Expression> f) {
  return std::make_unique<OperationExpression<Masked>>(Masked{},
                                                       Expressions{std::move(mask), std::move(f)});
}

}  // namespace morsel::geom
