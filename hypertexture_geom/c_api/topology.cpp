// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <limits>

#include "hypertexture_geom/c_api/call.h"
#include "hypertexture_geom/c_api/objects.h"
#include "hypertexture_geom/c_api/watch.h"
#include "topology/cache_file.h"
#include "topology/morse/morse_sections.h"

namespace morsel::c_api {
namespace {

namespace fs = std::filesystem;
using topology::TopologyCache;

constexpr std::size_t kBuildOptionsV1 = offsetof(MorselBuildOptions, engine);
constexpr std::size_t kTopologyInfoV1 = offsetof(MorselTopologyInfo, critical_points);
constexpr std::size_t kComponentV1 = offsetof(MorselComponent, maxima);
constexpr std::size_t kCriticalPointV1 = sizeof(MorselCriticalPoint);
static_assert(MORSEL_CRITICAL_DEGENERATE ==
              static_cast<unsigned>(topology::CriticalType::kDegenerate));
static_assert(MORSEL_NO_COMPONENT == topology::kNoSet);

// `name` is for errors.
std::shared_ptr<TopologyObject> object_with(TopologyCache cache, const std::string& name) {
  auto object = std::make_shared<TopologyObject>();
  if (auto morse = topology::get_morse(cache.sections, cache.topology.components.size(), name))
    object->critical_points = std::move(morse->points);
  object->bytes = cache.bytes;
  object->cache = std::make_shared<const TopologyCache>(std::move(cache));
  return object;
}

topology::Engine engine_of(const MorselBuildOptions& options) {
  switch (options.engine) {
    case MORSEL_ENGINE_CERTIFIED:
      return topology::Engine::kCertified;
    case MORSEL_ENGINE_MORSE:
      return topology::Engine::kMorse;
    case MORSEL_ENGINE_BOTH:
      return topology::Engine::kBoth;
    default:
      bad_argument("engine is " + std::to_string(options.engine) +
                   ", none of MORSEL_ENGINE_CERTIFIED, MORSEL_ENGINE_MORSE, MORSEL_ENGINE_BOTH");
  }
}

MorselBuildOptions read_build_options(const MorselBuildOptions* given) {
  const MorselBuildOptions options = read_options(given, kBuildOptionsV1, "MorselBuildOptions");
  require_zero(options.reserved, "MorselBuildOptions: reserved");
  require_zero(options.reserved2, "MorselBuildOptions: reserved2");
  require_threads(options.threads);
  engine_of(options);
  return options;
}

// The engines' phases as they name them, with what they took for equation (13), L = 1 to 3.
std::vector<Phase> phases_of(topology::Engine engine) {
  switch (engine) {
    case topology::Engine::kMorse:
      return {{"labelling", 0.4},
              {"critical points", 0.3},
              {"separatrices", 0.2},
              {"ascents from cells", 0.1}};
    case topology::Engine::kBoth:
      return {{"labelling", 0.4}, {"critical points", 0.3}, {"separatrices", 0.2}, {"audit", 0.1}};
    default:
      return {{"labelling", 1.0}};
  }
}

TopologyCache build(const geom::Hypertexture& hypertexture, const MorselBuildOptions& options) {
  const topology::Engine engine = engine_of(options);
  Watch watch(options, phases_of(engine));
  const topology::Execution execution = watch.execution();
  TopologyCache cache;
  on_threads(options.threads, [&] { cache = geom::build_cache(hypertexture, execution, engine); });
  watch.finish();
  return cache;
}

std::shared_ptr<TopologyObject> load(const FieldObject& field, const char* path,
                                     const MorselBuildOptions& options) {
  Watch watch(options, {{"reading", 1.0}});
  auto object =
      object_with(topology::read_cache_of(path, field.hypertexture.hash, watch.execution()), path);
  watch.finish();
  return object;
}

// Of functions that copy a part of a table of `size` entries, which are `stride` bytes apart.
void require_range(const char* type, const char* stride_name, size_t stride, size_t least_stride,
                   size_t first, size_t count, size_t size) {
  require_struct_size(stride, least_stride, type, stride_name);
  if (first > size || count > size - first)
    bad_argument("entries " + std::to_string(first) + " and the " + std::to_string(count) +
                 " from there are not all within the table of " + std::to_string(size));
}

// Before the work, not after it.
void require_writable_folder(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code ignored;
  const bool is_folder = fs::is_directory(path, ignored);
  if (is_folder || ::access(folder.c_str(), W_OK | X_OK) != 0)
    throw topology::CacheError(path.string() +
                               ": cannot write: " + std::strerror(is_folder ? EISDIR : errno));
}

}  // namespace
}  // namespace morsel::c_api

using namespace morsel::c_api;

MorselResult morsel_build_topology(MorselField field, const MorselBuildOptions* options,
                                   MorselTopology* topology) {
  return call(field, [&] {
    const auto object = shared_object_of<FieldObject>(field);
    require(topology, "topology");
    give(object_with(build(object->hypertexture, read_build_options(options)), "the topology"),
         topology);
  });
}

MorselResult morsel_load_topology(MorselField field, const char* path, MorselTopology* topology) {
  return call(field, [&] {
    const auto& object = object_of<FieldObject>(field);
    require(path, "path");
    require(topology, "topology");
    give(load(object, path, MorselBuildOptions{}), topology);
  });
}

MorselResult morsel_load_topology_with(MorselField field, const char* path,
                                       const MorselBuildOptions* options,
                                       MorselTopology* topology) {
  return call(field, [&] {
    const auto object = shared_object_of<FieldObject>(field);
    require(path, "path");
    require(topology, "topology");
    give(load(*object, path, read_build_options(options)), topology);
  });
}

MorselResult morsel_open_topology(MorselField field, const char* path,
                                  const MorselBuildOptions* options, MorselTopology* topology) {
  return call(field, [&] {
    const auto object = shared_object_of<FieldObject>(field);
    require(path, "path");
    require(topology, "topology");
    const MorselBuildOptions o = read_build_options(options);
    std::error_code error;
    if (std::filesystem::status(path, error).type() != std::filesystem::file_type::not_found) {
      give(load(*object, path, o), topology);
      return;
    }
    require_writable_folder(path);
    TopologyCache cache = build(object->hypertexture, o);
    morsel::topology::write_cache(cache, path);
    give(object_with(std::move(cache), path), topology);
  });
}

MorselResult morsel_save_topology(MorselTopology topology, const char* path) {
  return call(topology, [&] {
    const auto object = shared_object_of<TopologyObject>(topology);
    require(path, "path");
    require_writable_folder(path);
    TopologyCache copy = *object->cache;  // writing notes the size of the file
    morsel::topology::write_cache(copy, path);
  });
}

MorselResult morsel_retain_topology(MorselTopology topology) {
  return call(topology, [&] { retain(topology, Kind::kTopology); });
}

MorselResult morsel_release_topology(MorselTopology topology) {
  return call(topology, [&] { release(topology, Kind::kTopology); });
}

MorselResult morsel_topology_info(MorselTopology topology, MorselTopologyInfo* info) {
  return call(topology, [&] {
    const auto& object = object_of<TopologyObject>(topology);
    require(info, "info");
    const morsel::topology::Topology& t = object.cache->topology;
    MorselTopologyInfo r{};
    r.components = t.components.size();
    r.components_lo = t.components_lo;
    r.components_hi = t.components_hi.value_or(std::numeric_limits<uint64_t>::max());
    r.certified = t.certified;
    r.main_component =
        t.components.empty() ? MORSEL_NO_COMPONENT : morsel::topology::main_component(t.components);
    r.unresolved_cells = t.unresolved_cells;
    r.unresolved_faces = t.unresolved_faces;
    r.leaves = t.leaves;
    r.bytes = object.bytes;
    r.seconds = object.cache->seconds;
    store(t.box.min, r.lower);
    store(t.box.max, r.upper);
    r.critical_points = object.critical_points.size();
    write_struct(r, info, kTopologyInfoV1, "MorselTopologyInfo");
  });
}

MorselResult morsel_topology_components(MorselTopology topology, size_t first, size_t count,
                                        size_t component_size, MorselComponent* components) {
  return call(topology, [&] {
    const auto& table = object_of<TopologyObject>(topology).cache->topology.components;
    require_range("MorselComponent", "component_size", component_size, kComponentV1, first, count,
                  table.size());
    if (count == 0) return;
    require(components, "components");
    auto* out = reinterpret_cast<char*>(components);
    for (size_t i = 0; i < count; ++i, out += component_size) {
      const morsel::topology::Component& c = table[first + i];
      MorselComponent r{};
      store(c.bounds.min, r.lower);
      store(c.bounds.max, r.upper);
      r.volume_lo = c.volume_lo;
      r.volume_hi = c.volume_hi;
      r.cells = c.cells;
      store(c.seed, r.seed);
      r.maxima = c.maxima;
      write_entry(r, out, component_size);
    }
  });
}

MorselResult morsel_topology_critical_points(MorselTopology topology, size_t first, size_t count,
                                             size_t point_size, MorselCriticalPoint* points) {
  return call(topology, [&] {
    const auto& all = object_of<TopologyObject>(topology).critical_points;
    require_range("MorselCriticalPoint", "point_size", point_size, kCriticalPointV1, first, count,
                  all.size());
    if (count == 0) return;
    require(points, "points");
    auto* out = reinterpret_cast<char*>(points);
    for (size_t i = 0; i < count; ++i, out += point_size) {
      const morsel::topology::CriticalPoint& p = all[first + i];
      MorselCriticalPoint r{};
      store(p.position, r.position);
      r.radius = p.radius;
      r.value = p.value;
      store(p.eigenvalues, r.eigenvalues);
      store(p.axis, r.axis);
      r.type = static_cast<uint32_t>(p.type);
      r.component = p.set;
      write_entry(r, out, point_size);
    }
  });
}
