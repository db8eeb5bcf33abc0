// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/membership_filter.h"

#include <algorithm>
#include <optional>

#include "topology/morse/membership.h"
#include "topology/morse/morse_complex.h"

namespace morsel::geom {
namespace {

class LabelFilter final : public MembershipFilter {
 public:
  LabelFilter(const topology::ScalarField& field, const topology::OctreeView& octree,
              std::vector<bool> kept, double step)
      : field_(field), octree_(octree), kept_(std::move(kept)), step_(step) {}

  std::uint32_t component_at(const Imath::V3d& start) const override {
    // Steps uphill that double while they stay within half a leaf; F must grow with each, or the
    // step is halved.
    constexpr int kSteps = 256;
    Imath::V3d x = start;
    topology::Jet jet = field_.jet(x);
    double step = step_;
    for (int i = 0; i < kSteps; ++i) {
      const topology::OctreeView::Leaf leaf = octree_.locate(x);
      if (jet.value >= 0.0) {
        const topology::OctreeNode& node = octree_.nodes[leaf.node];
        const topology::Content content = node.cell_content();
        // Without a component: of a removed one. To climb on from there, in leaves that may be wide
        // (see topology/coarsen.h), could end in a kept piece nearby.
        if (content == topology::Content::kConnected || content == topology::Content::kFull)
          return node.component;
      }
      const double slope = jet.gradient.length();
      if (!(slope > 0.0)) break;
      const double largest = 0.25 * topology::half_size(leaf.box).x;
      const Imath::V3d next = x + jet.gradient * (std::min(step, largest) / slope);
      const topology::Jet there = field_.jet(next);
      if (there.value > jet.value) {
        x = next;
        jet = there;
        step = 2.0 * std::min(step, largest);
      } else {
        step = 0.5 * std::min(step, largest);
        if (step < 1e-6 * step_) break;
      }
    }
    return topology::kNoComponent;
  }

  bool keeps(const Imath::V3d& x) const override {
    const std::uint32_t component = component_at(x);
    return component < kept_.size() && kept_[component];
  }

  std::uint64_t bytes() const override { return sizeof *this + kept_.capacity() / 8; }

 private:
  const topology::ScalarField& field_;
  topology::OctreeView octree_;
  std::vector<bool> kept_;
  double step_;
};

topology::MorseOptions options_for(const topology::Box& box) {
  topology::MorseOptions options;
  options.box = box;
  return options;
}

class StreamlineFilter final : public MembershipFilter {
 public:
  StreamlineFilter(const topology::ScalarField& field, const topology::OctreeView& octree,
                   std::vector<bool> kept, const topology::Execution& execution)
      : complex_(topology::morse_complex(field, options_for(octree.box), execution)),
        membership_(field, complex_.box, complex_.points),
        kept_(std::move(kept)) {
    components_.reserve(complex_.sets.size());
    for (const topology::MorseSet& set : complex_.sets) {
      const auto leaf = octree.locate(complex_.points[set.highest].position);
      components_.push_back(octree.nodes[leaf.node].component);
    }
  }

  std::uint32_t component_at(const Imath::V3d& x) const override {
    const std::optional<std::uint32_t> set = membership_.set_of(x);
    return set ? components_[*set] : topology::kNoComponent;
  }

  bool keeps(const Imath::V3d& x) const override {
    const std::uint32_t component = component_at(x);
    return component < kept_.size() && kept_[component];
  }

  // The look-up of maxima holds a few numbers for each point beside these.
  std::uint64_t bytes() const override {
    return sizeof *this + complex_.points.capacity() * sizeof(topology::CriticalPoint) +
           complex_.separatrices.capacity() * sizeof(topology::Separatrix) +
           complex_.sets.capacity() * sizeof(topology::MorseSet) +
           components_.capacity() * sizeof(std::uint32_t) + kept_.capacity() / 8;
  }

 private:
  topology::MorseComplex complex_;
  topology::StreamlineMembership membership_;
  std::vector<bool> kept_;
  std::vector<std::uint32_t> components_;  // of each set
};

}  // namespace

std::unique_ptr<MembershipFilter> make_label_filter(const topology::ScalarField& field,
                                                    const topology::OctreeView& octree,
                                                    const std::vector<bool>& kept, double step) {
  return std::make_unique<LabelFilter>(field, octree, kept, step);
}

std::unique_ptr<MembershipFilter> make_streamline_filter(const topology::ScalarField& field,
                                                         const topology::OctreeView& octree,
                                                         const std::vector<bool>& kept,
                                                         const topology::Execution& execution) {
  return std::make_unique<StreamlineFilter>(field, octree, kept, execution);
}

}  // namespace morsel::geom
