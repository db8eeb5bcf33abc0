// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "topology/octree.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// Hands out the field restricted to a neighbourhood of small boxes that are asked for in an order
// that stays near, such as an octree's leaves: keeps a chain of nested restrictions. One object for
// one thread; `field` must outlive it.
class FieldDescent {
 public:
  FieldDescent(const ScalarField& field, const Box& box) : field_(field), box_(box) {}

  // Equals F on `target`; valid until the next call.
  const ScalarField& at(const Box& target) {
    while (!chain_.empty() && !holds(chain_.back().reach, target)) chain_.pop_back();
    const Imath::V3d size = target.max - target.min;
    const double longest = std::max({size.x, size.y, size.z});
    for (;;) {
      const Box& cell = chain_.empty() ? box_ : chain_.back().cell;
      const Imath::V3d middle = centre(cell), c = centre(target);
      const int child = (c.x >= middle.x) + 2 * (c.y >= middle.y) + 4 * (c.z >= middle.z);
      const Box next = child_box(cell, child);
      const Imath::V3d half = half_size(next) * kReach;
      const Box reach(centre(next) - half, centre(next) + half);
      if (next.max.x - next.min.x < 4.0 * longest || !holds(reach, target) ||
          chain_.size() >= kLongest)
        break;
      chain_.push_back({next, reach, top().restricted_to(reach)});
    }
    return top();
  }

 private:
  static constexpr double kReach = 1.5;
  static constexpr std::size_t kLongest = 16;
  struct Link {
    Box cell, reach;
    std::unique_ptr<ScalarField> field;
  };
  static bool holds(const Box& outer, const Box& inner) {
    return outer.intersects(inner.min) && outer.intersects(inner.max);
  }
  const ScalarField& top() const { return chain_.empty() ? field_ : *chain_.back().field; }

  const ScalarField& field_;
  Box box_;
  std::vector<Link> chain_;
};

}  // namespace morsel::topology
