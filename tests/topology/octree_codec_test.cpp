// SPDX-License-Identifier: Apache-2.0
// Octrees come back as they went in; streams of anything else give an error or an octree that is
// well-formed, never a crash.
#include "topology/octree_codec.h"

#include <gtest/gtest.h>

#include <random>

#include "topology/certified.h"
#include "topology/section_file.h"

namespace morsel::topology {
namespace {

// A random octree, in the order in which it will come back.
std::vector<OctreeNode> random_octree(std::mt19937& random, std::uint32_t components, int depth) {
  std::vector<OctreeNode> nodes(1);
  const auto grow = [&](auto&& self, std::uint32_t n, int left) -> void {
    if (left > 0 && random() % 3 != 0) {
      const auto first = static_cast<std::uint32_t>(nodes.size());
      nodes[n].first_child = first;
      nodes[n].content = static_cast<std::uint8_t>(Content::kUndecided);
      nodes.resize(first + 8);
      // Leaves first get their contents, as siblings stand together.
      for (std::uint32_t i = 0; i < 8; ++i) self(self, first + i, left - 1);
      return;
    }
    OctreeNode& node = nodes[n];
    node.content = static_cast<std::uint8_t>(random() % 4);
    for (int f = 0; f < 6; ++f)
      node.set_face_content(f / 2, f % 2,
                            node.content == 0 || node.content == 2
                                ? node.cell_content()
                                : static_cast<Content>(random() % 4));
    if (node.content == 0) return;
    node.component = static_cast<std::uint32_t>(random()) % components;
    if (node.content == 3 && random() % 2 == 0) node.component = kNoComponent;
  };
  grow(grow, 0, depth);
  return nodes;
}

bool equal(const OctreeNode& a, const OctreeNode& b) {
  return a.first_child == b.first_child && a.component == b.component && a.faces == b.faces &&
         a.content == b.content;
}

TEST(OctreeCodec, RoundTrip) {
  std::mt19937 random(5);
  for (int n = 0; n < 200; ++n) {
    const std::uint32_t components = n % 3 == 0 ? 1 : n % 3 == 1 ? 7 : 4000000000u;
    const std::vector<OctreeNode> nodes = random_octree(random, components, n % 5);
    const std::vector<std::byte> packed = pack_octree(nodes);
    const std::vector<OctreeNode> back = unpack_octree(packed, nodes.size(), components, "x");
    ASSERT_EQ(back.size(), nodes.size());
    // The order of groups of siblings is depth-first in both.
    for (std::size_t i = 0; i < nodes.size(); ++i) ASSERT_TRUE(equal(back[i], nodes[i])) << i;
    EXPECT_THROW(unpack_octree(packed, nodes.size() + 8, components, "x"), CacheError);
    if (nodes.size() > 1) {
      EXPECT_THROW(unpack_octree(packed, nodes.size() - 8, components, "x"), CacheError);
      EXPECT_THROW(
          unpack_octree(std::span(packed).first(packed.size() - 1), nodes.size(), components, "x"),
          CacheError);
    }
  }
}

TEST(OctreeCodec, AnyBytesAreSafe) {
  std::mt19937 random(6);
  int accepted = 0;
  for (int n = 0; n < 5000; ++n) {
    const std::vector<OctreeNode> true_nodes = random_octree(random, 3, 1 + n % 3);
    std::vector<std::byte> bytes = pack_octree(true_nodes);
    for (std::uint32_t flips = random() % 4; flips > 0; --flips)
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1u << random() % 8);
    if (random() % 8 == 0) bytes.resize(random() % 60);
    const std::uint64_t count = true_nodes.size();
    try {
      const std::vector<OctreeNode> nodes = unpack_octree(bytes, count, 3, "x");
      ++accepted;
      ASSERT_EQ(nodes.size(), count);
      std::size_t leaves = 0;
      OctreeView{Box(Imath::V3d(0.0), Imath::V3d(1.0)), nodes}.for_each_leaf(
          [&](const OctreeView::Leaf&) { ++leaves; });
      EXPECT_EQ(leaves, (count - 1) / 8 * 7 + 1);
    } catch (const CacheError&) {
    }
  }
  EXPECT_GT(accepted, 1000);
}

TEST(OctreeCodec, TooDeepAndTooMany) {
  // Nothing but inner nodes: refused at the depth limit, before the count is reached.
  const std::vector<std::byte> zeros(1 << 16);
  EXPECT_THROW(unpack_octree(zeros, 1 + 8 * 20000, 1, "x"), CacheError);
  // Counts that no stream of this size can hold are refused before memory is taken.
  EXPECT_THROW(unpack_octree(zeros, std::uint64_t{1} << 31, 1, "x"), CacheError);
  EXPECT_THROW(unpack_octree(zeros, ~std::uint64_t{0}, 1, "x"), CacheError);
  EXPECT_THROW(unpack_octree({}, 0, 1, "x"), CacheError);
}

}  // namespace
}  // namespace morsel::topology
