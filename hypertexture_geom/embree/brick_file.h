// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hypertexture_geom/embree/bricks.h"
#include "topology/section_file.h"

namespace morsel::geom {

inline constexpr topology::SectionFormat kBrickFormat{"MORSBRIK", 1, "brick file"};

// Bricks on disk, so that the next run need not make them. They follow from the field, the octree
// and the options: a file holds a fingerprint of all of these, and is of use for no others. Layout:
// README.md.
class BrickFile {
 public:
  // What bricks follow from, apart from the field itself.
  struct Source {
    std::string field_hash;  // TopologyCache::field_hash
    topology::OctreeView octree;
    const std::vector<bool>& kept;
    const BrickSet::Options& options;
  };

  // The file is STEM-K.bricks, K being eight digits that `kept` and the options make: of each
  // choice of what is rendered, and how, there is one file.
  BrickFile(const std::filesystem::path& stem, const Source& source);

  const std::filesystem::path& path() const { return path_; }

  // The bricks, the same to the last bit as those that were written; nothing when there is no such
  // file, or one of another fingerprint. `field` is asked for blocks that refer to it. Runs in the
  // caller's TBB arena. Throws topology::CacheError when the file cannot be read or is damaged,
  // Cancelled.
  std::optional<BrickSet> read(const topology::ScalarField& field,
                               const topology::Execution& execution) const;

  // Replaces the file when it is whole; makes its folder. Throws topology::CacheError.
  void write(const BrickSet& bricks) const;

 private:
  std::string fingerprint_;
  std::filesystem::path path_;
  topology::Box root_;
  std::size_t components_;
  BrickSet::Options options_;
};

}  // namespace morsel::geom
