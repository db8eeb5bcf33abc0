// SPDX-License-Identifier: Apache-2.0
#include "topology/tree_builder.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "topology/adjacency.h"
#include "topology/cascade.h"
#include "topology/checkpoint.h"
#include "topology/vanishing.h"

namespace morsel::topology {
namespace {

// Depth of the trees: at most 8^4, plenty for any machine, and each long enough to be worth
// stealing.
constexpr int kTreeDepth = 4;
constexpr unsigned kAllChildren = 0xffu;
// Wide boxes may be without bounds, but not such parts of the whole.
constexpr int kBoundedDepth = 10;

bool may_hold_surface(Content content) {
  return content == Content::kConnected || content == Content::kUndecided;
}

bool has_undecided_face(const OctreeNode& node) {
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      if (node.face_content(axis, side) == Content::kUndecided) return true;
  return false;
}

OctreeNode leaf_without_surface(Content content) {
  OctreeNode node;
  node.content = static_cast<std::uint8_t>(content);
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) node.set_face_content(axis, side, content);
  return node;
}

}  // namespace

void TreeBuilder::report(double volume) {
  if (!execution_.progress) return;
  const std::lock_guard lock(progress_mutex_);
  done_ += volume;
  execution_.progress(done_, "labelling");
}

void TreeBuilder::charge(std::uint64_t nodes) {
  // Each node is there twice when the octree is put together.
  constexpr std::uint64_t kEach = 2 * sizeof(OctreeNode);
  const std::uint64_t all = nodes_.fetch_add(nodes, std::memory_order_relaxed) + nodes;
  if (execution_.max_bytes != 0 && all * kEach > execution_.max_bytes)
    throw MemoryLimit(fmt::format(
        "the octree has reached {} nodes, which is as many as {} MiB allow: allow more memory, a "
        "smaller box or a lower max_depth",
        all, execution_.max_bytes >> 20));
}

bool TreeBuilder::must_divide(Content content, int depth) const {
  return may_hold_surface(content) &&
         (depth < options_.min_depth ||
          (content == Content::kUndecided && depth < options_.max_depth));
}

void TreeBuilder::check_finite(const Box& cell, int depth, double value_error) const {
  if (std::isfinite(value_error)) return;
  const double value = field_.value(centre(cell));
  if (!std::isfinite(value) || depth >= kBoundedDepth) throw NotFinite(centre(cell), value);
}

void TreeBuilder::divide(const ScalarField& local, const Box& cell, int depth,
                         std::vector<OctreeNode>& nodes, std::uint32_t index) {
  execution_.check_cancel();
  ModelBatch batch;
  BatchContent content;
  local.child_models(cell, kAllChildren, batch);
  classify_batch(batch, kAllChildren, content);
  models_.fetch_add(8, std::memory_order_relaxed);
  charge(8);
  const auto first = static_cast<std::uint32_t>(nodes.size());
  nodes[index] = OctreeNode{};
  nodes[index].first_child = first;
  nodes[index].content = static_cast<std::uint8_t>(Content::kUndecided);
  nodes.resize(first + 8);
  unsigned divided = 0, surface = 0, final = 0;
  for (unsigned i = 0; i < 8; ++i) {
    if (content.cell[i] == Content::kUndecided && depth + 1 >= options_.min_depth &&
        vanishes_along_edge(local, batch[static_cast<int>(i)]))
      final |= 1u << i;
    if (must_divide(content.cell[i], depth + 1) && (final >> i & 1u) == 0)
      divided |= 1u << i;
    else if (may_hold_surface(content.cell[i]))
      surface |= 1u << i;
  }
  if (surface != 0) classify_batch_faces(batch, surface, content);
  for (unsigned i = 0; i < 8; ++i) {
    if ((divided >> i) & 1u) {
      const Box child = child_box(cell, static_cast<int>(i));
      check_finite(child, depth + 1, batch.value_error[i]);
      divide(*local.restricted_to(child), child, depth + 1, nodes, first + i);
    } else if ((surface >> i) & 1u) {
      nodes[first + i].content = static_cast<std::uint8_t>(content.cell[i]);
      nodes[first + i].faces = content.faces[i];
      const bool faces_known =
          content.cell[i] == Content::kUndecided || !has_undecided_face(nodes[first + i]);
      if (final >> i & 1u ||
          (!faces_known && vanishes_along_edge(local, batch[static_cast<int>(i)])))
        nodes[first + i].reserved = kNotToBeDivided;
    } else {
      nodes[first + i] = leaf_without_surface(content.cell[i]);
    }
  }
  // Eight empty children say no more than one empty cell, nor do eight full ones.
  const OctreeNode& one = nodes[first];
  if (nodes.size() == first + 8 && !may_hold_surface(one.cell_content()) &&
      std::all_of(nodes.begin() + first, nodes.end(),
                  [&](const OctreeNode& n) { return n.content == one.content; })) {
    nodes[index] = leaf_without_surface(one.cell_content());
    nodes.resize(first);
    nodes_.fetch_sub(8, std::memory_order_relaxed);
  }
}

void TreeBuilder::grow(std::uint32_t index, Tree& tree) {
  execution_.check_cancel();
  if (execution_.checkpoint != nullptr) {
    tree.nodes = execution_.checkpoint->take(index);
    if (!tree.nodes.empty()) {
      charge(tree.nodes.size());
      report(std::ldexp(1.0, -3 * tree.depth));
      return;
    }
  }
  const std::unique_ptr<ScalarField> local = field_.restricted_to(tree.box);
  models_.fetch_add(1, std::memory_order_relaxed);
  const LocalModel model = local->model(tree.box);
  const Content content = classify(model);
  tree.nodes.assign(1, leaf_without_surface(content));
  charge(1);
  if (must_divide(content, tree.depth)) {
    divide(*local, tree.box, tree.depth, tree.nodes, 0);
    resolve_inside(tree);
    tree.nodes.shrink_to_fit();
  } else if (may_hold_surface(content)) {
    classify_faces(model, tree.nodes[0]);
  }
  if (execution_.checkpoint != nullptr &&
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count() >=
          execution_.checkpoint_after)
    execution_.checkpoint->save(index, tree.nodes);
  report(std::ldexp(1.0, -3 * tree.depth));
}

void TreeBuilder::divide_leaves(Tree& tree, std::span<const std::uint32_t> leaves) {
  if (leaves.empty()) return;
  std::vector<bool> marked(tree.nodes.size(), false);
  for (const std::uint32_t leaf : leaves) marked[leaf] = true;
  const auto mark_parents = [&](auto&& self, std::uint32_t node) -> bool {
    if (tree.nodes[node].is_leaf()) return marked[node];
    bool any = false;
    for (std::uint32_t i = 0; i < 8; ++i)
      if (self(self, tree.nodes[node].first_child + i)) any = true;
    marked[node] = any;
    return any;
  };
  if (!mark_parents(mark_parents, 0)) return;
  // `field` holds on the cell's parent.
  const auto descend = [&](auto&& self, const ScalarField& field, std::uint32_t node, int depth,
                           const Box& box) -> void {
    const std::unique_ptr<ScalarField> local = field.restricted_to(box);
    if (tree.nodes[node].is_leaf()) {
      divide(*local, box, depth, tree.nodes, node);
      return;
    }
    const std::uint32_t first = tree.nodes[node].first_child;
    for (std::uint32_t i = 0; i < 8; ++i)
      if (marked[first + i])
        self(self, *local, first + i, depth + 1, child_box(box, static_cast<int>(i)));
  };
  descend(descend, field_, 0, tree.depth, tree.box);
}

void TreeBuilder::resolve_inside(Tree& tree) {
  std::vector<std::uint32_t> leaves;
  do {
    leaves.clear();
    const auto visit = [&](std::uint32_t a, std::uint32_t b, int axis, int depth_a, int depth_b) {
      const Remedy remedy =
          remedy_of(tree.nodes[a], tree.nodes[b], axis, depth_a, depth_b, options_.max_depth);
      if (remedy != Remedy::kNone) leaves.push_back(remedy == Remedy::kDivideLower ? a : b);
    };
    faces_inside(tree.nodes, 0, tree.depth, visit);
    divide_leaves(tree, leaves);
  } while (!leaves.empty());
}

void TreeBuilder::resolve_between(Forest& forest) {
  const std::vector<TreePair> pairs = neighbouring_trees(forest);
  std::vector<bool> changed(forest.trees.size(), true);
  for (bool any = true; any;) {
    execution_.check_cancel();
    // What each pair finds, so that the result does not depend on the order of the pairs.
    struct Found {
      std::vector<std::uint32_t> lower, upper;
    };
    std::vector<Found> found(pairs.size());
    tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t n) {
      const TreePair& pair = pairs[n];
      if (!changed[pair.lower] && !changed[pair.upper]) return;
      const Tree &lower = forest.trees[pair.lower], &upper = forest.trees[pair.upper];
      const auto visit = [&](std::uint32_t a, std::uint32_t b, int axis, int depth_a, int depth_b) {
        const Remedy remedy =
            remedy_of(lower.nodes[a], upper.nodes[b], axis, depth_a, depth_b, options_.max_depth);
        if (remedy == Remedy::kDivideLower) found[n].lower.push_back(a);
        if (remedy == Remedy::kDivideUpper) found[n].upper.push_back(b);
      };
      faces_across(lower.nodes, 0, upper.nodes, 0, pair.axis, lower.depth, upper.depth, visit);
    });
    std::vector<std::vector<std::uint32_t>> leaves(forest.trees.size());
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      auto& lower = leaves[pairs[n].lower];
      lower.insert(lower.end(), found[n].lower.begin(), found[n].lower.end());
      auto& upper = leaves[pairs[n].upper];
      upper.insert(upper.end(), found[n].upper.begin(), found[n].upper.end());
    }
    any = false;
    for (std::size_t t = 0; t < leaves.size(); ++t) {
      changed[t] = !leaves[t].empty();
      any = any || changed[t];
    }
    tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t t) {
      if (leaves[t].empty()) return;
      divide_leaves(forest.trees[t], leaves[t]);
      resolve_inside(forest.trees[t]);
    });
  }
}

Forest TreeBuilder::plan() {
  Forest forest;
  forest.box = box_;
  forest.upper.resize(1);
  const auto descend = [&](auto&& self, std::uint32_t node, const Tree& cell) -> void {
    bool ends = cell.depth == kTreeDepth;
    if (!ends) {
      models_.fetch_add(1, std::memory_order_relaxed);
      const LocalModel model = field_.model(cell.box);
      ends = !must_divide(classify(model), cell.depth);
      if (!ends) check_finite(cell.box, cell.depth, model.value_error);
    }
    if (ends) {
      forest.upper[node].tree = static_cast<std::uint32_t>(forest.trees.size());
      forest.trees.push_back(cell);
      return;
    }
    const auto first = static_cast<std::uint32_t>(forest.upper.size());
    forest.upper[node].first_child = first;
    forest.upper.resize(first + 8);
    for (unsigned i = 0; i < 8; ++i) {
      Tree child;
      child.box = child_box(cell.box, static_cast<int>(i));
      child.depth = cell.depth + 1;
      for (int axis = 0; axis < 3; ++axis)
        child.place[axis] = 2 * cell.place[axis] + ((i >> axis) & 1u);
      self(self, first + i, child);
    }
  };
  Tree root;
  root.box = box_;
  descend(descend, 0, root);
  return forest;
}

Forest TreeBuilder::build() {
  execution_.check_cancel();
  Forest forest = plan();
  tbb::parallel_for(std::size_t{0}, forest.trees.size(),
                    [&](std::size_t i) { grow(static_cast<std::uint32_t>(i), forest.trees[i]); });
  // When the loop is within another that was cancelled, it may return without having called its
  // body, and the exception goes on its way from the outer one.
  for (const Tree& tree : forest.trees)
    if (tree.nodes.empty()) throw Cancelled();
  resolve_between(forest);
  return forest;
}

}  // namespace morsel::topology
