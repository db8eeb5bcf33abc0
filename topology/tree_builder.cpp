// SPDX-License-Identifier: Apache-2.0
#include "topology/tree_builder.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <memory>

#include "topology/cascade.h"

namespace morsel::topology {
namespace {

// Cells above this depth are tasks of their own; 8^5 tasks are plenty for any machine and each is
// long enough to be worth stealing.
constexpr int kTaskDepth = 5;

}  // namespace

void TreeBuilder::check_cancel() const {
  if (execution_.cancel != nullptr && execution_.cancel->load(std::memory_order_relaxed))
    throw Cancelled();
}

void TreeBuilder::report(double volume) {
  if (!execution_.progress) return;
  const std::lock_guard lock(progress_mutex_);
  done_ += volume;
  execution_.progress(done_, "labelling");
}

OctreeNode TreeBuilder::classify_cell(const ScalarField& field, const Box& cell, int depth,
                                      bool& divide) {
  models_.fetch_add(1, std::memory_order_relaxed);
  const LocalModel model = field.model(cell);
  const Content content = classify(model);
  OctreeNode node;
  node.content = static_cast<std::uint8_t>(content);
  const bool holds_surface = content == Content::kConnected || content == Content::kUndecided;
  divide = holds_surface && (depth < options_.min_depth ||
                             (content == Content::kUndecided && depth < options_.max_depth));
  if (divide) return node;
  if (holds_surface) {
    classify_faces(model, node);
  } else {
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) node.set_face_content(axis, side, content);
  }
  return node;
}

void TreeBuilder::grow(const ScalarField& field, const Box& cell, int depth,
                       std::vector<OctreeNode>& nodes, std::size_t index) {
  bool divide = false;
  OctreeNode node = classify_cell(field, cell, depth, divide);
  if (!divide) {
    nodes[index] = node;
    return;
  }
  const std::unique_ptr<ScalarField> local = field.restricted_to(cell);
  node.first_child = static_cast<std::uint32_t>(nodes.size());
  nodes[index] = node;
  nodes.resize(nodes.size() + 8);
  for (int i = 0; i < 8; ++i)
    grow(*local, child_box(cell, i), depth + 1, nodes,
         node.first_child + static_cast<std::uint32_t>(i));
}

std::vector<OctreeNode> TreeBuilder::grow_children(const ScalarField& field, const Box& cell,
                                                   int depth) {
  const std::unique_ptr<ScalarField> local = field.restricted_to(cell);
  std::array<std::vector<OctreeNode>, 8> parts;
  tbb::parallel_for(0, 8,
                    [&](int i) { parts[i] = grow_task(*local, child_box(cell, i), depth + 1); });
  // When another task threw, a nested loop returns without having called its body, and the
  // exception goes on its way from the outermost one.
  for (const auto& part : parts)
    if (part.empty()) throw Cancelled();
  // Children first, so that they are neighbours; then each child's descendants.
  std::size_t total = 0;
  for (const auto& part : parts) total += part.size();
  std::vector<OctreeNode> nodes;
  nodes.reserve(total);
  std::array<std::uint32_t, 8> shift;  // from a part's own index to the joint one
  std::uint32_t offset = 8;
  for (int i = 0; i < 8; ++i) {
    shift[i] = offset - 1;
    offset += static_cast<std::uint32_t>(parts[i].size()) - 1;
    OctreeNode root = parts[i][0];
    if (!root.is_leaf()) root.first_child += shift[i];
    nodes.push_back(root);
  }
  for (int i = 0; i < 8; ++i) {
    for (std::size_t j = 1; j < parts[i].size(); ++j) {
      OctreeNode node = parts[i][j];
      if (!node.is_leaf()) node.first_child += shift[i];
      nodes.push_back(node);
    }
    parts[i] = {};
  }
  return nodes;
}

std::vector<OctreeNode> TreeBuilder::grow_task(const ScalarField& field, const Box& cell,
                                               int depth) {
  check_cancel();
  const double volume = std::ldexp(1.0, -3 * depth);
  std::vector<OctreeNode> nodes(1);
  if (depth >= kTaskDepth) {
    grow(field, cell, depth, nodes, 0);
    report(volume);
    return nodes;
  }
  bool divide = false;
  nodes[0] = classify_cell(field, cell, depth, divide);
  if (!divide) {
    report(volume);
    return nodes;
  }
  const std::vector<OctreeNode> below = grow_children(field, cell, depth);
  nodes[0].first_child = 1;
  nodes.reserve(below.size() + 1);
  for (OctreeNode node : below) {
    if (!node.is_leaf()) node.first_child += 1;
    nodes.push_back(node);
  }
  return nodes;
}

std::vector<OctreeNode> TreeBuilder::build() { return grow_task(field_, box_, 0); }

void TreeBuilder::subdivide(std::vector<OctreeNode>& nodes, const std::vector<bool>& marked) {
  // The marked leaves below one cell of kTaskDepth form a task: it restricts the field on its way
  // down.
  struct Found {
    std::uint32_t node;
    std::vector<OctreeNode> below;
  };
  struct Task {
    std::uint32_t node;
    int depth;
    Box box;
    std::vector<Found> found;
  };
  std::vector<Task> tasks;
  const auto collect = [&](auto&& self, std::uint32_t node, int depth, const Box& box) -> void {
    if (nodes[node].is_leaf() || depth == kTaskDepth) {
      tasks.push_back({node, depth, box, {}});
      return;
    }
    for (int i = 0; i < 8; ++i)
      self(self, nodes[node].first_child + i, depth + 1, child_box(box, i));
  };
  collect(collect, 0, 0, box_);

  const auto any_marked = [&](auto&& self, std::uint32_t node) -> bool {
    if (nodes[node].is_leaf()) return marked[node];
    for (int i = 0; i < 8; ++i)
      if (self(self, nodes[node].first_child + i)) return true;
    return false;
  };
  const auto descend = [&](auto&& self, const ScalarField& field, std::uint32_t node, int depth,
                           const Box& box, std::vector<Found>& found) -> void {
    if (!any_marked(any_marked, node)) return;
    const std::unique_ptr<ScalarField> local = field.restricted_to(box);
    if (!nodes[node].is_leaf()) {
      for (int i = 0; i < 8; ++i)
        self(self, *local, nodes[node].first_child + i, depth + 1, child_box(box, i), found);
      return;
    }
    Found f{node, std::vector<OctreeNode>(8)};
    for (int i = 0; i < 8; ++i)
      grow(*local, child_box(box, i), depth + 1, f.below, static_cast<std::size_t>(i));
    found.push_back(std::move(f));
  };
  tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
    check_cancel();
    Task& task = tasks[i];
    descend(descend, field_, task.node, task.depth, task.box, task.found);
  });
  for (const Task& task : tasks) {
    for (const Found& f : task.found) {
      const auto shift = static_cast<std::uint32_t>(nodes.size());
      nodes[f.node] = OctreeNode{};
      nodes[f.node].first_child = shift;
      nodes[f.node].content = static_cast<std::uint8_t>(Content::kUndecided);
      for (OctreeNode node : f.below) {
        if (!node.is_leaf()) node.first_child += shift;
        nodes.push_back(node);
      }
    }
  }
}

}  // namespace morsel::topology
