// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/cache_store.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "topology/bound_solid.h"
#include "topology/checkpoint.h"

namespace morsel::render {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHashDigitsInName = 16;

// Names of geometries are free text; names of files should not be.
std::string file_name_part(const std::string& name) {
  std::string part;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '_' || c == '-';
    part += plain ? c : '_';
  }
  return part;
}

// Throws topology::CacheError when no file can be made beside `file`, so that this is known before
// minutes of work and not after. Returns whether it made the folder.
bool prepare_folder(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::error_code error;
  const bool made = fs::create_directories(folder, error);
  if (!error && ::access(folder.c_str(), W_OK | X_OK) != 0)
    error = std::error_code(errno, std::generic_category());
  if (!error && fs::is_directory(file)) error = std::make_error_code(std::errc::is_a_directory);
  if (error)
    throw topology::CacheError(fmt::format("{}: cannot write: {}", file.string(), error.message()));
  return made;
}

// Where a cache is to be, and FILE.partial beside it, which keeps what a build of more than a few
// seconds has done for the next one. What holds nothing in the end is removed: the checkpoint, and
// the folder if it was made for it.
class Partial {
 public:
  // Throws topology::CacheError.
  Partial(const fs::path& file, const std::string& hash)
      : folder_(prepare_folder(file) ? file.parent_path() : fs::path()),
        checkpoint_(file.string() + ".partial", hash) {}
  ~Partial() {
    if (written_ || checkpoint_.is_empty()) checkpoint_.remove();
    std::error_code ignored;  // it is not empty
    if (!folder_.empty()) fs::remove(folder_, ignored);
  }
  Partial(const Partial&) = delete;
  Partial& operator=(const Partial&) = delete;

  topology::TopologyCache build(const geom::Hypertexture& hypertexture,
                                topology::Execution execution,
                                const topology::EngineOptions& engine) {
    execution.checkpoint = &checkpoint_;
    return geom::build_cache(hypertexture, execution, engine);
  }
  void is_written() { written_ = true; }

 private:
  fs::path folder_;  // empty: was there before
  topology::Checkpoint checkpoint_;
  bool written_ = false;
};

// Said of a solid that does not cross its bounds but is, or has pieces, outside of them.
std::string solid_out_of_bounds(const geom::Hypertexture& hypertexture,
                                const topology::Topology& topology) {
  const topology::Box& box = hypertexture.certify.box;
  const auto text_of = [](const topology::Box& b) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", b.min.x, b.min.y,
                       b.min.z, b.max.x, b.max.y, b.max.z);
  };
  const bool nothing = topology.components.empty();
  const std::optional<topology::Box> extent = hypertexture.field->solid_bounds();
  std::optional<Imath::V3d> place;
  if (extent && (nothing || !box.intersects(extent->min) || !box.intersects(extent->max)))
    place = topology::place_beyond(*hypertexture.field, *extent, box);
  if (!nothing && !place) return "";
  std::string text =
      nothing ? fmt::format("geometry \"{}\": there is no solid within its bounds, {}",
                            hypertexture.name, text_of(box))
              : fmt::format(
                    "geometry \"{}\": a piece of its solid is outside its bounds, {}, and "
                    "left out",
                    hypertexture.name, text_of(box));
  if (place)
    text +=
        fmt::format("; there is some at ({:.4g}, {:.4g}, {:.4g})", place->x, place->y, place->z);
  else if (extent && !extent->isEmpty())
    text += fmt::format("; it may extend over {}", text_of(*extent));
  return text;
}

}  // namespace

fs::path cache_file_of(const SceneDocument& document, const geom::Hypertexture& hypertexture) {
  if (!hypertexture.cache.empty()) return hypertexture.cache;
  const fs::path& scene = document.file();
  return scene.parent_path() / (scene.stem().string() + ".cache") /
         fmt::format("{}-{}.topo", file_name_part(hypertexture.name),
                     hypertexture.hash.substr(0, kHashDigitsInName));
}

CacheInspection inspect_cache(const fs::path& file, const std::string& field_hash) {
  CacheInspection found;
  std::error_code error;
  if (fs::status(file, error).type() == fs::file_type::not_found) return found;
  try {
    topology::TopologyCache cache = topology::read_cache(file);
    if (cache.field_hash == field_hash) {
      found.state = CacheState::kCurrent;
      found.cache = std::make_shared<const topology::TopologyCache>(std::move(cache));
    } else {
      found.state = CacheState::kStale;
      found.problem =
          fmt::format("{}: cache of another field: its fingerprint is {}, the scene's {}",
                      file.string(), cache.field_hash, field_hash);
    }
  } catch (const topology::CacheError& e) {
    found.state = CacheState::kDamaged;
    found.problem = e.what();
  }
  return found;
}

std::vector<std::string> topology_warnings(const geom::Hypertexture& hypertexture,
                                           const topology::Topology& topology) {
  const std::string& geometry = hypertexture.name;
  std::vector<std::string> warnings;
  if (const auto& place = topology.touches_box) {
    const bool known = hypertexture.field->value(*place) >= 0.0;
    warnings.push_back(
        fmt::format("geometry \"{}\": its surface {} its bounds near ({:.4g}, {:.4g}, {:.4g}) and "
                    "{} cut there",
                    geometry, known ? "reaches" : "may reach", place->x, place->y, place->z,
                    known ? "is" : "be"));
  } else if (std::string text = solid_out_of_bounds(hypertexture, topology); !text.empty()) {
    warnings.push_back(std::move(text));
  }
  // Labels by the Morse engine are never certified; that alone leaves nothing undecided.
  if (topology.unresolved_cells == 0 && topology.unresolved_faces == 0) return warnings;
  if (topology.engine == to_string(topology::Engine::kMorse))
    warnings.push_back(fmt::format(
        "geometry \"{}\": {} cells are of no certain component: their ascents were lost, or the "
        "octree left them undecided",
        geometry, topology.unresolved_cells));
  else
    warnings.push_back(
        fmt::format("geometry \"{}\": {} cells and {} faces stayed undecided at the depth limit",
                    geometry, topology.unresolved_cells, topology.unresolved_faces));
  return warnings;
}

StoredCache CacheStore::get(const geom::Hypertexture& hypertexture,
                            const topology::Execution& execution, const Warn& warn) {
  const auto known = by_hash_.find(hypertexture.hash);
  if (known != by_hash_.end()) return known->second;

  StoredCache stored;
  stored.file = cache_file_of(document_, hypertexture);
  const CacheInspection found = inspect_cache(stored.file, hypertexture.hash);
  switch (found.state) {
    case CacheState::kCurrent:
      stored.cache = found.cache;
      break;
    case CacheState::kStale:
    case CacheState::kDamaged:
      throw topology::CacheError(
          fmt::format("{} (geometry \"{}\" of {}; `morsel cache build` replaces it)", found.problem,
                      hypertexture.name, document_.file().string()));
    case CacheState::kMissing: {
      stored.built = true;
      const auto in_memory_only = [&](const topology::CacheError& e) {
        if (warn) warn(fmt::format("{}; going on with the cache in memory", e.what()));
      };
      std::optional<Partial> partial;
      try {
        partial.emplace(stored.file, hypertexture.hash);
      } catch (const topology::CacheError& e) {
        in_memory_only(e);
      }
      topology::TopologyCache cache = partial ? partial->build(hypertexture, execution, {})
                                              : geom::build_cache(hypertexture, execution);
      if (partial) {
        try {
          topology::write_cache(cache, stored.file);
          partial->is_written();
        } catch (const topology::CacheError& e) {
          in_memory_only(e);
        }
      }
      stored.cache = std::make_shared<const topology::TopologyCache>(std::move(cache));
      break;
    }
  }
  return by_hash_[hypertexture.hash] = stored;
}

std::shared_ptr<const topology::TopologyCache> build_and_write(
    const geom::Hypertexture& hypertexture, const fs::path& file,
    const topology::Execution& execution, const topology::EngineOptions& engine) {
  Partial partial(file, hypertexture.hash);
  topology::TopologyCache cache = partial.build(hypertexture, execution, engine);
  topology::write_cache(cache, file);
  partial.is_written();
  return std::make_shared<const topology::TopologyCache>(std::move(cache));
}

}  // namespace morsel::render
