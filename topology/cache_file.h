// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "topology/certified.h"
#include "topology/section_file.h"

namespace morsel::topology {

// A topology cache: a labelled octree with its component table, and what it was built from.
struct TopologyCache {
  Topology topology;
  std::string field_hash;   // fingerprint of the field's canonical JSON and of the build options
  nlohmann::json field;     // that canonical JSON
  double seconds = 0.0;     // wall-clock time of the build
  std::uint64_t bytes = 0;  // size of the file it was read from or written to
  // What else the file holds: results of other engines, each in sections of their own. They are
  // read and written as they are; who knows their names validates what they say.
  Sections sections;
};

// Writes to a temporary file beside `path`, then renames it. Sets cache.bytes. Throws CacheError.
void write_cache(TopologyCache& cache, const std::filesystem::path& path);

// Reads and validates everything: magic, version, sizes, checksums, node indices and counts. Of
// `execution` cancel and progress ("reading") are used. Throws CacheError, Cancelled.
TopologyCache read_cache(const std::filesystem::path& path, const Execution& execution = {});

// As above, and throws CacheError naming both fingerprints when the cache is of another field.
TopologyCache read_cache_of(const std::filesystem::path& path, const std::string& field_hash,
                            const Execution& execution = {});

// What `morsel cache info --json` prints: the keys that DESIGN.md section 7 names.
nlohmann::json describe(const TopologyCache& cache, const KeepRule& keep);

}  // namespace morsel::topology
