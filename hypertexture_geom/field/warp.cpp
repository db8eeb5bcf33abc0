// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/warp.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hypertexture_geom/field/mask.h"
#include "hypertexture_geom/field/model_algebra.h"
#include "hypertexture_geom/field/noise.h"
#include "hypertexture_geom/field/operation.h"

namespace morsel::geom {
namespace {

using params::JsonReader;
using params::Type;
using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;

// Arguments: H and the three components of the displacement w.
struct Warp {
  template <class F>
  Imath::V3d source_of(const F& f, const Imath::V3d& x) const {
    return x + Imath::V3d(f[1]->value(x), f[2]->value(x), f[3]->value(x));
  }

  template <class F>
  double value(const F& f, const Imath::V3d& x) const {
    return f[0]->value(source_of(f, x));
  }

  // With J = I + grad w: gradient J^T grad H, Hessian J^T Hess H J + sum_a dH/dy_a Hess w_a.
  template <class F>
  Jet jet(const F& f, const Imath::V3d& x) const {
    Jet w[3];
    Imath::V3d y = x, columns[3];
    for (int a = 0; a < 3; ++a) {
      w[a] = f[1 + a]->jet(x);
      y[a] += w[a].value;
      for (int i = 0; i < 3; ++i) columns[i][a] = w[a].gradient[i] + (a == i ? 1.0 : 0.0);
    }
    const Jet h = f[0]->jet(y);
    constexpr int kIndex[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    Jet r;
    r.value = h.value;
    for (int i = 0; i < 3; ++i) {
      r.gradient[i] = h.gradient.dot(columns[i]);
      for (int j = i; j < 3; ++j) {
        double sum = 0.0;
        for (int a = 0; a < 3; ++a) {
          sum += h.gradient[a] * w[a].hessian[kIndex[i][j]];
          for (int b = 0; b < 3; ++b)
            sum += h.hessian[kIndex[a][b]] * columns[i][a] * columns[j][b];
        }
        r.hessian[kIndex[i][j]] = sum;
      }
    }
    return r;
  }

  template <class F>
  LocalModel model(const F& f, const Box& box) const {
    LocalModel y[3];
    return compose(f[0]->model(image(f, box, y)), y);
  }

  template <class F>
  RestrictedFields restricted(const F& f, const Box& box) const {
    LocalModel y[3];
    RestrictedFields r;
    r.push_back(f[0]->restricted_to(widened(image(f, box, y))));
    for (int a = 1; a < 4; ++a) r.push_back(f[a]->restricted_to(box));
    return r;
  }

  template <class F>
  TapeValue emit(const F& f, TapeBuilder& tape) const {
    LocalModel y[3];
    const Box exact = image(f, tape.box(), y), known = widened(exact);
    double slack = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) slack = std::min(slack, known.max[a] - exact.max[a]);
    const TapeValue w[3] = {tape.field(*f[1]), tape.field(*f[2]), tape.field(*f[3])};
    return tape.displaced(w, known, slack, *f[0]);
  }

  Interval expected_range(const Expressions& f) const { return f[0]->expected_range(); }

  std::optional<Box> superlevel_box(const Expressions& f, double level) const {
    std::optional<Box> box = f[0]->superlevel_box(level);
    if (!box || box->isEmpty()) return box;
    for (int a = 0; a < 3; ++a) {
      const Interval w = f[1 + a]->expected_range();
      box->min[a] -= w.hi;
      box->max[a] -= w.lo;
    }
    return box;
  }

 private:
  // With room for displacements that were computed in single precision.
  static Box widened(Box box) {
    const Imath::V3d half = topology::half_size(box);
    const double slack = 2e-5 * std::max({half.x, half.y, half.z, kLeastReach});
    box.min -= Imath::V3d(slack);
    box.max += Imath::V3d(slack);
    return box;
  }
  static constexpr double kLeastReach = 0.25;

  // A box that holds x + w(x) for all x in `box`, and models of its components.
  template <class F>
  static Box image(const F& f, const Box& box, LocalModel (&y)[3]) {
    Box r;
    for (int a = 0; a < 3; ++a) {
      y[a] = add(coordinate_model(box, a), f[1 + a]->model(box));
      const Interval range = y[a].range();
      // What is evaluated in floating point stays within, too.
      const double slack = 1e-14 * range.magnitude();
      r.min[a] = range.lo - slack;
      r.max[a] = range.hi + slack;
    }
    return r;
  }
};

}  // namespace

ModulationEntry warp_entry() {
  ModulationEntry entry;
  entry.declaration = {
      "warp",
      "Moves the place where everything before it is evaluated by a vector of three noises: H(x + "
      "noise(x)).",
      {{"type", Type::kString, "warp", "Kind of modulation."}, mask_parameter()}};
  for (params::Parameter& p : noise_parameters("Factor of the displacement's first octave."))
    entry.declaration.parameters.push_back(std::move(p));
  entry.make = [](std::shared_ptr<const Expression> previous, const JsonReader& r) {
    const NoiseDescription noise = noise_from_json(r);
    Expressions f{std::move(previous)};
    for (std::uint32_t component = 0; component < 3; ++component)
      f.push_back(masked(make_noise(noise, 0, noise.octaves.size(), 1 + component), r));
    return std::make_unique<OperationExpression<Warp>>(Warp{}, std::move(f));
  };
  return entry;
}

}  // namespace morsel::geom
