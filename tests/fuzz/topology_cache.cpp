// SPDX-License-Identifier: Apache-2.0
// A cache file. Inputs that begin with the file's magic are taken as they are; all others are the
// sections of one, so that checksums do not keep the fuzzer out: two lengths of 16 bits, metadata
// and components of those lengths, the packed octree.
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include "tests/fuzz/target.h"
#include "topology/cache_file.h"
#include "topology/coarsen.h"
#include "topology/octree_codec.h"

namespace {

using morsel::test::require;
using namespace morsel::topology;

// One file for all inputs, in memory where that is possible.
const std::filesystem::path& scratch() {
  static const std::filesystem::path path = [] {
    const std::filesystem::path memory = "/dev/shm";
    const auto folder =
        std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
    return folder / ("morsel_fuzz_" + std::to_string(::getpid()) + ".topo");
  }();
  return path;
}

struct RemoveAtEnd {
  ~RemoveAtEnd() {
    std::error_code ignored;
    std::filesystem::remove(scratch(), ignored);
  }
};

void write_sections(std::span<const std::byte> in) {
  std::uint16_t lengths[2] = {0, 0};
  std::memcpy(lengths, in.data(), std::min(in.size(), sizeof lengths));
  in = in.subspan(std::min(in.size(), sizeof lengths));
  const auto take = [&](std::size_t count) {
    const auto part = in.first(std::min(in.size(), count));
    in = in.subspan(part.size());
    return part;
  };
  constexpr std::uint32_t kComponentBytes = 112;
  const auto meta = take(lengths[0]);
  const auto components = take(lengths[1] / kComponentBytes * kComponentBytes);
  SectionWriter writer(scratch());
  writer.add("meta", meta, 1, true);
  writer.add("components", components.first(components.size() / kComponentBytes * kComponentBytes),
             kComponentBytes, true);
  writer.add("octree.packed", in, 1, true);
  writer.publish();
}

void use(const TopologyCache& cache) {
  const Topology& t = cache.topology;
  require(!t.nodes.empty(), "an octree has a root");
  std::uint64_t leaves = 0;
  t.octree().for_each_leaf([&](const OctreeView::Leaf&) { ++leaves; });
  require(leaves == t.leaves, "the leaves are as many as the cache says");
  const auto packed = pack_octree(t.nodes);
  const auto again = unpack_octree(packed, t.nodes.size(), t.components.size(), "again");
  require(pack_octree(again) == packed, "an octree survives packing");
  for (int levels = 0; levels < 3; ++levels) {
    const std::vector<bool> kept(t.components.size(), levels == 1);
    require(coarsened(t.nodes, kept, levels).size() <= t.nodes.size(), "coarse octrees are small");
  }
  // What the metadata says of other sections is checked here.
  try {
    describe(cache, KeepRule{}).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  } catch (const CacheError&) {
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const RemoveAtEnd remove_at_end;
  try {
    if (size >= 8 && std::memcmp(data, kTopologyFormat.magic, 8) == 0)
      std::ofstream(scratch(), std::ios::binary)
          .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    else
      write_sections(std::as_bytes(std::span(data, size)));
    use(read_cache(scratch()));
  } catch (const CacheError&) {
  }
  return 0;
}
