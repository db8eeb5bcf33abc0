// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "hypertexture_geom/field/term.h"

namespace morsel::geom {

// A term of a field: densities, noises and what combines them are all of this kind, so that any
// sequence composes. Immutable.
class Expression : public Term {
 public:
  // The values to expect over all of space: exceeded nowhere (densities), or so rarely that no
  // object meets it (noises of random impulses: 6 standard deviations and more). Only used to find
  // a box to work in, never in a proof.
  virtual topology::Interval expected_range() const = 0;

  // A box outside of which a value of `level` or more is not to be expected; empty when there is
  // none.
  virtual std::optional<topology::Box> superlevel_box(double level) const = 0;

  // Of a modulation: where it evaluates what came before it for a value at `x`. Only a domain warp
  // looks elsewhere than at x.
  virtual Imath::V3d source_of(const Imath::V3d& x) const { return x; }
};

}  // namespace morsel::geom
