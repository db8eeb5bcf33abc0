// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "hypertexture_geom/embree/bricks.h"

namespace morsel::geom {

// Makes the bricks of a BrickSet: one pass over the octree finds what lies below each node, a
// second one restricts the field on the way down, in parallel, and models bricks.
class BrickBuilder {
 public:
  BrickBuilder(BrickSet& set, const topology::OctreeView& octree, const std::vector<bool>& kept,
               const BrickSet::Options& options, const topology::Execution& execution)
      : set_(set), octree_(octree), kept_(kept), options_(options), execution_(execution) {}

  void build(const topology::ScalarField& field);

 private:
  // What the subtree of a node holds.
  struct Content {
    std::uint32_t leaves = 0;                          // that hold surface of a kept component
    std::uint32_t component = topology::kNoComponent;  // theirs, if they have one in common
    bool pure = true;  // no other surface, one component, nothing undecided
    int height = -1;   // levels down to the deepest of those leaves; -1: none
  };
  struct Place {
    std::uint32_t node;  // below a leaf: that leaf
    std::uint32_t depth;
    std::uint32_t cell[3];
    int below_leaf;  // levels below the octree's leaf
  };
  // Bricks and blocks of a subtree, in depth-first order; `block` counts from 0.
  struct Part {
    std::vector<Brick> bricks;
    std::vector<SlopeRanges> ranges;
    std::vector<BrickSet::Block> blocks;
    void append(Part&& part);
  };

  const Content& examine(std::uint32_t node);
  static Place child_of(const Place& p, std::uint32_t node, std::uint32_t i);
  topology::Box box_of(const Place& p) const;
  // So many more leaves are done.
  void report(std::uint32_t leaves) const;
  Part descend(const Place& place, const topology::ScalarField& field) const;
  void fill(const Place& place, const topology::ScalarField& field, Part& part) const;
  enum class Made { kBrick, kNoSurface, kTooCoarse };
  Made make_brick(const Place& place, const topology::ScalarField& field, Part& part) const;

  BrickSet& set_;
  const topology::OctreeView& octree_;
  const std::vector<bool>& kept_;
  const BrickSet::Options& options_;
  const topology::Execution& execution_;
  const topology::ScalarField* whole_ = nullptr;  // while build() runs
  std::vector<Content> contents_;
  mutable std::mutex progress_mutex_;
  mutable std::uint64_t done_ = 0, reported_ = 0;  // leaves
};

}  // namespace morsel::geom
