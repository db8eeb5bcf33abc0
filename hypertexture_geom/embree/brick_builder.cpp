// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/brick_builder.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "hypertexture_geom/embree/brick_model.h"
#include "topology/certified.h"
#include "topology/coarsen.h"

namespace morsel::geom {
namespace {

constexpr std::uint32_t kMaxBlocks = 1u << 27;

topology::Box inflated(const topology::Box& box, double by) {
  return {box.min - Imath::V3d(by), box.max + Imath::V3d(by)};
}

}  // namespace

void BrickBuilder::Part::append(Part&& part) {
  const auto first = static_cast<std::uint32_t>(blocks.size());
  if (blocks.size() + part.blocks.size() >= kMaxBlocks)
    throw std::length_error("too many blocks of bricks");
  if (bricks.empty()) {
    bricks = std::move(part.bricks);
  } else {
    bricks.insert(bricks.end(), part.bricks.begin(), part.bricks.end());
  }
  for (auto b = bricks.end() - static_cast<std::ptrdiff_t>(part.bricks.size()); b != bricks.end();
       ++b)
    b->block = (b->block + first) & (kMaxBlocks - 1);
  ranges.insert(ranges.end(), part.ranges.begin(), part.ranges.end());
  std::move(part.blocks.begin(), part.blocks.end(), std::back_inserter(blocks));
}

const BrickBuilder::Content& BrickBuilder::examine(std::uint32_t node) {
  const topology::OctreeNode& n = octree_.nodes[node];
  Content c;
  if (n.is_leaf()) {
    const bool undecided = n.cell_content() == topology::Content::kUndecided;
    if (undecided || n.cell_content() == topology::Content::kConnected) {
      if (undecided || (n.component < kept_.size() && kept_[n.component]))
        c = {1, n.component, !undecided, topology::merged_levels(n)};
      else
        c.pure = false;
    }
  } else {
    for (std::uint32_t i = 0; i < 8; ++i) {
      const Content& child = examine(n.first_child + i);
      c.pure = c.pure && child.pure;
      if (child.leaves == 0) continue;
      if (c.leaves > 0 && child.component != c.component) c.pure = false;
      c.component = child.component;
      c.leaves += child.leaves;
      c.height = std::max(c.height, child.height + 1);
    }
  }
  return contents_[node] = c;
}

BrickBuilder::Place BrickBuilder::child_of(const Place& p, std::uint32_t node, std::uint32_t i) {
  return {
      node,
      p.depth + 1,
      {2 * p.cell[0] + (i & 1u), 2 * p.cell[1] + ((i >> 1) & 1u), 2 * p.cell[2] + ((i >> 2) & 1u)},
      0};
}

topology::Box BrickBuilder::box_of(const Place& p) const {
  Brick b{};
  std::copy(p.cell, p.cell + 3, b.cell);
  b.depth = p.depth & 31u;
  return set_.box(b);
}

void BrickBuilder::report(std::uint32_t leaves) const {
  if (!execution_.progress) return;
  const std::uint64_t all = contents_[0].leaves;
  const std::lock_guard lock(progress_mutex_);
  done_ += leaves;
  if (done_ < all && (done_ - reported_) * 256 < all) return;
  reported_ = done_;
  execution_.progress(static_cast<double>(done_) / static_cast<double>(all), "bricks");
}

// `field` holds on the parent's box and the margin.
BrickBuilder::Part BrickBuilder::descend(const Place& place,
                                         const topology::ScalarField& field) const {
  Part part;
  const Content& c = contents_[place.node];
  if (c.leaves == 0) return part;
  const topology::Box box = inflated(box_of(place), set_.margin_);
  std::unique_ptr<topology::ScalarField> own = field.restricted_to(box);
  if (c.height <= options_.block_levels) {
    execution_.check_cancel();
    fill(place, *own, part);
    report(c.leaves);
    if (part.bricks.empty()) return part;
    // The surface seldom fills its block: terms that do not reach the bricks are left out.
    topology::Box bricks;
    for (const Brick& b : part.bricks) bricks.extendBy(set_.box(b));
    const topology::Box reach = inflated(bricks, set_.margin_);
    auto block = std::make_unique<CompiledField<double>>(*own, reach);
    // Rounds as one that is read from a file, where only the whole field is at hand.
    if (block->refers_to_field()) block = std::make_unique<CompiledField<double>>(*whole_, reach);
    part.blocks.push_back(std::move(block));
    return part;
  }
  const std::uint32_t first = octree_.nodes[place.node].first_child;
  std::array<Part, 8> parts;
  const auto visit = [&](std::uint32_t i) {
    parts[i] = descend(child_of(place, first + i, i), *own);
  };
  constexpr std::uint32_t kWorthATask = 256;
  if (c.leaves >= kWorthATask) {
    tbb::parallel_for(0u, 8u, visit);
  } else {
    for (std::uint32_t i = 0; i < 8; ++i) visit(i);
  }
  for (Part& p : parts) part.append(std::move(p));
  return part;
}

// All bricks below `place`, whose block is number 0.
void BrickBuilder::fill(const Place& place, const topology::ScalarField& field, Part& part) const {
  const Content& c = contents_[place.node];
  if (c.leaves == 0) return;
  const topology::OctreeNode& n = octree_.nodes[place.node];
  const bool in_leaf = n.is_leaf();
  const bool mergeable =
      in_leaf || (!options_.slope_ranges && c.pure && c.height <= options_.merge_levels);
  if (mergeable && make_brick(place, field, part) != Made::kTooCoarse) return;
  // Models of the parts are made of the terms that reach this cell: choosing those once is cheaper
  // than to pass over the others eight times.
  const double slack = 2.0 * BrickSet::kSlack * set_.sizes_[place.depth].x;
  const std::unique_ptr<topology::ScalarField> own =
      field.restricted_to(inflated(box_of(place), std::max(set_.margin_, slack)));
  for (std::uint32_t i = 0; i < 8; ++i) {
    Place child = child_of(place, in_leaf ? place.node : n.first_child + i, i);
    if (in_leaf) child.below_leaf = place.below_leaf + 1;
    fill(child, *own, part);
  }
}

BrickBuilder::Made BrickBuilder::make_brick(const Place& place, const topology::ScalarField& field,
                                            Part& part) const {
  Brick b{};
  std::copy(place.cell, place.cell + 3, b.cell);
  b.depth = place.depth & 31u;
  b.block = 0;
  b.undecided = octree_.nodes[place.node].is_leaf() && !contents_[place.node].pure;
  b.component = b.undecided ? topology::kNoComponent : contents_[place.node].component;
  const topology::Box box = set_.box(b);
  const topology::LocalModel model = field.model(inflated(box, 2.0 * set_.slack(b)));
  set_model(b, model, topology::half_size(box));
  if (options_.slope_ranges) {
    SlopeRanges r;
    for (int i = 0; i < 3; ++i) r.gradient[i] = CoarseRange(model.gradient_range(i));
    constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int i = 0; i < 6; ++i)
      r.hessian[i] = CoarseRange(model.hessian_range(kPairs[i][0], kPairs[i][1]));
    part.ranges.push_back(r);
    part.bricks.push_back(b);
    return Made::kBrick;
  }
  using namespace topology::monomial;
  const float change = std::abs(b.c[kX]) + std::abs(b.c[kY]) + std::abs(b.c[kZ]);
  const bool splittable =
      !octree_.nodes[place.node].is_leaf() ||
      (place.below_leaf <
           options_.split_levels + topology::merged_levels(octree_.nodes[place.node]) &&
       place.depth < static_cast<std::uint32_t>(topology::kMaxDepth));
  const bool coarse =
      b.value_error - b.rounding > static_cast<float>(options_.error_ratio) * change;
  if (coarse && splittable) return Made::kTooCoarse;
  const topology::Interval range = model.range();
  if (range.lo > 0.0 || range.hi < 0.0) return Made::kNoSurface;
  part.bricks.push_back(b);
  return Made::kBrick;
}

void BrickBuilder::build(const topology::ScalarField& field) {
  if (octree_.nodes.empty()) return;
  whole_ = &field;
  contents_.resize(octree_.nodes.size());
  examine(0);
  Part all = descend({0, 0, {0, 0, 0}, 0}, field);
  all.bricks.shrink_to_fit();
  set_.bricks_ = std::move(all.bricks);
  set_.ranges_ = std::move(all.ranges);
  set_.blocks_ = std::move(all.blocks);
}

}  // namespace morsel::geom
