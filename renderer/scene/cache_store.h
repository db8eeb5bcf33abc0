// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hypertexture_geom/field/field.h"
#include "renderer/scene/scene_json.h"
#include "topology/cache_file.h"
#include "topology/certified.h"

namespace morsel::render {

// Where the topology cache of a hypertexture geometry lies: the file that the scene names, else
// SCENE_FOLDER/SCENE_STEM.cache/NAME-HASH16.topo. The default name carries the field's fingerprint,
// so a changed field gets a new file and never meets a stale one.
std::filesystem::path cache_file_of(const SceneDocument& document,
                                    const geom::Hypertexture& hypertexture);

// What stands at a cache's path. A path that is not there is kMissing; a file of another field
// kStale; one that fails validation kDamaged.
enum class CacheState { kMissing, kCurrent, kStale, kDamaged };
struct CacheInspection {
  CacheState state = CacheState::kMissing;
  std::string problem;  // kStale, kDamaged: what topology::read_cache_of says
  std::shared_ptr<const topology::TopologyCache> cache;  // kCurrent
};
CacheInspection inspect_cache(const std::filesystem::path& file, const std::string& field_hash);

// A cache and where it came from.
struct StoredCache {
  std::shared_ptr<const topology::TopologyCache> cache;
  std::filesystem::path file;
  bool built = false;  // rather than read
};

// What the user of a geometry should know of its topology: where the surface reaches the box and is
// cut, or is outside of it altogether, and how much stayed undecided. Samples the field.
std::vector<std::string> topology_warnings(const geom::Hypertexture& hypertexture,
                                           const topology::Topology& topology);

// Hands out caches for a scene's geometries; geometries of one fingerprint share one cache.
class CacheStore {
 public:
  using Warn = std::function<void(const std::string&)>;
  explicit CacheStore(const SceneDocument& document) : document_(document) {}

  // Reads the cache, or builds and writes it, as build_and_write does, when the file is missing.
  // When the file cannot be
  // written, warns and returns the cache all the same. A file that is there but damaged or of
  // another field is never replaced nor passed over: throws topology::CacheError. Also throws
  // topology::Cancelled.
  StoredCache get(const geom::Hypertexture& hypertexture, const topology::Execution& execution,
                  const Warn& warn);

 private:
  const SceneDocument& document_;
  std::map<std::string, StoredCache> by_hash_;
};

// Builds the cache and writes it to `file`, making the folder. What a build of more than a few
// seconds has done when it is interrupted is kept in FILE.partial, and the next one goes on from
// there. Throws topology::CacheError when it cannot be written (before the build, if that can be
// known then) and what topology::run_engine throws.
std::shared_ptr<const topology::TopologyCache> build_and_write(
    const geom::Hypertexture& hypertexture, const std::filesystem::path& file,
    const topology::Execution& execution, const topology::EngineOptions& engine = {});

}  // namespace morsel::render
