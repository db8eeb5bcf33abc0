// SPDX-License-Identifier: Apache-2.0
// A true octree passes, full and by sample; any lie about a cell, a face, a join or the table is
// found.
#include "topology/verify.h"

#include <gtest/gtest.h>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/blobs.h"

namespace morsel::topology {
namespace {

using testing::Blobs;

class Verify : public ::testing::Test {
 protected:
  Verify() {
    CertifyOptions options;
    options.box = Box(Imath::V3d(-2.0), Imath::V3d(5.0, 2.0, 2.0));
    topology_ = certify(field_, options);
  }
  bool passes(const Topology& t, bool full = true) {
    VerifyOptions options;
    options.full = full;
    options.samples = 100;
    return verify(field_, t, options).passed();
  }
  // A leaf of this content.
  std::uint32_t leaf(Content content, std::uint32_t component = kNoComponent) {
    for (std::uint32_t n = 0; n < topology_.nodes.size(); ++n) {
      const OctreeNode& node = topology_.nodes[n];
      if (node.is_leaf() && node.cell_content() == content &&
          (component == kNoComponent || node.component == component))
        return n;
    }
    throw std::logic_error("no such leaf");
  }

  Blobs field_{{{0, 0, 0}, {3, 0, 0}}, 1.0, 0.3};
  Topology topology_;
};

TEST_F(Verify, ATrueOctreePasses) {
  EXPECT_EQ(topology_.components.size(), 2u);
  VerifyOptions options;
  options.full = true;
  const VerifyReport all = verify(field_, topology_, options);
  EXPECT_TRUE(all.passed()) << (all.failures.empty() ? "" : all.failures[0]);
  EXPECT_EQ(all.leaves, topology_.leaves);
  EXPECT_EQ(all.cells_proved, topology_.leaves);
  EXPECT_GT(all.faces_proved, 0u);
  EXPECT_GT(all.joins_checked, 0u);
  options = {};
  options.samples = 50;
  const VerifyReport some = verify(field_, topology_, options);
  EXPECT_TRUE(some.passed());
  EXPECT_EQ(some.cells_proved, 50u);
  // Another draw.
  options.seed = 1;
  EXPECT_NE(verify(field_, topology_, options).faces_proved, 0u);
}

TEST_F(Verify, NoisyFieldsPass) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(1, 4, 0.8, 2.0));
  CertifyOptions options;
  options.box = Box(Imath::V3d(-3.0), Imath::V3d(3.0));
  const Topology t = certify(*field, options);
  VerifyOptions full;
  full.full = true;
  const VerifyReport report = verify(*field, t, full);
  EXPECT_TRUE(report.passed()) << (report.failures.empty() ? "" : report.failures[0]);
  EXPECT_EQ(report.cells_proved, t.leaves);
}

TEST_F(Verify, OctreesWithUndecidedCellsPass) {
  CertifyOptions options;
  options.box = Box(Imath::V3d(-2.0), Imath::V3d(5.0, 2.0, 2.0));
  options.max_depth = 4;
  const Topology t = certify(field_, options);
  EXPECT_FALSE(t.certified);
  VerifyOptions full;
  full.full = true;
  const VerifyReport report = verify(field_, t, full);
  EXPECT_TRUE(report.passed()) << (report.failures.empty() ? "" : report.failures[0]);
  EXPECT_GT(report.undecided, 0u);
}

TEST_F(Verify, AnotherFieldFails) {
  VerifyOptions options;
  options.full = true;
  const Blobs other{{{0, 0, 0}, {3.1, 0, 0}}, 1.0, 0.3};
  EXPECT_FALSE(verify(other, topology_, options).passed());
}

TEST_F(Verify, LiesAboutCellsAreFound) {
  for (const Content truth : {Content::kEmpty, Content::kConnected, Content::kFull}) {
    for (const Content lie : {Content::kEmpty, Content::kConnected, Content::kFull}) {
      if (truth == lie || (truth == Content::kFull && lie == Content::kConnected)) continue;
      Topology t = topology_;
      OctreeNode& node = t.nodes[leaf(truth)];
      node.content = static_cast<std::uint8_t>(lie);
      if (lie == Content::kEmpty) node.component = kNoComponent;
      EXPECT_FALSE(passes(t)) << static_cast<int>(truth) << static_cast<int>(lie);
    }
  }
}

TEST_F(Verify, LiesAboutFacesAreFound) {
  int lies = 0;
  const OctreeNode& node = topology_.nodes[leaf(Content::kConnected)];
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (const Content lie : {Content::kEmpty, Content::kConnected, Content::kFull}) {
        const Content truth = node.face_content(axis, side);
        if (truth == lie || truth == Content::kUndecided ||
            (truth == Content::kFull && lie == Content::kConnected))
          continue;
        Topology t = topology_;
        t.nodes[leaf(Content::kConnected)].set_face_content(axis, side, lie);
        EXPECT_FALSE(passes(t));
        ++lies;
      }
  EXPECT_GE(lies, 6);
}

TEST_F(Verify, LiesAboutComponentsAreFoundWhateverIsDrawn) {
  const auto spoil = [&](auto&& change) {
    Topology t = topology_;
    change(t);
    return passes(t, false);
  };
  EXPECT_TRUE(spoil([](Topology&) {}));
  EXPECT_FALSE(spoil([&](Topology& t) { t.nodes[leaf(Content::kConnected, 0)].component = 1; }));
  EXPECT_FALSE(spoil([&](Topology& t) { t.nodes[leaf(Content::kFull)].component = kNoComponent; }));
  EXPECT_FALSE(spoil([&](Topology& t) { t.nodes[leaf(Content::kEmpty)].component = 0; }));
  // Two components called one, and one called two.
  EXPECT_FALSE(spoil([](Topology& t) {
    for (OctreeNode& n : t.nodes)
      if (n.component == 1) n.component = 0;
  }));
  EXPECT_FALSE(spoil([](Topology& t) { t.components.push_back(t.components[1]); }));
  EXPECT_FALSE(spoil([](Topology& t) { t.components.pop_back(); }));
  EXPECT_FALSE(spoil([](Topology& t) { t.components[0].volume_lo *= 1.001; }));
  EXPECT_FALSE(spoil([](Topology& t) { ++t.components[1].cells; }));
  EXPECT_FALSE(spoil([](Topology& t) { t.components[0].bounds.max.x += 0.5; }));
  EXPECT_FALSE(spoil([](Topology& t) { t.certified = false; }));
  EXPECT_FALSE(spoil([](Topology& t) { t.components_lo = 1; }));
  EXPECT_FALSE(spoil([](Topology& t) { t.unresolved_cells = 1; }));
  EXPECT_FALSE(spoil([](Topology& t) { ++t.leaves; }));
  EXPECT_FALSE(spoil([](Topology& t) { t.touches_box = Imath::V3d(0.0); }));
}

TEST_F(Verify, LiesAboutWhatIsUndecidedAreFound) {
  CertifyOptions options;
  options.box = Box(Imath::V3d(-2.0), Imath::V3d(5.0, 2.0, 2.0));
  options.max_depth = 4;
  topology_ = certify(field_, options);
  ASSERT_FALSE(topology_.certified);
  ASSERT_FALSE(topology_.unresolved.empty());
  const auto spoil = [&](auto&& change) {
    Topology t = topology_;
    change(t);
    return passes(t, false);
  };
  EXPECT_TRUE(spoil([](Topology&) {}));
  EXPECT_FALSE(spoil([](Topology& t) { t.certified = true; }));
  EXPECT_FALSE(spoil([](Topology& t) { ++t.components_lo; }));
  EXPECT_FALSE(spoil([](Topology& t) {
    t.components_hi = t.components_hi ? std::nullopt : std::optional(t.components_lo + 9);
  }));
  EXPECT_FALSE(spoil([](Topology& t) { t.components[0].volume_hi *= 0.9; }));
  EXPECT_FALSE(spoil([](Topology& t) { t.unresolved.clear(); }));
  EXPECT_FALSE(spoil([](Topology& t) { t.unresolved[0].box.max.x += 0.1; }));
}

}  // namespace
}  // namespace morsel::topology
