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

// Values at random points of a box, against the model of the box and the field restricted to it.
void check_box(const Field& field, const Box& box, std::mt19937& random) {
  using morsel::test::require;
  const auto own = field.restricted_to(box);
  const LocalModel model = own->model(box);
  const morsel::topology::Interval range = model.range();
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 4; ++i) {
    Imath::V3d x;
    for (int k = 0; k < 3; ++k) x[k] = box.min[k] + u(random) * (box.max[k] - box.min[k]);
    const double value = field.value(x);
    if (!std::isfinite(value) || !std::isfinite(range.lo) || !std::isfinite(range.hi)) continue;
    require(value >= range.lo && value <= range.hi, "the model's range holds the field's values");
    const morsel::topology::Jet jet = field.jet(x);
    for (int k = 0; k < 3; ++k) {
      const morsel::topology::Interval slope = model.gradient_range(k);
      if (!std::isfinite(jet.gradient[k]) || !std::isfinite(slope.lo) || !std::isfinite(slope.hi))
        continue;
      require(jet.gradient[k] >= slope.lo && jet.gradient[k] <= slope.hi,
              "the model's range of slopes holds the field's");
    }
  }
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
