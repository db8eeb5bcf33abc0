// SPDX-License-Identifier: Apache-2.0
#include "topology/component_table.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "topology/adjacency.h"
#include "topology/union_find.h"

namespace morsel::topology {
namespace {

constexpr std::size_t kListed = 1000;  // unresolved places kept in the result

bool holds_solid(const OctreeNode& node) {
  return node.is_leaf() &&
         (node.cell_content() == Content::kConnected || node.cell_content() == Content::kFull);
}

bool is_unresolved(const OctreeNode& node) {
  return node.is_leaf() && node.cell_content() == Content::kUndecided;
}

// How many local maxima of F an unresolved cell can hold at most: 0, 1, or -1 for "no bound".
int possible_maxima(const ScalarField& field, const Box& box) {
  const LocalModel model = field.model(box);
  for (int i = 0; i < 3; ++i) {
    const Interval slope = model.gradient_range(i);
    if (slope.lo > 0.0 || slope.hi < 0.0) return 0;
    if (model.hessian_range(i, i).lo > 0.0) return 0;  // curved upwards along an axis: no maximum
  }
  // Diagonally dominant and negative: strictly concave on the cell, at most one maximum
  // (Gershgorin).
  for (int i = 0; i < 3; ++i) {
    double reach = 0.0;
    for (int j = 0; j < 3; ++j)
      if (j != i) reach += model.hessian_range(i, j).magnitude();
    if (model.hessian_range(i, i).hi + reach >= 0.0) return -1;
  }
  return 1;
}

Box shared_rectangle(const Box& lower, const Box& upper, int axis) {
  Box r(Imath::V3d(std::max(lower.min.x, upper.min.x), std::max(lower.min.y, upper.min.y),
                   std::max(lower.min.z, upper.min.z)),
        Imath::V3d(std::min(lower.max.x, upper.max.x), std::min(lower.max.y, upper.max.y),
                   std::min(lower.max.z, upper.max.z)));
  r.max[axis] = r.min[axis] = lower.max[axis];
  return r;
}

// The joins of the cell graph: certain ones, and those that an unresolved cell or face leaves
// possible.
struct Joins {
  UnionFind certain, possible;
  std::vector<std::array<std::uint32_t, 3>> undecided_faces;  // lower, upper, axis
};

Joins join_cells(const OctreeView& octree) {
  Joins joins{UnionFind(octree.nodes.size()), UnionFind(octree.nodes.size()), {}};
  for_each_face_pair(octree,
                     [&](std::uint32_t a, std::uint32_t b, int axis, int depth_a, int depth_b) {
                       const OctreeNode &lower = octree.nodes[a], &upper = octree.nodes[b];
                       const Content shared = shared_content(lower, upper, axis, depth_a, depth_b);
                       if (shared == Content::kEmpty) return;
                       joins.possible.unite(a, b);
                       if (is_unresolved(lower) || is_unresolved(upper)) return;
                       if (shared == Content::kUndecided)
                         joins.undecided_faces.push_back({a, b, static_cast<std::uint32_t>(axis)});
                       else
                         joins.certain.unite(a, b);
                     });
  return joins;
}

// The component of an unresolved cell, for rendering: that of a neighbour it may belong to (the
// largest).
void adopt_unresolved(const OctreeView& octree, std::vector<OctreeNode>& nodes) {
  bool changed = true;
  while (changed) {
    changed = false;
    for_each_face_pair(
        octree, [&](std::uint32_t a, std::uint32_t b, int axis, int depth_a, int depth_b) {
          if (shared_content(nodes[a], nodes[b], axis, depth_a, depth_b) == Content::kEmpty) return;
          for (const auto& [cell, other] : {std::pair{a, b}, std::pair{b, a}}) {
            if (!is_unresolved(nodes[cell]) || nodes[other].component >= nodes[cell].component)
              continue;
            nodes[cell].component = nodes[other].component;
            changed = true;
          }
        });
  }
}

}  // namespace

void label_components(const ScalarField& field, Topology& topology) {
  const OctreeView octree = topology.octree();
  std::vector<OctreeNode>& nodes = topology.nodes;
  Joins joins = join_cells(octree);

  // One row per set of certainly joined cells, in order of the sets' first cells.
  std::map<std::uint32_t, std::uint32_t> row_of_root;
  std::vector<Component> rows;
  std::vector<double> full_volume;
  std::vector<std::uint32_t> row(nodes.size(), kNoComponent);
  std::vector<bool> solid_group(nodes.size(), false);
  std::map<std::uint32_t, Box>
      special;  // boxes of unresolved cells and of cells at undecided faces
  for (const auto& face : joins.undecided_faces) {
    special.emplace(face[0], Box());
    special.emplace(face[1], Box());
  }
  std::vector<std::uint32_t> root_row(nodes.size(), kNoComponent);
  octree.for_each_leaf([&](const OctreeView::Leaf& leaf) {
    ++topology.leaves;
    topology.depth = std::max(topology.depth, leaf.depth);
    const OctreeNode& node = nodes[leaf.node];
    if (is_unresolved(node)) {
      special[leaf.node] = leaf.box;
    } else if (const auto it = special.find(leaf.node); it != special.end()) {
      it->second = leaf.box;
    }
    if (node.cell_content() != Content::kEmpty && !topology.touches_box) {
      for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
          const double plane = side == 0 ? topology.box.min[axis] : topology.box.max[axis];
          const double own = side == 0 ? leaf.box.min[axis] : leaf.box.max[axis];
          if (own != plane || node.face_content(axis, side) == Content::kEmpty) continue;
          Imath::V3d place = centre(leaf.box);
          place[axis] = plane;
          topology.touches_box = place;
        }
      }
    }
    if (!holds_solid(node)) return;
    const std::uint32_t root = joins.certain.find(leaf.node);
    if (root_row[root] == kNoComponent) {
      root_row[root] = static_cast<std::uint32_t>(rows.size());
      rows.emplace_back();
    }
    row[leaf.node] = root_row[root];
    solid_group[joins.possible.find(leaf.node)] = true;
    Component& c = rows[row[leaf.node]];
    const Imath::V3d size = leaf.box.max - leaf.box.min;
    const double volume = size.x * size.y * size.z;
    const bool full = node.cell_content() == Content::kFull;
    // The largest full cell is the most inward place known; without one, any cell's centre.
    if (c.cells == 0 || (full && volume > c.seed_volume)) {
      c.seed = centre(leaf.box);
      if (full) c.seed_volume = volume;
    }
    ++c.cells;
    c.bounds.extendBy(leaf.box);
    c.volume_hi += volume;
    if (full) c.volume_lo += volume;
  });

  std::vector<std::uint32_t> order(rows.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return rows[a].volume_lo + rows[a].volume_hi > rows[b].volume_lo + rows[b].volume_hi;
  });
  std::vector<std::uint32_t> id(rows.size());
  topology.components.clear();
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    id[order[i]] = i;
    topology.components.push_back(rows[order[i]]);
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
    nodes[i].component = row[i] == kNoComponent ? kNoComponent : id[row[i]];

  // Bounds of the count: see topology/README.md.
  std::uint64_t lower = 0;
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    if (solid_group[i] && joins.possible.find(i) == i) ++lower;
  topology.components_lo = lower;
  std::optional<std::uint64_t> upper = topology.components.size();
  for (const auto& [node, box] : special) {
    if (!is_unresolved(nodes[node])) continue;
    ++topology.unresolved_cells;
    if (topology.unresolved.size() < kListed)
      topology.unresolved.push_back({box, field.value(centre(box))});
    // A maximum on the domain's own boundary need not be a critical point.
    const int maxima = topology.touches_box ? -1 : possible_maxima(field, box);
    if (maxima < 0)
      upper.reset();
    else if (upper)
      *upper += static_cast<std::uint64_t>(maxima);
  }
  topology.components_hi = upper;
  topology.unresolved_faces = joins.undecided_faces.size();
  for (const auto& face : joins.undecided_faces) {
    if (topology.unresolved.size() >= kListed) break;
    const Box rectangle =
        shared_rectangle(special[face[0]], special[face[1]], static_cast<int>(face[2]));
    topology.unresolved.push_back({rectangle, field.value(centre(rectangle))});
  }
  topology.certified = topology.unresolved_cells == 0 && topology.unresolved_faces == 0;
  if (topology.unresolved_cells > 0) adopt_unresolved(octree, nodes);
}

}  // namespace morsel::topology
