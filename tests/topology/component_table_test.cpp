// SPDX-License-Identifier: Apache-2.0
// Joining cells across faces of which some are undecided, in octrees put together by hand.
#include "topology/component_table.h"

#include <gtest/gtest.h>

#include "tests/topology/blobs.h"

namespace morsel::topology {
namespace {

const Box kBox(Imath::V3d(0.0), Imath::V3d(1.0));

OctreeNode cell_with_faces(Content content) {
  OctreeNode node;
  node.content = static_cast<std::uint8_t>(Content::kConnected);
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) node.set_face_content(axis, side, content);
  return node;
}

// Eight cells with a part of S in each, as one tree or as eight. All faces are as given, but the
// one between the cells 0 and 1 is undecided.
Topology joined(Content faces, bool eight_trees) {
  OctreeNode cells[8];
  for (OctreeNode& cell : cells) cell = cell_with_faces(faces);
  cells[0].set_face_content(0, 1, Content::kUndecided);
  cells[1].set_face_content(0, 0, Content::kUndecided);
  Forest forest;
  forest.box = kBox;
  forest.upper.resize(eight_trees ? 9 : 1);
  if (eight_trees) {
    forest.upper[0].first_child = 1;
    for (std::uint32_t i = 0; i < 8; ++i) {
      forest.upper[1 + i].tree = i;
      forest.trees.push_back(
          {child_box(kBox, static_cast<int>(i)), 1, {i & 1u, (i >> 1) & 1u, i >> 2}, {cells[i]}});
    }
  } else {
    Tree tree{kBox, 0, {}, {OctreeNode{}}};
    tree.nodes[0].first_child = 1;
    tree.nodes.insert(tree.nodes.end(), cells, cells + 8);
    forest.trees.push_back(tree);
  }
  Topology topology;
  topology.box = kBox;
  label_components(testing::Constant(1.0), forest, {}, topology);
  return topology;
}

TEST(ComponentTable, AnUndecidedFaceBetweenCellsThatAreJoinedElsewhereIsNoMatter) {
  for (const bool eight_trees : {false, true}) {
    const Topology t = joined(Content::kConnected, eight_trees);
    EXPECT_TRUE(t.certified);
    EXPECT_EQ(t.unresolved_faces, 0u);
    EXPECT_TRUE(t.unresolved.empty());
    EXPECT_EQ(t.components.size(), 1u);
    EXPECT_EQ(t.components_lo, 1u);
    EXPECT_EQ(t.components_hi, 1u);
  }
}

TEST(ComponentTable, AnUndecidedFaceThatMayJoinTwoComponentsIsReported) {
  for (const bool eight_trees : {false, true}) {
    const Topology t = joined(Content::kEmpty, eight_trees);
    EXPECT_FALSE(t.certified);
    EXPECT_EQ(t.unresolved_faces, 1u);
    ASSERT_EQ(t.unresolved.size(), 1u);
    EXPECT_EQ(t.unresolved[0].box.min, Imath::V3d(0.5, 0.0, 0.0));
    EXPECT_EQ(t.unresolved[0].box.max, Imath::V3d(0.5, 0.5, 0.5));
    EXPECT_EQ(t.components.size(), 8u);
    EXPECT_EQ(t.components_lo, 7u);
    EXPECT_EQ(t.components_hi, 8u);
    // The two that may be one share what either may reach.
    int both = 0;
    for (const Component& c : t.components) {
      if (c.bounds.max.x - c.bounds.min.x < 0.9) {
        EXPECT_NEAR(c.volume_hi, 0.125, 1e-12);
        continue;
      }
      ++both;
      EXPECT_EQ(c.bounds.min, Imath::V3d(0.0));
      EXPECT_EQ(c.bounds.max, Imath::V3d(1.0, 0.5, 0.5));
      EXPECT_GE(c.volume_hi, 0.25);
      EXPECT_NEAR(c.volume_hi, 0.25, 1e-12);
    }
    EXPECT_EQ(both, 2);
  }
}

}  // namespace
}  // namespace morsel::topology
