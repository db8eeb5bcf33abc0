// SPDX-License-Identifier: Apache-2.0
#include "topology/component_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <numeric>

#include "topology/bound_solid.h"
#include "topology/component_bounds.h"
#include "topology/tree_labels.h"
#include "topology/union_find.h"

namespace morsel::topology {
namespace {

Box shared_rectangle(const Box& lower, const Box& upper, int axis) {
  Box r(Imath::V3d(std::max(lower.min.x, upper.min.x), std::max(lower.min.y, upper.min.y),
                   std::max(lower.min.z, upper.min.z)),
        Imath::V3d(std::min(lower.max.x, upper.max.x), std::min(lower.max.y, upper.max.y),
                   std::min(lower.max.z, upper.max.z)));
  r.max[axis] = r.min[axis] = lower.max[axis];
  return r;
}

// The box of one leaf. Slow: for the few that are reported.
Box box_of_leaf(const Tree& tree, std::uint32_t node) {
  Box found;
  for_each_leaf_of(tree, [&](std::uint32_t n, int, const Box& box) {
    if (n == node) found = box;
  });
  return found;
}

// All trees' pieces under one numbering.
class Labelling {
 public:
  Labelling(Forest& forest, const Execution& execution)
      : forest_(forest),
        pairs_(neighbouring_trees(forest)),
        trees_(forest.trees.size()),
        between_(pairs_.size()),
        first_(forest.trees.size() + 1, 0) {
    std::atomic<std::size_t> finished{0};
    tbb::parallel_for(std::size_t{0}, trees_.size(), [&](std::size_t t) {
      execution.check_cancel();
      trees_[t] = label_tree(forest_.trees[t], forest_.box);
      ++finished;
    });
    tbb::parallel_for(std::size_t{0}, pairs_.size(), [&](std::size_t n) {
      execution.check_cancel();
      between_[n] = label_pair(forest_.trees[pairs_[n].lower], forest_.trees[pairs_[n].upper],
                               pairs_[n].axis);
      ++finished;
    });
    // As in TreeBuilder::build.
    if (finished != trees_.size() + pairs_.size()) throw Cancelled();
    for (std::size_t t = 0; t < trees_.size(); ++t)
      first_[t + 1] = first_[t] + static_cast<std::uint32_t>(trees_[t].pieces.size());
  }

  std::uint32_t count() const { return first_.back(); }
  const std::vector<TreeLabels>& trees() const { return trees_; }
  std::uint32_t piece(std::size_t tree, std::uint32_t local) const { return first_[tree] + local; }

  UnionFind certain_joins() const {
    UnionFind joins(count());
    for (std::size_t n = 0; n < pairs_.size(); ++n)
      for (const auto& [a, b] : between_[n].certain)
        joins.unite(piece(pairs_[n].lower, a), piece(pairs_[n].upper, b));
    return joins;
  }

  // visit(piece, piece) for joins that are possible only.
  template <class Visit>
  void for_each_possible(Visit&& visit) const {
    for (std::size_t t = 0; t < trees_.size(); ++t)
      for (const auto& [a, b] : trees_[t].possible) visit(piece(t, a), piece(t, b));
    for (std::size_t n = 0; n < pairs_.size(); ++n)
      for (const auto& [a, b] : between_[n].possible)
        visit(piece(pairs_[n].lower, a), piece(pairs_[n].upper, b));
  }

  // The undecided rectangles between cells that are not joined elsewhere, and how many there are.
  // Those between joined cells change nothing.
  std::uint64_t undecided_faces(UnionFind& certain, std::vector<Box>& out,
                                std::size_t at_most) const {
    std::uint64_t all = 0;
    const auto add = [&](std::size_t lower_tree, std::uint32_t a, std::size_t upper_tree,
                         std::uint32_t b, int axis) {
      const Tree &lower = forest_.trees[lower_tree], &upper = forest_.trees[upper_tree];
      if (certain.find(piece(lower_tree, lower.nodes[a].component)) ==
          certain.find(piece(upper_tree, upper.nodes[b].component)))
        return;
      ++all;
      if (out.size() < at_most)
        out.push_back(shared_rectangle(box_of_leaf(lower, a), box_of_leaf(upper, b), axis));
    };
    for (std::size_t t = 0; t < trees_.size(); ++t)
      for (const auto& [a, b, axis] : trees_[t].undecided_faces)
        add(t, a, t, b, static_cast<int>(axis));
    for (std::size_t n = 0; n < pairs_.size(); ++n)
      for (const auto& [a, b] : between_[n].undecided_faces)
        add(pairs_[n].lower, a, pairs_[n].upper, b, pairs_[n].axis);
    return all;
  }

  // Writes id[piece] as the component of every leaf, and takes back what only the build wanted.
  void write(const std::vector<std::uint32_t>& id) {
    tbb::parallel_for(std::size_t{0}, trees_.size(), [&](std::size_t t) {
      for (OctreeNode& node : forest_.trees[t].nodes) {
        node.reserved = 0;
        if (node.is_leaf() && node.component != kNoComponent)
          node.component = id[piece(t, node.component)];
      }
    });
  }

 private:
  Forest& forest_;
  std::vector<TreePair> pairs_;
  std::vector<TreeLabels> trees_;
  std::vector<PairLabels> between_;
  std::vector<std::uint32_t> first_;
};

}  // namespace

void label_components(const ScalarField& field, Forest& forest, const Execution& execution,
                      Topology& topology) {
  Labelling labelling(forest, execution);
  const std::uint32_t count = labelling.count();
  UnionFind certain = labelling.certain_joins();
  for (const TreeLabels& tree : labelling.trees()) {
    topology.leaves += tree.leaves;
    topology.depth = std::max(topology.depth, tree.depth);
    if (!topology.touches_box) topology.touches_box = tree.touches;
  }
  // A leaf's face need not show that S keeps off it: smaller pieces of the boundary may.
  if (topology.touches_box) topology.touches_box = place_where_cut(field, forest.box, execution);

  // One row per set of certainly joined pieces that hold solid, in order of the sets' first pieces.
  std::vector<std::uint32_t> row(count, kNoComponent), row_of_set(count, kNoComponent);
  std::vector<Component> rows;
  Undecided undecided;
  undecided.is_cell.assign(count, false);
  for (std::size_t t = 0; t < labelling.trees().size(); ++t) {
    const TreeLabels& tree = labelling.trees()[t];
    for (std::uint32_t i = 0; i < tree.pieces.size(); ++i) {
      const std::uint32_t piece = labelling.piece(t, i), root = certain.find(piece);
      if (tree.unresolved[i]) {
        undecided.is_cell[piece] = true;
        continue;
      }
      if (row_of_set[root] == kNoComponent) {
        row_of_set[root] = static_cast<std::uint32_t>(rows.size());
        rows.emplace_back();
      }
      row[piece] = row_of_set[root];
      merge(rows[row[piece]], tree.pieces[i]);
    }
    for (const auto& [piece, box] : tree.unresolved_cells)
      undecided.cells.emplace_back(labelling.piece(t, piece), box);
  }
  labelling.for_each_possible(
      [&](std::uint32_t a, std::uint32_t b) { undecided.joins.emplace_back(a, b); });
  const CountBounds bounds =
      bound_components(field, undecided, certain, row, topology.touches_box.has_value(), rows);
  topology.components_lo = bounds.lo;
  topology.components_hi = bounds.hi;

  std::vector<std::uint32_t> order(rows.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return rows[a].volume_lo + rows[a].volume_hi > rows[b].volume_lo + rows[b].volume_hi;
  });
  std::vector<std::uint32_t> id_of_row(rows.size());
  topology.components.clear();
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    id_of_row[order[i]] = i;
    topology.components.push_back(rows[order[i]]);
  }
  std::vector<std::uint32_t> id(count, kNoComponent);
  for (std::uint32_t i = 0; i < count; ++i)
    if (row[i] != kNoComponent) id[i] = id_of_row[row[i]];

  topology.unresolved_cells = undecided.cells.size();
  for (const auto& [piece, box] : undecided.cells) {
    if (topology.unresolved.size() == kListedUnresolved) break;
    topology.unresolved.push_back({box, field.value(centre(box))});
  }
  std::vector<Box> faces;
  topology.unresolved_faces =
      labelling.undecided_faces(certain, faces, kListedUnresolved - topology.unresolved.size());
  for (const Box& face : faces) topology.unresolved.push_back({face, field.value(centre(face))});
  topology.certified = topology.unresolved_cells == 0 && topology.unresolved_faces == 0;

  // For rendering, an unresolved cell belongs to a neighbour that it may belong to (the largest).
  for (bool changed = topology.unresolved_cells > 0; changed;) {
    changed = false;
    for (const auto& [a, b] : undecided.joins) {
      for (const auto& [cell, other] : {std::pair{a, b}, std::pair{b, a}}) {
        if (!undecided.is_cell[cell] || id[other] >= id[cell]) continue;
        id[cell] = id[other];
        changed = true;
      }
    }
  }
  labelling.write(id);
}

}  // namespace morsel::topology
