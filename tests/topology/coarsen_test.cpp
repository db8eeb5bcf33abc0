// SPDX-License-Identifier: Apache-2.0
// A coarsened octree answers for every place as the whole one does.
#include "topology/coarsen.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/hypertexture_geom/test_fields.h"
#include "topology/certified.h"
#include "topology/components.h"

namespace morsel::topology {
namespace {

Topology rock() {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(1, 3, 0.8, 2.0));
  CertifyOptions options;
  options.box = Box(Imath::V3d(-3.5), Imath::V3d(3.5));
  return certify(*field, options);
}

bool is_kept(const OctreeNode& node, const std::vector<bool>& kept) {
  return node.component < kept.size() && kept[node.component];
}

std::uint64_t leaves_of(std::span<const OctreeNode> nodes) {
  std::uint64_t leaves = 0;
  for (const OctreeNode& node : nodes) leaves += node.is_leaf();
  return leaves;
}

// Every leaf of the whole octree lies in one of the coarse one that says of it what it says itself.
void expect_same_answers(const Topology& t, const std::vector<bool>& kept, int levels) {
  const std::vector<OctreeNode> nodes = coarsened(t.nodes, kept, levels);
  const OctreeView coarse{t.box, nodes};
  std::uint64_t places = 0;
  t.octree().for_each_leaf([&](const OctreeView::Leaf& leaf) {
    const OctreeNode& fine = t.nodes[leaf.node];
    const OctreeView::Leaf found = coarse.locate(centre(leaf.box));
    const OctreeNode& node = nodes[found.node];
    ASSERT_LE(found.depth, leaf.depth);
    ASSERT_TRUE(found.box.intersects(leaf.box.min) && found.box.intersects(leaf.box.max));
    ++places;
    if (is_kept(fine, kept)) {
      ASSERT_EQ(node.component, fine.component);
      ASSERT_NE(node.cell_content(), Content::kEmpty);
      // Surface is at most `merged` levels further down, and full cells stay what they are.
      if (fine.cell_content() == Content::kConnected) {
        ASSERT_LE(leaf.depth - found.depth, merged_levels(node));
        ASSERT_LE(merged_levels(node), levels);
      }
    } else if (fine.cell_content() != Content::kEmpty) {
      // What is removed is never in a cell of a kept component, or rays would hit it.
      ASSERT_EQ(node.component, kNoComponent);
      ASSERT_EQ(node.cell_content(), Content::kConnected);
    }
    if (node.cell_content() == Content::kFull) {
      ASSERT_EQ(fine.cell_content(), Content::kFull);
    }
  });
  EXPECT_EQ(places, t.leaves);
}

TEST(Coarsen, SaysTheSameOfEveryLeaf) {
  const Topology t = rock();
  ASSERT_GT(t.components.size(), 3u);
  for (const char* rule : {"main", "all", "detached", "ids:1,2"}) {
    const std::vector<bool> kept = kept_components(KeepRule::parse(rule), t.components, t.octree());
    for (const int levels : {0, 1, 2, 5}) {
      SCOPED_TRACE(std::string(rule) + ", levels: " + std::to_string(levels));
      expect_same_answers(t, kept, levels);
    }
  }
}

TEST(Coarsen, IsSmaller) {
  const Topology t = rock();
  const std::vector<bool> all(t.components.size(), true), none(t.components.size(), false);
  const std::vector<bool> main = kept_components(KeepRule(), t.components, t.octree());
  const std::uint64_t whole = leaves_of(t.nodes);
  // Dividing undecided faces leaves some cells whose eight parts are alike.
  EXPECT_LE(leaves_of(coarsened(t.nodes, all, 0)), whole);
  EXPECT_LT(leaves_of(coarsened(t.nodes, main, 0)), whole);
  EXPECT_LT(leaves_of(coarsened(t.nodes, main, 2)), whole / 4);
  EXPECT_EQ(leaves_of(coarsened(t.nodes, none, 2)), 1u);
  EXPECT_TRUE(coarsened({}, all, 2).empty());
  EXPECT_THROW(coarsened(t.nodes, all, -1), std::invalid_argument);
}

// What is not decided is not merged away.
TEST(Coarsen, KeepsUndecidedLeaves) {
  std::vector<OctreeNode> nodes(9);
  nodes[0].first_child = 1;
  for (std::size_t i = 1; i < 9; ++i) {
    nodes[i].content =
        static_cast<std::uint8_t>(i == 4 ? Content::kUndecided : Content::kConnected);
    nodes[i].component = 0;
  }
  for (const bool keep : {true, false}) {
    const std::vector<OctreeNode> coarse = coarsened(nodes, {keep}, 3);
    ASSERT_EQ(coarse.size(), 9u);
    EXPECT_EQ(coarse[4].cell_content(), Content::kUndecided);
  }
  nodes[4].content = static_cast<std::uint8_t>(Content::kConnected);
  EXPECT_EQ(coarsened(nodes, {true}, 3).size(), 1u);
  EXPECT_EQ(coarsened(nodes, {true}, 0).size(), 9u);
  nodes[4].component = 1;  // two components in one cell
  EXPECT_EQ(coarsened(nodes, {true, true}, 3).size(), 9u);
  EXPECT_EQ(coarsened(nodes, {true, false}, 3).size(), 9u);
  EXPECT_EQ(coarsened(nodes, {false, false}, 0).size(), 1u);
}

}  // namespace
}  // namespace morsel::topology
