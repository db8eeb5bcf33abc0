// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "topology/certified.h"
#include "topology/octree.h"

namespace morsel::topology {

// A labelled octree as a stream of bits: two for a node, twelve more for the faces of a leaf that
// holds surface, one for a leaf's component when it is that of the leaf before. Layout: README.md.
std::vector<std::byte> pack_octree(std::span<const OctreeNode> nodes);

// The octree back, in depth-first order of groups of siblings. `nodes` and `components` are the
// numbers that there must be. Throws CacheError that begins with `where` on anything that is not
// such a stream: too deep, too few or too many nodes, components that are not in the table. Of
// `execution` cancel and progress ("reading") are used.
std::vector<OctreeNode> unpack_octree(std::span<const std::byte> bytes, std::uint64_t nodes,
                                      std::uint64_t components, const std::string& where,
                                      const Execution& execution = {});

}  // namespace morsel::topology
