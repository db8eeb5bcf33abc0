// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/streamline_labels.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include "topology/morse/field_descent.h"
#include "topology/morse/membership.h"
#include "topology/morse/perturbed_field.h"

namespace morsel::topology {
namespace {

constexpr std::size_t kGrain = 256;
constexpr std::size_t kListed = 1000;

// A point of S in the model's box: where the cascade retracts S to.
std::optional<Imath::V3d> point_inside(const LocalModel& model) {
  const Interval range = model.range();
  if (range.hi < 0.0) return std::nullopt;
  if (range.lo >= 0.0) return model.centre;
  for (int axis = 0; axis < 3; ++axis) {
    if (model.half[axis] == 0.0) continue;
    const Interval slope = model.gradient_range(axis);
    if (slope.lo >= 0.0) return point_inside(model.on_face(axis, 1));
    if (slope.hi <= 0.0) return point_inside(model.on_face(axis, -1));
  }
  return std::nullopt;
}

// The same in a cell whose own model need not show it: cells may have been decided by their parts.
std::optional<Imath::V3d> point_in_cell(const ScalarField& field, const Box& box, int depth) {
  constexpr int kDepth = 4;
  auto point = point_inside(field.model(box));
  for (int i = 0; i < 8 && !point && depth < kDepth; ++i)
    point = point_in_cell(field, child_box(box, i), depth + 1);
  return point;
}

// Numbers the sets by decreasing volume, as every component table is.
void renumber(MorseComplex& complex, std::vector<Component>& table,
              std::vector<std::uint32_t>& label) {
  std::vector<std::uint32_t> order(table.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return table[a].volume_lo + table[a].volume_hi > table[b].volume_lo + table[b].volume_hi;
  });
  std::vector<std::uint32_t> id(table.size());
  std::vector<Component> sorted;
  std::vector<MorseSet> sets;
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    id[order[i]] = i;
    sorted.push_back(table[order[i]]);
    sets.push_back(complex.sets[order[i]]);
  }
  table = std::move(sorted);
  complex.sets = std::move(sets);
  for (CriticalPoint& p : complex.points)
    if (p.set != kNoSet) p.set = id[p.set];
  for (std::uint32_t& l : label)
    if (l != kNoSet) l = id[l];
  complex.main = table.empty() ? kNoSet : main_component(table);
}

// For rendering, a cell without a label belongs to the set that has most of its certified
// component's cells, by volume. `certified` and `label` of every leaf; the result by component.
std::vector<std::uint32_t> most_likely_sets(const std::vector<OctreeView::Leaf>& leaves,
                                            const std::vector<std::uint32_t>& certified,
                                            const std::vector<std::uint32_t>& label,
                                            std::size_t components) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> volumes;  // of component and set
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (label[i] == kNoSet || certified[i] == kNoComponent) continue;
    const Imath::V3d size = leaves[i].box.max - leaves[i].box.min;
    volumes[{certified[i], label[i]}] += size.x * size.y * size.z;
  }
  std::vector<std::uint32_t> set(components, kNoSet);
  std::vector<double> largest(components, 0.0);
  for (const auto& [pair, volume] : volumes) {
    if (volume <= largest[pair.first]) continue;
    largest[pair.first] = volume;
    set[pair.first] = pair.second;
  }
  return set;
}

}  // namespace

void label_by_streamlines(const ScalarField& field, MorseComplex& complex, Topology& topology,
                          const Execution& execution) {
  std::vector<OctreeView::Leaf> leaves;
  const OctreeView octree = topology.octree();
  octree.for_each_leaf([&](const OctreeView::Leaf& leaf) {
    if (octree.nodes[leaf.node].cell_content() != Content::kEmpty) leaves.push_back(leaf);
  });
  const auto undecided = [&](std::size_t i) {
    return topology.nodes[leaves[i].node].cell_content() == Content::kUndecided;
  };
  // Cells hold F's solid; ascents are those of the field whose maxima and basins are known.
  std::optional<PerturbedField> seen;
  if (complex.perturbation > 0.0) seen = perturbed(field, topology.box, complex.perturbation);
  const StreamlineMembership membership(seen ? static_cast<const ScalarField&>(*seen) : field,
                                        topology.box, complex.points);
  std::vector<std::uint32_t> label(leaves.size(), kNoSet);
  if (execution.progress) execution.progress(0.0, "ascents from cells");
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), kGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      execution.check_cancel();
                      FieldDescent fields(field, topology.box);
                      StreamlineTracer tracer = membership.make_tracer();
                      for (std::size_t i = range.begin(); i < range.end(); ++i) {
                        if (undecided(i)) continue;
                        const auto start =
                            point_in_cell(fields.at(leaves[i].box), leaves[i].box, 0);
                        if (!start) continue;
                        if (const auto set = membership.set_of(*start, tracer)) label[i] = *set;
                      }
                    });

  std::vector<Component> table(complex.sets.size());
  for (std::size_t s = 0; s < table.size(); ++s) {
    table[s].maxima = complex.sets[s].maxima;
    table[s].seed = complex.points[complex.sets[s].highest].position;
  }
  topology.unresolved.clear();
  topology.unresolved_cells = topology.unresolved_faces = 0;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const Box& box = leaves[i].box;
    if (label[i] == kNoSet) {
      // What is proved of the cell says nothing of its component: stored as undecided.
      OctreeNode& node = topology.nodes[leaves[i].node];
      // A full cell may have been proved by its parts, which proves nothing of single faces.
      if (node.cell_content() == Content::kFull)
        for (int face = 0; face < 6; ++face)
          node.set_face_content(face / 2, face % 2, Content::kUndecided);
      node.content = static_cast<std::uint8_t>(Content::kUndecided);
      ++topology.unresolved_cells;
      if (topology.unresolved.size() < kListed)
        topology.unresolved.push_back({box, field.value(centre(box))});
      continue;
    }
    const Imath::V3d size = box.max - box.min;
    const double volume = size.x * size.y * size.z;
    const bool full = topology.nodes[leaves[i].node].cell_content() == Content::kFull;
    Component& c = table[label[i]];
    if (full && volume > c.seed_volume) {
      c.seed = centre(box);
      c.seed_volume = volume;
    }
    ++c.cells;
    c.bounds.extendBy(box);
    c.volume_hi += volume;
    if (full) c.volume_lo += volume;
  }
  // A maximum that only the perturbed field has may lie in no cell.
  for (Component& c : table)
    if (c.cells == 0) c.bounds.extendBy(c.seed);
  std::vector<std::uint32_t> certified(leaves.size());
  for (std::size_t i = 0; i < leaves.size(); ++i)
    certified[i] = topology.nodes[leaves[i].node].component;
  const std::vector<std::uint32_t> likely =
      most_likely_sets(leaves, certified, label, topology.components.size());
  for (std::size_t i = 0; i < leaves.size(); ++i)
    if (label[i] == kNoSet && certified[i] != kNoComponent) label[i] = likely[certified[i]];
  renumber(complex, table, label);
  for (OctreeNode& node : topology.nodes) node.component = kNoComponent;
  for (std::size_t i = 0; i < leaves.size(); ++i)
    if (label[i] != kNoSet) topology.nodes[leaves[i].node].component = label[i];
  topology.components = std::move(table);
  // Proved, as the critical points are: every component has a maximum, and each 2-saddle joins two
  // at most.
  topology.certified = false;
  const std::uint64_t maxima = complex.count(CriticalType::kMaximum),
                      saddles = complex.count(CriticalType::kSaddle2);
  topology.components_hi = maxima;
  topology.components_lo = maxima > saddles ? maxima - saddles : std::min<std::uint64_t>(maxima, 1);
  if (complex.unresolved_boxes > 0 || topology.touches_box ||
      complex.count(CriticalType::kDegenerate) > 0) {
    topology.components_lo = std::min<std::uint64_t>(maxima, 1);
    topology.components_hi.reset();
  }
}

}  // namespace morsel::topology
