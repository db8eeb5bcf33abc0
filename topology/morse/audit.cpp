// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/audit.h"

#include <fmt/format.h>

#include <chrono>

#include "topology/morse/octree_euler.h"

namespace morsel::topology {
namespace {

constexpr std::size_t kListed = 100;

void check_labels(const OctreeView& octree, const MorseComplex& complex, Audit& audit) {
  const auto disagree = [&](const Imath::V3d& place, std::string what) {
    if (audit.disagreements.size() < kListed)
      audit.disagreements.push_back({place, std::move(what)});
  };
  std::vector<std::uint32_t> set_of(audit.euler.size(), kNoSet);
  for (const CriticalPoint& p : complex.points) {
    if (p.type != CriticalType::kMaximum || p.set == kNoSet) continue;
    const std::uint32_t label = octree.nodes[octree.locate(p.position).node].component;
    if (label == kNoComponent) {
      disagree(p.position, fmt::format("a maximum with F = {:.6g} lies in a cell that is certified "
                                       "to be empty or undecided",
                                       p.value));
      continue;
    }
    std::uint32_t& component = audit.component_of_set[p.set];
    if (component == kNoComponent) component = label;
    if (component != label)
      disagree(
          p.position,
          fmt::format("a maximum of set {} is certified to lie in component {}, others of that "
                      "set in component {}",
                      p.set, label, component));
    std::uint32_t& set = set_of[label];
    if (set == kNoSet) set = p.set;
    if (set != p.set)
      disagree(p.position, fmt::format("sets {} and {} both have a maximum in component {}", set,
                                       p.set, label));
  }
}

}  // namespace

Audit audit(const ScalarField& field, const Topology& certified, const MorseComplex& complex,
            const Execution& execution) {
  const auto start = std::chrono::steady_clock::now();
  Audit audit;
  audit.component_of_set.assign(complex.sets.size(), kNoComponent);
  audit.euler.assign(certified.components.size(), 0);
  check_labels(certified.octree(), complex, audit);
  if (!certified.certified)
    audit.reasons.push_back(fmt::format("the certified engine left {} cells and {} faces undecided",
                                        certified.unresolved_cells, certified.unresolved_faces));
  if (certified.touches_box)
    audit.reasons.push_back("the box cuts the solid: pieces may have no maximum inside");
  if (!complex.resolved())
    audit.reasons.push_back(fmt::format(
        "the Morse engine left {} boxes undecided, lost {} ascents and found {} "
        "degenerate points",
        complex.unresolved_boxes, complex.lost.size(), complex.count(CriticalType::kDegenerate)));
  if (!audit.reasons.empty()) {
    // What is open may explain any of them.
    audit.disagreements.clear();
    audit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return audit;
  }
  audit.conclusive = true;
  for (std::size_t i = 0; i < certified.components.size(); ++i) {
    bool found = false;
    for (const std::uint32_t c : audit.component_of_set) found = found || c == i;
    if (!found && audit.disagreements.size() < kListed)
      audit.disagreements.push_back(
          {certified.components[i].seed, fmt::format("component {} has no maximum", i)});
  }
  const OctreeEuler euler = octree_euler(field, certified, execution);
  audit.euler = euler.of_component;
  if (!euler.undecided.empty()) {
    const Unresolved& u = euler.undecided.front();
    const Imath::V3d c = centre(u.box);
    audit.reasons.push_back(
        fmt::format("F is 0 to within rounding on {} edges or vertices of the octree, the first at "
                    "({}, {}, {}): Euler characteristics were not compared",
                    euler.undecided.size(), c.x, c.y, c.z));
    audit.conclusive = false;
  } else {
    for (std::size_t s = 0; s < complex.sets.size(); ++s) {
      const std::uint32_t component = audit.component_of_set[s];
      if (component == kNoComponent || audit.euler[component] == complex.sets[s].euler()) continue;
      if (audit.disagreements.size() >= kListed) break;
      const MorseSet& set = complex.sets[s];
      audit.disagreements.push_back(
          {complex.points[set.highest].position,
           fmt::format(
               "the Euler characteristic of component {} is {} by the octree, and {} - {} + "
               "{} - {} = {} by the critical points of set {}",
               component, audit.euler[component], set.maxima, set.saddles2, set.saddles1,
               set.minima, set.euler(), s)});
    }
  }
  audit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return audit;
}

void adopt_labels(const Audit& audit, MorseComplex& complex, Topology& topology) {
  std::vector<MorseSet> sets(topology.components.size());
  for (Component& c : topology.components) c.maxima = 0;
  for (CriticalPoint& p : complex.points) {
    if (p.set == kNoSet) continue;
    p.set = audit.component_of_set[p.set];
    if (p.set == kNoComponent) {
      p.set = kNoSet;
      continue;
    }
    MorseSet& set = sets[p.set];
    set.maxima += p.type == CriticalType::kMaximum;
    set.saddles2 += p.type == CriticalType::kSaddle2;
    set.saddles1 += p.type == CriticalType::kSaddle1;
    set.minima += p.type == CriticalType::kMinimum;
    if (p.type == CriticalType::kMaximum && set.maxima == 1)
      set.highest = static_cast<std::uint32_t>(&p - complex.points.data());
    topology.components[p.set].maxima = set.maxima;
  }
  complex.sets = std::move(sets);
  complex.main = complex.sets.empty() ? kNoSet : main_component(topology.components);
}

}  // namespace morsel::topology
