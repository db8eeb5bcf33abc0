// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/bricks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace morsel::geom {
namespace {

topology::Box inflated(const topology::Box& box, double by) {
  return {box.min - Imath::V3d(by), box.max + Imath::V3d(by)};
}

}  // namespace

// Two passes over the octree: one counts bricks and blocks under each node, which fixes every
// index; the other restricts the field on the way down, in parallel, and models each brick.
struct BrickSet::Builder {
  BrickSet& set;
  const topology::OctreeView& octree;
  const std::vector<bool>& kept;
  const Options& options;

  struct Count {
    std::uint32_t bricks = 0;
    std::uint32_t blocks = 0;
    int height = -1;  // levels down to the deepest brick; -1: none
  };
  std::vector<Count> counts;

  bool is_brick(const topology::OctreeNode& node) const {
    const topology::Content content = node.cell_content();
    return (content == topology::Content::kConnected || content == topology::Content::kUndecided) &&
           node.component < kept.size() && kept[node.component];
  }

  // A block is a highest node with at most block_levels levels below it.
  bool is_block(const Count& count) const { return count.height <= options.block_levels; }

  const Count& count(std::uint32_t node) {
    const topology::OctreeNode& n = octree.nodes[node];
    Count c;
    if (n.is_leaf()) {
      if (is_brick(n)) c = {1, 1, 0};
    } else {
      for (std::uint32_t i = 0; i < 8; ++i) {
        const Count& child = count(n.first_child + i);
        if (child.bricks == 0) continue;
        c.bricks += child.bricks;
        c.blocks += child.blocks;
        c.height = std::max(c.height, child.height + 1);
      }
      if (c.bricks > 0 && is_block(c)) c.blocks = 1;
    }
    return counts[node] = c;
  }

  struct Place {
    std::uint32_t node;
    std::uint32_t depth;
    std::uint32_t cell[3];
  };

  topology::Box box_of(const Place& p) const {
    Brick b{};
    std::copy(p.cell, p.cell + 3, b.cell);
    b.depth = p.depth & 31u;
    return set.box(b);
  }

  static Place child_of(const Place& p, std::uint32_t first_child, std::uint32_t i) {
    return {first_child + i,
            p.depth + 1,
            {2 * p.cell[0] + (i & 1u), 2 * p.cell[1] + ((i >> 1) & 1u),
             2 * p.cell[2] + ((i >> 2) & 1u)}};
  }

  // `field` holds on the parent's box and the margin.
  void descend(const Place& place, const topology::ScalarField& field, std::uint32_t first_brick,
               std::uint32_t first_block) {
    const Count& c = counts[place.node];
    if (c.bricks == 0) return;
    std::unique_ptr<topology::ScalarField> own =
        field.restricted_to(inflated(box_of(place), set.margin_));
    if (is_block(c)) {
      set.blocks_[first_block] = std::move(own);
      fill(place, *set.blocks_[first_block], first_brick, first_block);
      return;
    }
    const std::uint32_t first_child = octree.nodes[place.node].first_child;
    std::array<std::uint32_t, 8> bricks, blocks;
    for (std::uint32_t i = 0; i < 8; ++i) {
      bricks[i] = first_brick;
      blocks[i] = first_block;
      first_brick += counts[first_child + i].bricks;
      first_block += counts[first_child + i].blocks;
    }
    const auto visit = [&](std::uint32_t i) {
      descend(child_of(place, first_child, i), *own, bricks[i], blocks[i]);
    };
    constexpr std::uint32_t kWorthATask = 256;
    if (c.bricks >= kWorthATask) {
      tbb::parallel_for(0u, 8u, visit);
    } else {
      for (std::uint32_t i = 0; i < 8; ++i) visit(i);
    }
  }

  void fill(const Place& place, const topology::ScalarField& field, std::uint32_t first_brick,
            std::uint32_t block) {
    const topology::OctreeNode& n = octree.nodes[place.node];
    if (!n.is_leaf()) {
      for (std::uint32_t i = 0; i < 8; ++i) {
        const std::uint32_t bricks = counts[n.first_child + i].bricks;
        if (bricks == 0) continue;
        fill(child_of(place, n.first_child, i), field, first_brick, block);
        first_brick += bricks;
      }
      return;
    }
    Brick& b = set.bricks_[first_brick];
    std::copy(place.cell, place.cell + 3, b.cell);
    b.depth = place.depth & 31u;
    b.block = block & ((1u << 27) - 1);
    b.component = n.component;
    const topology::Box box = set.box(b);
    const topology::LocalModel model = field.model(inflated(box, 2.0 * set.slack(box)));
    for (int i = 0; i < 3; ++i) b.gradient[i] = CoarseRange(model.gradient_range(i));
    constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int i = 0; i < 6; ++i)
      b.hessian[i] = CoarseRange(model.hessian_range(kPairs[i][0], kPairs[i][1]));
  }
};

BrickSet::BrickSet(const topology::ScalarField& field, const topology::OctreeView& octree,
                   const std::vector<bool>& kept, const Options& options)
    : root_(octree.box), size_(octree.box.max - octree.box.min), margin_(options.margin) {
  Builder builder{*this, octree, kept, options, {}};
  if (octree.nodes.empty()) return;
  builder.counts.resize(octree.nodes.size());
  const Builder::Count total = builder.count(0);
  if (total.blocks >= (1u << 27)) throw std::length_error("too many blocks of bricks");
  bricks_.resize(total.bricks);
  blocks_.resize(total.blocks);
  builder.descend({0, 0, {0, 0, 0}}, field, 0, 0);
}

RayBounds BrickSet::ray_bounds(const Brick& b, const Imath::V3d& d) const {
  RayBounds r;
  const auto add = [](double& lo, double& hi, double factor, const CoarseRange& range) {
    const double p = factor * range.lo(), q = factor * range.hi();
    lo += std::min(p, q);
    hi += std::max(p, q);
  };
  for (int i = 0; i < 3; ++i) add(r.slope_lo, r.slope_hi, d[i], b.gradient[i]);
  const double squares[6] = {d.x * d.x,       d.y * d.y,       d.z * d.z,
                             2.0 * d.x * d.y, 2.0 * d.x * d.z, 2.0 * d.y * d.z};
  for (int i = 0; i < 6; ++i) add(r.curvature_lo, r.curvature_hi, squares[i], b.hessian[i]);
  return r;
}

}  // namespace morsel::geom
