// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "topology/scalar_field.h"

namespace morsel::geom {

// A term of a field: densities, noises and what combines them are all of this kind, so that any
// sequence composes. Immutable.
class Expression : public topology::ScalarField {
 public:
  // An enclosure of the values over all of space.
  virtual topology::Interval global_range() const = 0;

  // A box outside of which the value is below `level` for certain; empty when there is none.
  virtual std::optional<topology::Box> superlevel_box(double level) const = 0;
};

}  // namespace morsel::geom
