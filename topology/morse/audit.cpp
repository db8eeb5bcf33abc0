// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/audit.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "topology/mesh/mesh.h"
#include "topology/morse/octree_euler.h"
#include "topology/morse/possible_joins.h"

namespace morsel::topology {
namespace {

constexpr std::size_t kListed = 100;
// Error of the mesh, part of the box's longest side. Its topology is proved whatever the error; a
// coarse one has fewer cells to prove it in.
constexpr double kMeshError = 1.0 / 128.0;

class Auditor {
 public:
  Auditor(const ScalarField& field, const Topology& certified, const MorseComplex& complex,
          const Execution& execution)
      : field_(field),
        topology_(certified),
        complex_(complex),
        execution_(execution),
        joins_(certified),
        points_open_(complex.unresolved_boxes > 0 || complex.count(CriticalType::kDegenerate) > 0),
        component_of_point_(complex.points.size(), kNoComponent) {
    audit_.component_of_set.assign(complex.sets.size(), kNoComponent);
    audit_.perturbation = complex.perturbation;
    say_what_is_open();
  }

  Audit run(const AuditOptions& options) {
    audit_.mesh_asked = options.mesh && topology_.leaves <= options.mesh_leaves;
    locate_points();
    compare_points_with_sets();
    if (!points_open_ && !topology_.touches_box) {
      compare_sets_with_components();
      look_for_missing_maxima();
      if (topology_.certified) compare_euler();
    }
    audit_.conclusive = audit_.reasons.empty();
    return std::move(audit_);
  }

 private:
  void say_what_is_open() {
    if (!topology_.certified)
      audit_.reasons.push_back(
          fmt::format("the certified engine left {} cells and {} faces undecided",
                      topology_.unresolved_cells, topology_.unresolved_faces));
    if (const auto& place = topology_.touches_box)
      audit_.reasons.push_back(fmt::format(
          "the box {} the solid near ({:.6g}, {:.6g}, {:.6g}): pieces may have no "
          "maximum inside",
          field_.value(*place) >= 0.0 ? "cuts" : "may cut", place->x, place->y, place->z));
    if (!complex_.resolved())
      audit_.reasons.push_back(fmt::format(
          "the Morse engine left {} boxes undecided, lost {} ascents and found {} degenerate "
          "points",
          complex_.unresolved_boxes, complex_.lost.size(),
          complex_.count(CriticalType::kDegenerate)));
  }

  void disagree(const Imath::V3d& place, std::string what) {
    if (audit_.disagreements.size() < kListed)
      audit_.disagreements.push_back({place, std::move(what)});
  }

  // F > 0 is proved at every critical point, so that nothing explains one in an empty cell.
  void locate_points() {
    const OctreeView octree = topology_.octree();
    group_of_point_.reserve(complex_.points.size());
    for (std::size_t i = 0; i < complex_.points.size(); ++i) {
      const CriticalPoint& p = complex_.points[i];
      const std::uint32_t leaf = octree.locate(p.position).node;
      group_of_point_.push_back(joins_.group_of_leaf(leaf));
      if (group_of_point_[i] == kNoComponent)
        disagree(p.position, fmt::format("a {} with F = {:.6g} lies in a cell that is certified to "
                                         "be empty",
                                         to_string(p.type), p.value));
      else if (octree.nodes[leaf].cell_content() != Content::kUndecided)
        component_of_point_[i] = octree.nodes[leaf].component;
    }
  }

  // An ascent that ended in a basin joins two points whatever else is open. Only undecided cells
  // can explain that the octree has them apart, and only those that lie between.
  void compare_points_with_sets() {
    std::vector<std::uint32_t> first(complex_.sets.size(), kNoSet);  // point of each set
    for (std::uint32_t i = 0; i < complex_.points.size(); ++i) {
      const CriticalPoint& p = complex_.points[i];
      if (p.set == kNoSet || group_of_point_[i] == kNoComponent) continue;
      std::uint32_t& component = audit_.component_of_set[p.set];
      if (component == kNoComponent) component = component_of_point_[i];
      if (first[p.set] == kNoSet) first[p.set] = i;
      if (group_of_point_[i] == group_of_point_[first[p.set]]) continue;
      disagree(p.position,
               fmt::format("a {} of set {} is certified to lie in component {}, the set's highest "
                           "maximum in component {}",
                           to_string(p.type), p.set, name_of(i), name_of(first[p.set])));
    }
  }

  std::string name_of(std::uint32_t point) const {
    const std::uint32_t component = component_of_point_[point];
    return component == kNoComponent ? "(undecided)" : std::to_string(component);
  }

  // Cells with one label are proved joined, so that k sets in a component are k - 1 joins that the
  // Morse engine missed. Lost ascents of 2-saddles may explain as many as there are of them.
  void compare_sets_with_components() {
    std::vector<std::uint32_t> lost_in_group(joins_.size(), 0);
    std::vector<bool> counted(complex_.points.size(), false);
    for (const LostStreamline& lost : complex_.lost) {
      const std::uint32_t group = group_of_point_[lost.point];
      if (complex_.points[lost.point].type != CriticalType::kSaddle2 || counted[lost.point] ||
          group == kNoComponent)
        continue;
      counted[lost.point] = true;
      ++lost_in_group[group];
    }
    struct Seen {
      std::uint32_t first = kNoSet;
      std::vector<std::uint32_t> others;
    };
    std::vector<Seen> seen(topology_.components.size());
    for (std::uint32_t i = 0; i < complex_.points.size(); ++i) {
      const CriticalPoint& p = complex_.points[i];
      if (p.type != CriticalType::kMaximum || p.set == kNoSet ||
          component_of_point_[i] == kNoComponent)
        continue;
      const std::uint32_t component = component_of_point_[i];
      Seen& sets = seen[component];
      if (sets.first == kNoSet) sets.first = p.set;
      if (p.set == sets.first ||
          std::find(sets.others.begin(), sets.others.end(), p.set) != sets.others.end())
        continue;
      sets.others.push_back(p.set);
      const std::uint32_t lost = lost_in_group[joins_.group_of_component(component)];
      if (sets.others.size() <= lost) continue;
      disagree(
          p.position,
          fmt::format("sets {} and {} both have a maximum in component {}{}", sets.first, p.set,
                      component,
                      lost == 0 ? "" : fmt::format(", and no more than {} joins were lost", lost)));
    }
  }

  // The maximum of F on a closed component is a critical point, and all of those are known.
  void look_for_missing_maxima() {
    std::vector<bool> found(joins_.size(), false);
    for (std::size_t i = 0; i < complex_.points.size(); ++i)
      if (complex_.points[i].type == CriticalType::kMaximum && group_of_point_[i] != kNoComponent)
        found[group_of_point_[i]] = true;
    for (std::uint32_t c = 0; c < topology_.components.size(); ++c) {
      const std::uint32_t group = joins_.group_of_component(c);
      if (found[group]) continue;
      found[group] = true;  // once is enough
      disagree(topology_.components[c].seed, fmt::format("component {} has no maximum", c));
    }
  }

  void compare_euler() {
    OctreeEuler euler = octree_euler(field_, topology_, execution_);
    if (!euler.undecided.empty()) {
      const Imath::V3d c = centre(euler.undecided.front().box);
      audit_.reasons.push_back(
          fmt::format("F is 0 to within rounding on {} edges or vertices of the octree, the first "
                      "at ({}, {}, {}): Euler characteristics were not compared",
                      euler.undecided.size(), c.x, c.y, c.z));
      return;
    }
    audit_.euler = std::move(euler.of_component);
    std::vector<MorseSet> sums(topology_.components.size());
    for (std::size_t i = 0; i < complex_.points.size(); ++i)
      if (component_of_point_[i] != kNoComponent)
        sums[component_of_point_[i]].add(complex_.points[i].type);
    for (std::uint32_t c = 0; c < sums.size(); ++c) {
      if (audit_.euler[c] == sums[c].euler()) continue;
      disagree(
          topology_.components[c].seed,
          fmt::format("the Euler characteristic of component {} is {} by the octree, and {} - {} + "
                      "{} - {} = {} by its critical points",
                      c, audit_.euler[c], sums[c].maxima, sums[c].saddles2, sums[c].saddles1,
                      sums[c].minima, sums[c].euler()));
    }
    if (audit_.mesh_asked) compare_mesh();
  }

  void compare_mesh() {
    const Imath::V3d size = topology_.box.max - topology_.box.min;
    MeshOptions options;
    options.error = kMeshError * std::max({size.x, size.y, size.z});
    const Mesh mesh =
        extract_mesh(field_, topology_.octree(),
                     std::vector<bool>(topology_.components.size(), true), options, execution_);
    if (!mesh.certified) return;  // the octree's count stands by itself
    audit_.euler_by_mesh = true;
    std::vector<bool> has_part(topology_.components.size(), false);
    for (const MeshComponent& part : mesh_components(mesh)) {
      has_part[part.component] = true;
      // A closed surface bounds a solid of half its characteristic.
      if (part.euler_characteristic == 2 * audit_.euler[part.component]) continue;
      disagree(
          topology_.components[part.component].seed,
          fmt::format("the Euler characteristic of component {} is {} by the octree, and half "
                      "of {} by the certified mesh",
                      part.component, audit_.euler[part.component], part.euler_characteristic));
    }
    for (std::uint32_t c = 0; c < has_part.size(); ++c)
      if (!has_part[c])
        disagree(topology_.components[c].seed,
                 fmt::format("component {} has no part of the certified mesh", c));
  }

  const ScalarField& field_;
  const Topology& topology_;
  const MorseComplex& complex_;
  const Execution& execution_;
  PossibleJoins joins_;
  bool points_open_;                               // critical points may be missing
  std::vector<std::uint32_t> group_of_point_;      // kNoComponent: in an empty cell
  std::vector<std::uint32_t> component_of_point_;  // kNoComponent: in an undecided or empty cell
  Audit audit_;
};

}  // namespace

std::string Audit::verdict() const {
  if (!disagreements.empty()) return "disagreed";
  return conclusive ? "agreed" : "not compared";
}

Audit audit(const ScalarField& field, const Topology& certified, const MorseComplex& complex,
            const Execution& execution, const AuditOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  if (execution.progress) execution.progress(0.0, "audit");
  Audit result = Auditor(field, certified, complex, execution).run(options);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

void adopt_labels(const Audit& audit, MorseComplex& complex, Topology& topology) {
  std::vector<MorseSet> sets(topology.components.size());
  for (std::uint32_t i = 0; i < complex.points.size(); ++i) {
    CriticalPoint& p = complex.points[i];
    if (p.set == kNoSet) continue;
    p.set = audit.component_of_set[p.set];
    if (p.set == kNoComponent) {
      p.set = kNoSet;
      continue;
    }
    MorseSet& set = sets[p.set];
    if (p.type == CriticalType::kMaximum && set.maxima == 0) set.highest = i;
    set.add(p.type);
  }
  for (std::size_t c = 0; c < sets.size(); ++c)
    topology.components[c].maxima = audit.agreed() ? sets[c].maxima : 0;
  complex.sets = std::move(sets);
  complex.main = complex.sets.empty() ? kNoSet : main_component(topology.components);
}

}  // namespace morsel::topology
