// SPDX-License-Identifier: Apache-2.0
// A cache file. Inputs that begin with the file's magic are taken as they are; all others are the
// sections of one, so that checksums do not keep the fuzzer out: two lengths of 16 bits, metadata
// and components of those lengths, the packed octree.
#include <cstring>
#include <filesystem>
#include <span>

#include "tests/fuzz/scratch.h"
#include "tests/fuzz/target.h"
#include "topology/cache_file.h"
#include "topology/coarsen.h"
#include "topology/octree_codec.h"

namespace {

using morsel::test::require;
using namespace morsel::topology;

std::filesystem::path scratch() { return morsel::test::scratch_folder() / "cache.topo"; }

void write_sections(morsel::test::Input in) {
  constexpr std::uint32_t kComponentBytes = 112;
  const std::uint32_t meta_bytes = in.word(), component_bytes = in.word();
  const auto meta = in.take(meta_bytes);
  const auto components = in.take(component_bytes / kComponentBytes * kComponentBytes);
  SectionWriter writer(scratch());
  writer.add("meta", meta, 1, true);
  writer.add("components", components.first(components.size() / kComponentBytes * kComponentBytes),
             kComponentBytes, true);
  writer.add("octree.packed", in.rest(), 1, true);
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
  try {
    if (size >= 8 && std::memcmp(data, kTopologyFormat.magic, 8) == 0)
      morsel::test::write_file(scratch(), std::as_bytes(std::span(data, size)));
    else
      write_sections({data, size});
    use(read_cache(scratch()));
  } catch (const CacheError&) {
  }
  return 0;
}
