// SPDX-License-Identifier: Apache-2.0
// The text of a field: what is refused, and what the field's models say of its values.
#include <cmath>
#include <random>
#include <string>

#include "hypertexture_geom/field/field.h"
#include "hypertexture_geom/params/json_reader.h"
#include "tests/fuzz/target.h"

namespace {

using morsel::geom::Field;
using morsel::topology::Box;
using morsel::topology::LocalModel;

using morsel::test::require;

bool is_finite(const LocalModel& model) {
  bool finite = std::isfinite(model.value_error) && std::isfinite(model.hessian_error);
  for (int k = 0; k < 3; ++k) finite = finite && std::isfinite(model.gradient_error[k]);
  for (const double c : model.c) finite = finite && std::isfinite(c);
  return finite;
}

// The model's promises at a point of its box. `slack` covers what ordinary arithmetic may be off by
// where the promise is not of a range but of the polynomial.
void check_model(const LocalModel& model, const Field& field, const Imath::V3d& x) {
  const double value = field.value(x);
  const morsel::topology::Jet jet = field.jet(x);
  const morsel::topology::Interval range = model.range();
  const double slack = 1e-9 * (1.0 + std::abs(value) + std::abs(range.lo) + std::abs(range.hi));
  if (!std::isfinite(value) || !std::isfinite(slack) || !is_finite(model)) return;
  require(value >= range.lo && value <= range.hi, "the model's range holds the field's values");
  const Imath::V3d u = x - model.centre, slopes = model.gradient_at(u);
  require(std::abs(value - model.value_at(u)) <= model.value_error + slack,
          "the polynomial is as near as its error says");
  for (int k = 0; k < 3; ++k) {
    const morsel::topology::Interval slope = model.gradient_range(k);
    const double room = 1e-9 * (1.0 + std::abs(slope.lo) + std::abs(slope.hi));
    if (!std::isfinite(jet.gradient[k]) || !std::isfinite(room)) continue;
    require(jet.gradient[k] >= slope.lo && jet.gradient[k] <= slope.hi,
            "the model's range of slopes holds the field's");
    require(std::abs(jet.gradient[k] - slopes[k]) <= model.gradient_error[k] + room,
            "the polynomial's slopes are as near as their error says");
  }
  constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (int k = 0; k < 6; ++k) {
    const morsel::topology::Interval bend = model.hessian_range(kPairs[k][0], kPairs[k][1]);
    const double room = 1e-9 * (1.0 + std::abs(bend.lo) + std::abs(bend.hi));
    if (!std::isfinite(jet.hessian[k]) || !std::isfinite(room)) continue;
    require(jet.hessian[k] >= bend.lo - room && jet.hessian[k] <= bend.hi + room,
            "the model's range of second derivatives holds the field's");
  }
}

// The models of a box and of its children, of the field and of the field restricted to the box,
// against values at random points.
void check_box(const Field& field, const Box& box, std::mt19937& random) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const auto point_of = [&](const Box& within) {
    Imath::V3d x;
    for (int k = 0; k < 3; ++k) x[k] = within.min[k] + u(random) * (within.max[k] - within.min[k]);
    return x;
  };
  const auto own = field.restricted_to(box);
  const LocalModel whole = field.model(box), restricted = own->model(box);
  for (int i = 0; i < 4; ++i) {
    const Imath::V3d x = point_of(box);
    check_model(whole, field, x);
    check_model(restricted, field, x);
  }
  morsel::topology::ModelBatch children;
  own->child_models(box, 0xffu, children);
  for (int i = 0; i < morsel::topology::ModelBatch::kSize; ++i)
    check_model(children[i], field, point_of(morsel::topology::child_box(box, i)));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLongest = 1 << 14;
  if (size > kLongest) return 0;
  try {
    const std::string text(reinterpret_cast<const char*>(data), size);
    const nlohmann::json json = morsel::params::parse_text(text, "input");
    const morsel::params::Place place{"input", ""};
    const auto field = morsel::geom::field_from_json(json, place);
    const nlohmann::json canonical = field->canonical_json();
    const auto again = morsel::geom::field_from_json(canonical, place);
    morsel::test::require(again->canonical_json() == canonical,
                          "the canonical JSON is that of the field it describes");
    std::mt19937 random(1);
    for (const double half : {2.0, 0.1, 1e-3})
      for (const double at : {0.0, 0.9}) {
        const Imath::V3d centre(at, 0.3 * at, -0.2 * at);
        check_box(*field, {centre - Imath::V3d(half), centre + Imath::V3d(half)}, random);
      }
  } catch (const morsel::params::InputError&) {
  }
  return 0;
}
