// SPDX-License-Identifier: Apache-2.0
#include "topology/cache_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <string_view>

#include "topology/morse/morse_sections.h"
#include "topology/octree_codec.h"

namespace morsel::topology {
namespace {

using nlohmann::json;

// The sections that every cache has.
constexpr std::string_view kMeta = "meta";              // JSON
constexpr std::string_view kNodes = "octree.packed";    // see octree_codec.h
constexpr std::string_view kComponents = "components";  // ComponentRecord
constexpr std::string_view kOwn[] = {kMeta, kNodes, kComponents};

struct ComponentRecord {
  double bounds[6];
  double volume_lo, volume_hi;
  std::uint64_t cells, maxima;
  double seed[3];
  double seed_volume;
};
static_assert(sizeof(ComponentRecord) == 112);

json vector_json(const Imath::V3d& v) { return {v.x, v.y, v.z}; }

Imath::V3d vector_of(const json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

json box_json(const Box& b) { return {{"min", vector_json(b.min)}, {"max", vector_json(b.max)}}; }

Box box_of(const json& j) { return {vector_of(j.at("min")), vector_of(j.at("max"))}; }

json meta_of(const TopologyCache& cache) {
  const Topology& t = cache.topology;
  json unresolved = json::array();
  for (const Unresolved& u : t.unresolved)
    unresolved.push_back({{"box", box_json(u.box)}, {"value", u.value}});
  return {{"field_hash", cache.field_hash},
          {"field", cache.field},
          {"seconds", cache.seconds},
          {"engine", t.engine},
          {"box", box_json(t.box)},
          {"certified", t.certified},
          {"components_lo", t.components_lo},
          {"components_hi", t.components_hi ? json(*t.components_hi) : json()},
          {"unresolved_cells", t.unresolved_cells},
          {"unresolved_faces", t.unresolved_faces},
          {"unresolved", unresolved},
          {"touches_box", t.touches_box ? vector_json(*t.touches_box) : json()},
          {"leaves", t.leaves},
          {"nodes", t.nodes.size()},
          {"depth", t.depth},
          {"models", t.models}};
}

void read_meta(const json& meta, TopologyCache& cache) {
  Topology& t = cache.topology;
  cache.field_hash = meta.at("field_hash").get<std::string>();
  cache.field = meta.at("field");
  cache.seconds = meta.at("seconds").get<double>();
  t.engine = meta.at("engine").get<std::string>();
  t.box = box_of(meta.at("box"));
  t.certified = meta.at("certified").get<bool>();
  t.components_lo = meta.at("components_lo").get<std::uint64_t>();
  if (const json& hi = meta.at("components_hi"); !hi.is_null())
    t.components_hi = hi.get<std::uint64_t>();
  t.unresolved_cells = meta.at("unresolved_cells").get<std::uint64_t>();
  t.unresolved_faces = meta.at("unresolved_faces").get<std::uint64_t>();
  for (const json& u : meta.at("unresolved"))
    t.unresolved.push_back({box_of(u.at("box")), u.at("value").get<double>()});
  if (const json& place = meta.at("touches_box"); !place.is_null())
    t.touches_box = vector_of(place);
  t.leaves = meta.at("leaves").get<std::uint64_t>();
  t.depth = meta.at("depth").get<int>();
  t.models = meta.at("models").get<std::uint64_t>();
}

// What is left to check of an octree that could be unpacked.
void check_octree(const Topology& t, const std::string& where) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(t.box.min[axis] < t.box.max[axis]))
      throw CacheError(where + ": the octree's box has no extent");
  std::uint64_t leaves = 0;
  for (const OctreeNode& node : t.nodes) leaves += node.is_leaf();
  if (leaves != t.leaves)
    throw CacheError(where + ": octree has another number of leaves than its header says");
}

// Null where the Morse engine did not run.
json critical_points_json(const std::optional<MorseComplex>& morse) {
  const auto count = [&](CriticalType type) { return morse ? json(morse->count(type)) : json(); };
  return {{"maxima", count(CriticalType::kMaximum)},
          {"saddles2", count(CriticalType::kSaddle2)},
          {"saddles1", count(CriticalType::kSaddle1)},
          {"minima", count(CriticalType::kMinimum)},
          {"degenerate", count(CriticalType::kDegenerate)}};
}

ComponentRecord record_of(const Component& c) {
  return {{c.bounds.min.x, c.bounds.min.y, c.bounds.min.z, c.bounds.max.x, c.bounds.max.y,
           c.bounds.max.z},
          c.volume_lo,
          c.volume_hi,
          c.cells,
          c.maxima,
          {c.seed.x, c.seed.y, c.seed.z},
          c.seed_volume};
}

Component component_of(const ComponentRecord& r) {
  Component c;
  c.bounds = Box(Imath::V3d(r.bounds[0], r.bounds[1], r.bounds[2]),
                 Imath::V3d(r.bounds[3], r.bounds[4], r.bounds[5]));
  c.volume_lo = r.volume_lo;
  c.volume_hi = r.volume_hi;
  c.cells = r.cells;
  c.maxima = r.maxima;
  c.seed = Imath::V3d(r.seed[0], r.seed[1], r.seed[2]);
  c.seed_volume = r.seed_volume;
  return c;
}

}  // namespace

void write_cache(TopologyCache& cache, const std::filesystem::path& path) {
  const Topology& t = cache.topology;
  const std::string meta = meta_of(cache).dump();
  std::vector<ComponentRecord> components;
  components.reserve(t.components.size());
  for (const Component& c : t.components) components.push_back(record_of(c));
  SectionWriter writer(path);
  writer.add(kMeta, std::as_bytes(std::span(meta)), 1, true);
  writer.add_records<ComponentRecord>(kComponents, components, true);
  writer.add(kNodes, pack_octree(t.nodes), 1, true);
  for (const Section& s : cache.sections.all()) writer.add(s.name, s.bytes, s.element_bytes);
  cache.bytes = writer.publish();
}

TopologyCache read_cache(const std::filesystem::path& path, const Execution& execution) {
  const SectionFile file(path);
  file.require_known(kOwn);
  TopologyCache cache;
  cache.bytes = file.bytes();
  std::uint64_t nodes = 0;
  try {
    const std::vector<char> meta = file.read_records<char>(kMeta);
    const json parsed = json::parse(meta.begin(), meta.end());
    read_meta(parsed, cache);
    nodes = parsed.at("nodes").get<std::uint64_t>();
  } catch (const json::exception& e) {
    throw CacheError(fmt::format("{}: metadata: {}", file.name(), e.what()));
  }
  Topology& t = cache.topology;
  for (const ComponentRecord& r : file.read_records<ComponentRecord>(kComponents))
    t.components.push_back(component_of(r));
  t.nodes = unpack_octree(file.read(kNodes), nodes, t.components.size(), file.name(), execution);
  check_octree(t, file.name());
  for (const SectionEntry& e : file.entries())
    if (std::find(std::begin(kOwn), std::end(kOwn), e.name) == std::end(kOwn))
      cache.sections.put({e.name, e.element_bytes, file.read(e.name)});
  return cache;
}

TopologyCache read_cache_of(const std::filesystem::path& path, const std::string& field_hash,
                            const Execution& execution) {
  TopologyCache cache = read_cache(path, execution);
  if (cache.field_hash != field_hash)
    throw CacheError(
        fmt::format("{}: is the cache of another field: its fingerprint is {}, the scene's is {}; "
                    "rebuild it with \"morsel cache build\"",
                    path.string(), cache.field_hash, field_hash));
  return cache;
}

json describe(const TopologyCache& cache, const KeepRule& keep) {
  const Topology& t = cache.topology;
  const std::vector<bool> kept = kept_components(keep, t.components, t.octree());
  std::uint64_t kept_count = 0;
  json table = json::array();
  for (std::size_t i = 0; i < t.components.size(); ++i) {
    const Component& c = t.components[i];
    kept_count += kept[i];
    table.push_back({{"id", i},
                     {"bounds", box_json(c.bounds)},
                     {"volume", {c.volume_lo, c.volume_hi}},
                     {"cells", c.cells},
                     {"maxima", c.maxima > 0 ? json(c.maxima) : json()},
                     {"kept", static_cast<bool>(kept[i])}});
  }
  json unresolved = json::array();
  for (const Unresolved& u : t.unresolved)
    unresolved.push_back({{"box", box_json(u.box)}, {"value", u.value}});
  const std::optional<MorseComplex> morse =
      get_morse(cache.sections, t.components.size(), "topology cache");
  json sections = json::object();
  for (const Section& s : cache.sections.all()) sections[s.name] = s.bytes.size();
  return {
      {"components", t.components.size()},
      {"components_bounds",
       {json(t.components_lo), t.components_hi ? json(*t.components_hi) : json()}},
      {"certified", t.certified},
      {"unresolved_cells", t.unresolved_cells},
      {"unresolved_faces", t.unresolved_faces},
      {"unresolved", unresolved},
      {"engine", t.engine},
      {"critical_points", critical_points_json(morse)},
      {"morse", morse_meta(cache.sections, "topology cache")},
      {"keep", keep.to_string()},
      {"kept", kept_count},
      {"field_hash", cache.field_hash},
      {"field", cache.field},
      {"seconds", cache.seconds},
      {"bytes", cache.bytes},
      {"sections", sections},  // of other engines: bytes
      {"box", box_json(t.box)},
      {"touches_box", t.touches_box ? vector_json(*t.touches_box) : json()},
      {"octree",
       {{"leaves", t.leaves}, {"nodes", t.nodes.size()}, {"depth", t.depth}, {"models", t.models}}},
      {"component_table", table}};
}

}  // namespace morsel::topology
