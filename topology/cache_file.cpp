// SPDX-License-Identifier: Apache-2.0
#include "topology/cache_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <span>

namespace morsel::topology {
namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "cache files are little-endian");

constexpr char kMagic[8] = {'M', 'O', 'R', 'S', 'T', 'O', 'P', 'O'};
constexpr std::uint32_t kVersion = 1;

// The first bytes of a file. Sections start at multiples of 64 so that they can be used where they
// are mapped.
struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t header_bytes;
  std::uint64_t file_bytes;
  std::uint64_t meta_offset, meta_bytes;  // JSON
  std::uint64_t node_offset, node_count;
  std::uint64_t component_offset, component_count;
  std::uint64_t reserved[6];
  std::uint64_t checksum;  // XXH3 of the whole file with this field zero
};
static_assert(sizeof(Header) == 128);

struct ComponentRecord {
  double bounds[6];
  double volume_lo, volume_hi;
  std::uint64_t cells, maxima;
  double seed[3];
  double seed_volume;
};
static_assert(sizeof(ComponentRecord) == 112);

std::uint64_t aligned(std::uint64_t offset) { return (offset + 63) & ~std::uint64_t{63}; }

std::uint64_t checksum_of(std::span<const std::byte> file) {
  // Streamed, since the field itself counts as zero.
  XXH3_state_t* state = XXH3_createState();
  XXH3_64bits_reset(state);
  constexpr std::size_t at = offsetof(Header, checksum);
  const std::uint64_t zero = 0;
  XXH3_64bits_update(state, file.data(), at);
  XXH3_64bits_update(state, &zero, sizeof zero);
  XXH3_64bits_update(state, file.data() + at + sizeof zero, file.size() - at - sizeof zero);
  const std::uint64_t sum = XXH3_64bits_digest(state);
  XXH3_freeState(state);
  return sum;
}

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

// A tree: each node but the root has one parent, no cycles, no depth beyond the limit, known
// contents and components, and the leaves that the metadata counts.
void check_tree(const Topology& t, const std::string& where) {
  const auto bad = [&](std::size_t node, const char* what) {
    throw CacheError(fmt::format("{}: octree node {}: {}", where, node, what));
  };
  for (int axis = 0; axis < 3; ++axis)
    if (!(t.box.min[axis] < t.box.max[axis]))
      throw CacheError(where + ": the octree's box has no extent");
  struct Entry {
    std::uint32_t node;
    int depth;
  };
  std::vector<bool> seen(t.nodes.size(), false);
  std::vector<Entry> stack{{0, 0}};
  std::uint64_t visited = 0, leaves = 0;
  while (!stack.empty()) {
    const Entry e = stack.back();
    stack.pop_back();
    if (seen[e.node]) bad(e.node, "reached twice");
    seen[e.node] = true;
    ++visited;
    const OctreeNode& node = t.nodes[e.node];
    if (node.content > 3) bad(e.node, "unknown content");
    if (node.component != kNoComponent && node.component >= t.components.size())
      bad(e.node, "component that is not in the table");
    if (node.is_leaf()) {
      ++leaves;
      continue;
    }
    if (e.depth >= kMaxDepth) bad(e.node, "deeper than the limit");
    if (std::uint64_t{node.first_child} + 8 > t.nodes.size())
      bad(e.node, "children beyond the end");
    for (std::uint32_t i = 0; i < 8; ++i) stack.push_back({node.first_child + i, e.depth + 1});
  }
  if (visited != t.nodes.size())
    throw CacheError(where + ": octree has nodes that nothing leads to");
  if (leaves != t.leaves)
    throw CacheError(where + ": octree has another number of leaves than its header says");
}

// Owns a temporary file until it is renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target)
      : target_(target), path_(target.string() + fmt::format(".{}.tmp", ::getpid())) {
    fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd_ < 0) fail("cannot create");
  }
  ~TemporaryFile() {
    if (fd_ >= 0) ::close(fd_);
    if (!path_.empty()) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::write(fd_, bytes.data(), std::min<std::size_t>(bytes.size(), 1u << 30));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail("cannot write");
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
  }
  void publish() {
    if (::fsync(fd_) != 0) fail("cannot write");
    const int fd = fd_;
    fd_ = -1;
    if (::close(fd) != 0) fail("cannot write");
    if (::rename(path_.c_str(), target_.c_str()) != 0) fail("cannot rename");
    path_.clear();
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw CacheError(fmt::format("{}: {}: {}", target_.string(), what, std::strerror(errno)));
  }
  std::filesystem::path target_;
  std::string path_;
  int fd_ = -1;
};

}  // namespace

void write_cache(TopologyCache& cache, const std::filesystem::path& path) {
  const Topology& t = cache.topology;
  const std::string meta = meta_of(cache).dump();
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = kVersion;
  header.header_bytes = sizeof(Header);
  header.meta_offset = sizeof(Header);
  header.meta_bytes = meta.size();
  header.node_offset = aligned(header.meta_offset + header.meta_bytes);
  header.node_count = t.nodes.size();
  header.component_offset = aligned(header.node_offset + header.node_count * sizeof(OctreeNode));
  header.component_count = t.components.size();
  header.file_bytes = header.component_offset + header.component_count * sizeof(ComponentRecord);

  std::vector<std::byte> file(header.file_bytes, std::byte{0});
  std::memcpy(file.data() + header.meta_offset, meta.data(), meta.size());
  std::memcpy(file.data() + header.node_offset, t.nodes.data(),
              t.nodes.size() * sizeof(OctreeNode));
  for (std::size_t i = 0; i < t.components.size(); ++i) {
    const Component& c = t.components[i];
    const ComponentRecord record{{c.bounds.min.x, c.bounds.min.y, c.bounds.min.z, c.bounds.max.x,
                                  c.bounds.max.y, c.bounds.max.z},
                                 c.volume_lo,
                                 c.volume_hi,
                                 c.cells,
                                 c.maxima,
                                 {c.seed.x, c.seed.y, c.seed.z},
                                 c.seed_volume};
    std::memcpy(file.data() + header.component_offset + i * sizeof record, &record, sizeof record);
  }
  std::memcpy(file.data(), &header, sizeof header);
  header.checksum = checksum_of(file);
  std::memcpy(file.data(), &header, sizeof header);

  TemporaryFile temporary(path);
  temporary.write(file);
  temporary.publish();
  cache.bytes = header.file_bytes;
}

TopologyCache read_cache(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code ec;
  if (std::filesystem::is_directory(path, ec))
    throw CacheError(name + ": is a directory, not a cache file");
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) throw CacheError(fmt::format("{}: cannot open: {}", name, std::strerror(errno)));
  const auto size = static_cast<std::uint64_t>(in.tellg());
  if (size < sizeof(Header))
    throw CacheError(fmt::format("{}: not a topology cache: {} bytes are fewer than its header has",
                                 name, size));
  in.seekg(0);
  Header header;
  in.read(reinterpret_cast<char*>(&header), sizeof header);
  if (!in || std::memcmp(header.magic, kMagic, sizeof kMagic) != 0)
    throw CacheError(name + ": not a topology cache: wrong first bytes");
  if (header.version != kVersion)
    throw CacheError(
        fmt::format("{}: version {} of the cache format; this program reads version {}", name,
                    header.version, kVersion));
  if (header.file_bytes != size)
    throw CacheError(fmt::format("{}: truncated or overlong: {} bytes instead of {}", name, size,
                                 header.file_bytes));

  const auto check_section = [&](const char* what, std::uint64_t offset, std::uint64_t count,
                                 std::uint64_t each) {
    if (offset < sizeof(Header) || offset > size || count > (size - offset) / each)
      throw CacheError(fmt::format("{}: header: {} lie outside the file", name, what));
  };
  check_section("metadata", header.meta_offset, header.meta_bytes, 1);
  check_section("octree nodes", header.node_offset, header.node_count, sizeof(OctreeNode));
  check_section("components", header.component_offset, header.component_count,
                sizeof(ComponentRecord));
  if (header.node_count == 0 || header.node_count > kNoComponent)
    throw CacheError(fmt::format("{}: header: {} octree nodes", name, header.node_count));

  std::vector<std::byte> file(size);
  in.seekg(0);
  in.read(reinterpret_cast<char*>(file.data()), static_cast<std::streamsize>(size));
  if (!in) throw CacheError(name + ": cannot read");
  if (checksum_of(file) != header.checksum)
    throw CacheError(name + ": damaged: the checksum does not match");

  TopologyCache cache;
  cache.bytes = size;
  try {
    const char* meta = reinterpret_cast<const char*>(file.data()) + header.meta_offset;
    read_meta(json::parse(meta, meta + header.meta_bytes), cache);
  } catch (const json::exception& e) {
    throw CacheError(fmt::format("{}: metadata: {}", name, e.what()));
  }
  Topology& t = cache.topology;
  t.nodes.resize(header.node_count);
  std::memcpy(t.nodes.data(), file.data() + header.node_offset,
              header.node_count * sizeof(OctreeNode));
  t.components.resize(header.component_count);
  for (std::size_t i = 0; i < t.components.size(); ++i) {
    ComponentRecord r;
    std::memcpy(&r, file.data() + header.component_offset + i * sizeof r, sizeof r);
    Component& c = t.components[i];
    c.bounds = Box(Imath::V3d(r.bounds[0], r.bounds[1], r.bounds[2]),
                   Imath::V3d(r.bounds[3], r.bounds[4], r.bounds[5]));
    c.volume_lo = r.volume_lo;
    c.volume_hi = r.volume_hi;
    c.cells = r.cells;
    c.maxima = r.maxima;
    c.seed = Imath::V3d(r.seed[0], r.seed[1], r.seed[2]);
    c.seed_volume = r.seed_volume;
  }
  check_tree(t, name);
  return cache;
}

TopologyCache read_cache_of(const std::filesystem::path& path, const std::string& field_hash) {
  TopologyCache cache = read_cache(path);
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
                     {"kept", static_cast<bool>(kept[i])}});
  }
  json unresolved = json::array();
  for (const Unresolved& u : t.unresolved)
    unresolved.push_back({{"box", box_json(u.box)}, {"value", u.value}});
  return {
      {"components", t.components.size()},
      {"components_bounds",
       {json(t.components_lo), t.components_hi ? json(*t.components_hi) : json()}},
      {"certified", t.certified},
      {"unresolved_cells", t.unresolved_cells},
      {"unresolved_faces", t.unresolved_faces},
      {"unresolved", unresolved},
      {"engine", t.engine},
      // The certified engine computes no critical points.
      {"critical_points",
       {{"maxima", nullptr}, {"saddles2", nullptr}, {"saddles1", nullptr}, {"minima", nullptr}}},
      {"keep", keep.to_string()},
      {"kept", kept_count},
      {"field_hash", cache.field_hash},
      {"field", cache.field},
      {"seconds", cache.seconds},
      {"bytes", cache.bytes},
      {"box", box_json(t.box)},
      {"touches_box", t.touches_box ? vector_json(*t.touches_box) : json()},
      {"octree",
       {{"leaves", t.leaves}, {"nodes", t.nodes.size()}, {"depth", t.depth}, {"models", t.models}}},
      {"component_table", table}};
}

}  // namespace morsel::topology
