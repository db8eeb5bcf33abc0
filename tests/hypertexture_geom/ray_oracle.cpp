// SPDX-License-Identifier: Apache-2.0
#include "tests/hypertexture_geom/ray_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morsel::geom::test {
namespace {

using topology::Box;
using topology::Content;

bool may_hold_surface(const topology::OctreeNode& n) {
  return n.cell_content() == Content::kConnected || n.cell_content() == Content::kUndecided;
}

Box inflated(const Box& box, double by) {
  return {box.min - Imath::V3d(by), box.max + Imath::V3d(by)};
}

// Parameter at which the ray leaves the box, given that it is in it.
double exit_of(const Box& box, const Imath::V3d& o, const Imath::V3d& d) {
  double t = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i)
    if (d[i] != 0.0) t = std::min(t, ((d[i] > 0.0 ? box.max[i] : box.min[i]) - o[i]) / d[i]);
  return t;
}

double entry_of(const Box& box, const Imath::V3d& o, const Imath::V3d& d) {
  double t = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (d[i] != 0.0) {
      t = std::max(t, ((d[i] > 0.0 ? box.min[i] : box.max[i]) - o[i]) / d[i]);
    } else if (o[i] < box.min[i] || o[i] > box.max[i]) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return t;
}

}  // namespace

RayOracle::RayOracle(const topology::ScalarField& field, const topology::Topology& topology,
                     std::vector<bool> keep, double step)
    : field_(field), octree_(topology.octree()), keep_(std::move(keep)), step_(step) {
  heights_.resize(octree_.nodes.size(), -1);
  owner_.resize(octree_.nodes.size());
  height(0);
  restrict(0, octree_.box, field, 3);
}

int RayOracle::height(std::uint32_t node) {
  const topology::OctreeNode& n = octree_.nodes[node];
  int h = -1;
  if (n.is_leaf()) {
    if (may_hold_surface(n)) h = 0;
  } else {
    for (std::uint32_t i = 0; i < 8; ++i) {
      const int below = height(n.first_child + i);
      if (below >= 0) h = std::max(h, below + 1);
    }
  }
  heights_[node] = static_cast<std::int8_t>(h);
  return h;
}

// `levels` < 0 marks that an ancestor's field is in use.
void RayOracle::restrict(std::uint32_t node, const Box& box, const topology::ScalarField& field,
                         int levels) {
  if (heights_[node] < 0) return;
  const topology::OctreeNode& n = octree_.nodes[node];
  const topology::ScalarField* use = &field;
  std::unique_ptr<topology::ScalarField> own;
  if (levels >= 0) {
    own = field.restricted_to(inflated(box, 1e-6));
    use = own.get();
    if (heights_[node] <= levels) {
      local_.push_back(std::move(own));
      levels = -1;
    }
  }
  if (n.is_leaf()) {
    owner_[node] = static_cast<std::uint32_t>(local_.size() - 1);
    return;
  }
  for (int i = 0; i < 8; ++i)
    restrict(n.first_child + static_cast<std::uint32_t>(i), topology::child_box(box, i), *use,
             levels);
}

RayOracle::Crossing RayOracle::label(const Imath::V3d& x) const {
  const std::uint32_t c = octree_.nodes[octree_.locate(x).node].component;
  return {0.0, c, c < keep_.size() && keep_[c]};
}

std::optional<RayOracle::Crossing> RayOracle::first_hit(const Imath::V3d& o,
                                                        const Imath::V3d& d) const {
  const double speed = d.length(), nudge = 1e-11 / speed;
  double t = entry_of(octree_.box, o, d);
  const double end = exit_of(octree_.box, o, d);
  int sign = 0;  // at t; 0: not known yet
  while (t < end) {
    const topology::OctreeView::Leaf leaf = octree_.locate(o + d * (t + nudge));
    const topology::OctreeNode& n = octree_.nodes[leaf.node];
    const double leave = std::max(exit_of(leaf.box, o, d), t + nudge);
    if (!may_hold_surface(n)) {
      sign = n.cell_content() == Content::kFull ? 1 : -1;
      t = leave;
      continue;
    }
    const bool kept = n.component < keep_.size() && keep_[n.component];
    const topology::ScalarField& field = field_of(leaf.node);
    const auto positive = [&](double s) { return field.value(o + d * s) >= 0.0; };
    const int steps = std::max(1, static_cast<int>(std::ceil((leave - t) * speed / step_)));
    double before = t;
    bool was = sign == 0 ? positive(t) : sign > 0;
    for (int k = 0; k <= steps; ++k) {
      // Step 0 catches a change in the nudge between two leaves.
      const double s = k == steps ? leave : t + (leave - t) * k / steps;
      const bool is = positive(s);
      if (is != was) {
        double lo = before, hi = s;
        for (int i = 0; i < 80 && lo < hi; ++i) {
          const double m = 0.5 * (lo + hi);
          (positive(m) == was ? lo : hi) = m;
        }
        if (kept) return Crossing{hi, n.component, true};
      }
      was = is;
      before = s;
    }
    sign = was ? 1 : -1;
    t = leave;
  }
  return std::nullopt;
}

bool RayOracle::changes_sign_near(const Imath::V3d& o, const Imath::V3d& d, double t,
                                  double radius) const {
  constexpr int kSteps = 2000;
  const double half = radius / d.length();
  const bool first = field_.value(o + d * (t - half)) >= 0.0;
  for (int i = 1; i <= kSteps; ++i)
    if ((field_.value(o + d * (t - half + 2.0 * half * i / kSteps)) >= 0.0) != first) return true;
  return false;
}

double RayOracle::least_value_near(const Imath::V3d& o, const Imath::V3d& d, double t,
                                   double radius) const {
  constexpr int kSteps = 2000;
  const double half = radius / d.length();
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i)
    least = std::min(least, std::abs(field_.value(o + d * (t - half + 2.0 * half * i / kSteps))));
  return least;
}

}  // namespace morsel::geom::test
