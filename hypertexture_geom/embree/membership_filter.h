// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <memory>
#include <vector>

#include "topology/certified.h"
#include "topology/octree.h"
#include "topology/scalar_field.h"

namespace morsel::geom {

// Which component a point on the surface belongs to, where its brick does not say. Any thread may
// ask.
class MembershipFilter {
 public:
  virtual ~MembershipFilter() = default;
  // Component of the surface at `x` (F(x) is zero to within rounding); kNoComponent: not found.
  virtual std::uint32_t component_at(const Imath::V3d& x) const = 0;
  virtual bool keeps(const Imath::V3d& x) const = 0;
  virtual std::uint64_t bytes() const = 0;  // that it holds; the octree it looks at is not its own
};

// Point location in the labelled octree. A point of S in a leaf whose content is proved connected
// or full belongs to that leaf's component. Where the leaf is undecided a short streamline goes
// uphill until it is in one that is not. `step` is a length far below the finest leaf's: how far
// the first step goes. The field and the octree must outlive the filter.
std::unique_ptr<MembershipFilter> make_label_filter(const topology::ScalarField& field,
                                                    const topology::OctreeView& octree,
                                                    const std::vector<bool>& kept, double step);

// The paper's filter: the ascent from x ends at a maximum, whose set of maxima is kept or not. A
// set has the component of the leaf that its highest maximum lies in. Runs the Morse engine on the
// octree's box (seconds to minutes); throws what that throws.
std::unique_ptr<MembershipFilter> make_streamline_filter(const topology::ScalarField& field,
                                                         const topology::OctreeView& octree,
                                                         const std::vector<bool>& kept,
                                                         const topology::Execution& execution = {});

}  // namespace morsel::geom
