// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

// A second implementation of every density, noise and modulation, in long double with derivatives
// by dual numbers, straight from a field's canonical JSON: slow, and without anything that the
// fields themselves do but the integer hashes.
namespace morsel::geom::testing {

// A value and its gradient.
struct Dual {
  long double v = 0.0L;
  long double g[3] = {0.0L, 0.0L, 0.0L};
};

class ReferenceField {
 public:
  virtual ~ReferenceField() = default;
  // At the point x; its derivatives are carried along.
  virtual Dual at(const Dual (&x)[3]) const = 0;
  // Places that boxes are to straddle: apexes, support borders, lattice planes, ends of masks.
  virtual void special_places(std::vector<std::array<double, 3>>& places) const = 0;

  Dual at(long double x, long double y, long double z) const {
    Dual p[3];
    p[0].v = x;
    p[1].v = y;
    p[2].v = z;
    for (int i = 0; i < 3; ++i) p[i].g[i] = 1.0L;
    return at(p);
  }
};

// From Field::canonical_json().
std::shared_ptr<const ReferenceField> reference_field(const nlohmann::json& canonical);

}  // namespace morsel::geom::testing
