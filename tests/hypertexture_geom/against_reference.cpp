// SPDX-License-Identifier: Apache-2.0
#include "tests/hypertexture_geom/against_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

#include "hypertexture_geom/field/registry.h"
#include "tests/hypertexture_geom/random_density.h"
#include "tests/hypertexture_geom/random_modulation.h"
#include "tests/hypertexture_geom/reference_field.h"
#include "tests/hypertexture_geom/soundness.h"
#include "tests/hypertexture_geom/test_fields.h"
#include "topology/model_batch.h"

namespace morsel::geom::testing {
namespace {

using nlohmann::json;
using topology::Box;
using Real = long double;

// Slopes are bounded on every box of at most this side.
constexpr double kSlopesKnown = 0x1p-6;

json random_field(std::mt19937_64& random) {
  RandomModulation make(random);
  std::vector<std::string> types;
  for (const ModulationEntry& m : modulations()) types.push_back(m.declaration.name);
  std::vector<std::string> sequence;
  for (int n = make.integer(0, 3); n > 0; --n) sequence.push_back(types[random() % types.size()]);
  json field = make.field(sequence);
  if (random() % 3 != 0) {
    const auto& names = random() % 3 == 0 ? boolean_densities() : simple_densities();
    field["density"] = random_density(names[random() % names.size()], random);
  }
  return field;
}

// Now and then, what is seldom drawn: other ratios of frequencies and more octaves, amplitudes
// whose products underflow. Returns the size of the field's values: 1, or how much smaller it was
// made so that they underflow themselves.
double make_unusual(json& field, std::mt19937_64& random) {
  RandomModulation make(random);
  for (json& m : field["modulations"]) {
    if (!m.contains("frequency")) continue;
    if (random() % 3 == 0) m["lacunarity"] = make.uniform(1.01, 3.0);
    if (random() % 6 == 0) m["layers"] = 4;
    if (random() % 8 == 0)
      m["amplitude"] = std::ldexp(make.uniform(-1.0, 1.0), -make.integer(100, 1070));
  }
  if (random() % 8 != 0) return 1.0;
  const double size = std::ldexp(1.0, -make.integer(100, 1060));
  field["modulations"].push_back({{"type", "scale_offset"}, {"scale", size}, {"offset", 0.0}});
  return size;
}

// A sphere and sums of sparse convolution alone: what the models of eight children at once are
// written for; other fields go through them one by one.
json random_sum(std::mt19937_64& random) {
  RandomModulation make(random);
  json field{{"density", random_density("sphere", random)}, {"modulations", json::array()}};
  for (int n = make.integer(1, 3); n > 0; --n) {
    json m = make.of("fbm");
    m["noise"] = "sparse_convolution";
    m.erase("mask");
    field["modulations"].push_back(std::move(m));
  }
  return field;
}

Box random_box(std::mt19937_64& random, const std::vector<std::array<double, 3>>& places) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int exponent = -1 - static_cast<int>(random() % 20);
  Imath::V3d c(2.0 * unit(random), 2.0 * unit(random), 2.0 * unit(random));
  const auto kind = random() % 8;
  if (kind >= 4 && !places.empty()) {
    const auto& p = places[random() % places.size()];
    const double width = std::ldexp(1.0, exponent);
    for (int a = 0; a < 3; ++a) c[a] = p[static_cast<std::size_t>(a)] + width * unit(random);
    // Exactly on the place, and so small that powers of the distance from it underflow.
    if (kind == 7) {
      for (int a = 0; a < 3; ++a) c[a] = p[static_cast<std::size_t>(a)];
      if (random() % 4 == 0) exponent = -30 - static_cast<int>(random() % 400);
    }
  }
  const double width = 0.5 * std::ldexp(1.0, exponent);
  Imath::V3d half(width, width, width);
  if (random() % 3 == 0)
    half *= Imath::V3d(std::abs(unit(random)), std::abs(unit(random)), std::abs(unit(random)));
  if (random() % 8 == 0) half[static_cast<int>(random() % 3)] = 0.0;
  // Farther away than anything of the field; or so near a coordinate plane that boxes much smaller
  // than the coordinates' usual spacing keep their extent, and squares of it underflow.
  if (random() % 16 == 0) c *= random() % 2 == 0 ? 10.0 : 1e3;
  if (random() % 16 == 0) {
    const double tiny = std::ldexp(1.0, -30 - static_cast<int>(random() % 1000));
    const bool all = random() % 2 == 0;
    const int only = static_cast<int>(random() % 3);
    for (int a = 0; a < 3; ++a)
      if (all || a == only) {
        c[a] = tiny * unit(random);
        half[a] = tiny;
      }
  }
  return Box(c - half, c + half);
}

// The field on the box, restricted to larger and larger boxes around it before, as the octree does
// it.
std::unique_ptr<topology::ScalarField> restricted_by_steps(const topology::ScalarField& field,
                                                           const Box& box,
                                                           std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Box> around{box};
  for (int n = static_cast<int>(random() % 24); n > 0; --n) {
    Box next = around.back();
    const Imath::V3d size = next.max - next.min;
    const double widest = std::max({size.x, size.y, size.z, 1e-9});
    if (widest > 4.0) break;
    for (int a = 0; a < 3; ++a) {
      next.min[a] -= widest * unit(random);
      next.max[a] += widest * unit(random);
    }
    around.push_back(next);
  }
  std::unique_ptr<topology::ScalarField> local;
  for (; !around.empty(); around.pop_back())
    local = (local ? *local : field).restricted_to(around.back());
  return local;
}

struct Cubic {
  Real value, slope[3];
};

// The model's polynomial at u, in long double.
Cubic cubic_at(const topology::LocalModel& m, const Real (&u)[3]) {
  // Powers of x, y, z in the order of topology::monomial.
  static constexpr int kPower[topology::monomial::kCount][3] = {
      {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2},
      {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {2, 1, 0},
      {2, 0, 1}, {1, 2, 0}, {0, 2, 1}, {1, 0, 2}, {0, 1, 2}, {1, 1, 1}};
  Real power[3][4], derivative[3][4];
  for (int a = 0; a < 3; ++a) {
    power[a][0] = 1.0L;
    derivative[a][0] = 0.0L;
    for (int n = 1; n < 4; ++n) {
      power[a][n] = power[a][n - 1] * u[a];
      derivative[a][n] = n * power[a][n - 1];
    }
  }
  Cubic r{0.0L, {0.0L, 0.0L, 0.0L}};
  for (std::size_t i = 0; i < topology::monomial::kCount; ++i) {
    const Real c = m.c[i];
    const auto& p = kPower[i];
    const Real x = power[0][p[0]], y = power[1][p[1]], z = power[2][p[2]];
    r.value += c * x * y * z;
    r.slope[0] += c * derivative[0][p[0]] * y * z;
    r.slope[1] += c * x * derivative[1][p[1]] * z;
    r.slope[2] += c * x * y * derivative[2][p[2]];
  }
  return r;
}

class Checker {
 public:
  // `size`: of the field's values.
  Checker(const ReferenceField& reference, const json& description, double scale, double size,
          ReferenceCheck& check)
      : reference_(reference),
        description_(description),
        scale_(scale),
        size_(size),
        check_(check) {}

  void box(const topology::LocalModel& m, const Box& box, std::mt19937_64& random, int samples) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    ++check_.boxes;
    if (!(m.value_error >= 0.0)) fail(check_.undefined, "value error is no number", box);
    for (int a = 0; a < 3; ++a)
      if (!(m.gradient_error[a] >= 0.0)) fail(check_.undefined, "gradient error is no number", box);
    for (const double c : m.c)
      if (!std::isfinite(c)) fail(check_.undefined, "a coefficient is not finite", box);
    // An infinite bound holds but says nothing. Values are bounded on every box; slopes may be
    // unknown where a box is several cells of a noise wide.
    if (!std::isfinite(m.value_error)) fail(check_.infinite, "value error is infinite", box);
    const Imath::V3d& e = m.gradient_error;
    if (!(std::isfinite(e.x) && std::isfinite(e.y) && std::isfinite(e.z))) {
      ++check_.without_slopes;
      const Imath::V3d size = box.max - box.min;
      if (std::max({size.x, size.y, size.z}) < kSlopesKnown)
        fail(check_.infinite, "gradient error is infinite", box);
    }
    const topology::Interval range = m.range();
    topology::Interval slopes[3];
    for (int a = 0; a < 3; ++a) slopes[a] = m.gradient_range(a);
    for (int k = 0; k < samples; ++k) {
      ++check_.samples;
      Real x[3], u[3];
      for (int a = 0; a < 3; ++a) {
        const Real s = k < 8 ? ((k >> a) & 1 ? 1.0L : -1.0L) : Real(unit(random));
        x[a] = 0.5L * ((1.0L - s) * box.min[a] + (1.0L + s) * box.max[a]);
        x[a] = std::clamp<Real>(x[a], box.min[a], box.max[a]);
        u[a] = x[a] - m.centre[a];
      }
      const Dual f = reference_.at(x[0], x[1], x[2]);
      const Cubic p = cubic_at(m, u);
      // Long double's own rounding, and that of constants that the reference derives on its own.
      const Real slack = 4e-18L * (size_ + std::abs(f.v));
      if (!(std::abs(f.v - p.value) <= scale_ * m.value_error + slack))
        fail(check_.value, "value", box);
      if (!(f.v >= range.lo - slack && f.v <= range.hi + slack)) fail(check_.range, "range", box);
      for (int a = 0; a < 3; ++a) {
        const Real loose = 4e-17L * (size_ + std::abs(f.g[a]));
        if (!(std::abs(f.g[a] - p.slope[a]) <= scale_ * m.gradient_error[a] + loose))
          fail(check_.gradient, "gradient", box);
        if (!(f.g[a] >= slopes[a].lo - loose && f.g[a] <= slopes[a].hi + loose))
          fail(check_.gradient_range, "gradient range", box);
      }
    }
  }

 private:
  void fail(std::int64_t& count, const char* what, const Box& box) {
    ++count;
    if (!check_.first.empty()) return;
    std::ostringstream text;
    text.precision(17);
    text << what << " on box " << box.min << " " << box.max << " of " << description_;
    check_.first = text.str();
  }

  const ReferenceField& reference_;
  const json& description_;
  double scale_, size_;
  ReferenceCheck& check_;
};

}  // namespace

ReferenceCheck check_against_reference(std::int64_t samples, std::uint64_t seed, bool flush_to_zero,
                                       double scale) {
  constexpr int kBoxesOfAField = 40, kSamplesOfABox = 40, kSamplesOfAChild = 10;
  std::mt19937_64 random(seed);
  ReferenceCheck check;
  while (check.samples < samples) {
    const bool sum = check.fields % 4 == 3;
    json description = sum ? random_sum(random) : random_field(random);
    const double size = random() % 2 == 0 ? make_unusual(description, random) : 1.0;
    const auto field = field_of(description);
    const auto reference = reference_field(field->canonical_json());
    std::vector<std::array<double, 3>> places;
    reference->special_places(places);
    Checker checker(*reference, description, scale, size, check);
    ++check.fields;
    for (int n = 0; n < kBoxesOfAField; ++n) {
      const Box box = random_box(random, places);
      // Of all boxes of sums, and a few of the others.
      const bool children = sum || n % 8 == 0;
      topology::LocalModel model;
      topology::ModelBatch batch;
      {
        const FlushToZero mode(flush_to_zero);
        // Directly, and as the octree does it.
        const auto local = restricted_by_steps(*field, box, random);
        model = n % 2 == 0 ? field->model(box) : local->model(box);
        if (children) local->child_models(box, 0xffu, batch);
      }
      checker.box(model, box, random, kSamplesOfABox);
      if (!children) continue;
      for (int i = 0; i < topology::ModelBatch::kSize; ++i)
        checker.box(batch[i], topology::child_box(box, i), random, kSamplesOfAChild);
      check.child_boxes += topology::ModelBatch::kSize;
    }
  }
  return check;
}

}  // namespace morsel::geom::testing
