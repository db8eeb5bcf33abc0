// SPDX-License-Identifier: Apache-2.0
// The two engines against each other.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/topology/blobs.h"
#include "topology/bound_solid.h"
#include "topology/cache_file.h"
#include "topology/morse/audit.h"
#include "topology/morse/engine.h"
#include "topology/morse/morse_sections.h"
#include "topology/morse/octree_euler.h"
#include "topology/morse/streamline_labels.h"
#include "topology/verify.h"

namespace morsel::topology {
namespace {

using testing::Blobs;

Box cube(double half, const Imath::V3d& centre = Imath::V3d(0.0)) {
  return {centre - Imath::V3d(half), centre + Imath::V3d(half)};
}

Topology certify_in(const ScalarField& field, const Box& box) {
  CertifyOptions options;
  options.box = box;
  return certify(field, options);
}

TEST(OctreeEuler, BallsRingsAndBlocks) {
  const auto euler = [](const ScalarField& field, const Box& box) {
    const Topology t = certify_in(field, box);
    EXPECT_TRUE(t.certified);
    const OctreeEuler e = octree_euler(field, t);
    EXPECT_TRUE(e.undecided.empty());
    return e.of_component;
  };
  using Numbers = std::vector<std::int64_t>;
  const Imath::V3d shift(0.0123, -0.0456, 0.0789);
  EXPECT_EQ(euler(Blobs({shift}, 1.0, 0.3), cube(2.0)), (Numbers{1}));
  EXPECT_EQ(euler(Blobs({shift, shift + Imath::V3d(2.5, 0, 0)}, 1.0, 0.3), cube(4.0)),
            (Numbers{1, 1}));
  std::vector<Imath::V3d> ring;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 12.0;
    ring.push_back(shift + Imath::V3d(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.0));
  }
  EXPECT_EQ(euler(Blobs(ring, 1.0, 0.3), cube(4.0)), (Numbers{0}));
  // A block of 3^3 blobs: struts only (27 - 54), struts and walls (+ 36), all solid (- 8).
  std::vector<Imath::V3d> block;
  for (int i = 0; i < 27; ++i) block.push_back(shift + Imath::V3d(i % 3, i / 3 % 3, i / 9) * 1.1);
  const Box box = cube(2.4, Imath::V3d(1.1));
  EXPECT_EQ(euler(Blobs(block, 1.0, 0.3), box), (Numbers{-27}));
  EXPECT_EQ(euler(Blobs(block, 1.0, 0.1), box), (Numbers{9}));
  EXPECT_EQ(euler(Blobs(block, 1.0, 0.005), box), (Numbers{1}));
}

TEST(Audit, SmallRandomFieldsAgree) {
  std::size_t pieces = 0;
  for (int seed = 1; seed <= 6; ++seed) {
    const auto field = geom::testing::field_of(
        seed % 2 == 0 ? geom::testing::perlin_json(1, seed, 1.0, 1.5)
                      : geom::testing::eq13_json(seed == 5 ? 2 : 1, seed, 0.7, 1.0));
    CertifyOptions options;
    options.box = find_solid(*field, *field->solid_bounds());
    const Topology t = certify(*field, options);
    MorseOptions morse;
    morse.box = t.box;
    const MorseComplex c = morse_complex(*field, morse);
    EXPECT_TRUE(c.resolved()) << seed;
    const Audit a = audit(*field, t, c);
    EXPECT_TRUE(a.conclusive) << seed << (a.reasons.empty() ? "" : a.reasons[0]);
    EXPECT_TRUE(a.agreed()) << seed << ": "
                            << (a.disagreements.empty() ? "" : a.disagreements[0].what);
    EXPECT_EQ(c.sets.size(), t.components.size()) << seed;
    pieces += t.components.size();
  }
  EXPECT_GT(pieces, 12u);
}

// What an audit is for: each kind of wrong answer is seen and its place named.
class AuditSees : public ::testing::Test {
 protected:
  // A pair of blobs that is joined, and a single one.
  const Blobs field_{{{0.01, 0.02, 0.03}, {1.01, 0.1, 0.0}, {4.0, 0.1, 0.2}}, 1.0, 0.3};
  const Topology certified_ = certify_in(field_, cube(6.0));
  MorseComplex complex_ = complex_in(certified_.box);

  MorseComplex complex_in(const Box& box) const {
    MorseOptions options;
    options.box = box;
    return morse_complex(field_, options);
  }
  std::uint32_t index_of(CriticalType type) const {
    for (std::uint32_t i = 0; i < complex_.points.size(); ++i)
      if (complex_.points[i].type == type) return i;
    return 0xffffffffu;
  }
  Audit audit_of(const Topology& topology) const { return audit(field_, topology, complex_); }
  void expect_disagreement(const Audit& a, const std::string& what, const Imath::V3d& near,
                           double within = 1e-6) const {
    ASSERT_FALSE(a.disagreements.empty());
    EXPECT_EQ(a.verdict(), "disagreed");
    EXPECT_FALSE(a.agreed());
    bool found = false;
    for (const Audit::Disagreement& d : a.disagreements)
      found =
          found || (d.what.find(what) != std::string::npos && (d.place - near).length() < within);
    EXPECT_TRUE(found) << a.disagreements[0].what << " at " << a.disagreements[0].place;
  }
  // One set for both pieces, as if an ascent had gone astray.
  void join_all() {
    for (CriticalPoint& p : complex_.points) p.set = 0;
    complex_.sets.resize(1);
  }
  // As if the only 2-saddle joined nothing.
  void part_all() {
    complex_.sets.clear();
    for (CriticalPoint& p : complex_.points) {
      p.set = kNoSet;
      if (p.type != CriticalType::kMaximum) continue;
      p.set = static_cast<std::uint32_t>(complex_.sets.size());
      complex_.sets.push_back({});
    }
  }
};

TEST_F(AuditSees, NothingWrong) {
  const Audit a = audit_of(certified_);
  EXPECT_TRUE(a.agreed()) << (a.disagreements.empty() ? "" : a.disagreements[0].what);
  EXPECT_EQ(a.verdict(), "agreed");
  EXPECT_TRUE(a.euler_by_mesh);
  EXPECT_EQ(a.euler, (std::vector<std::int64_t>{1, 1}));
  EXPECT_EQ(complex_.sets.size(), 2u);
  EXPECT_FALSE(audit(field_, certified_, complex_, {}, {.mesh = false}).euler_by_mesh);
  EXPECT_FALSE(audit(field_, certified_, complex_, {}, {.mesh_leaves = 10}).euler_by_mesh);
}

TEST_F(AuditSees, JoinedMaximaInDifferentComponentsWhateverIsOpen) {
  join_all();
  expect_disagreement(audit_of(certified_), "certified to lie in component", {4.0, 0.1, 0.2});
  // Neither what the Morse engine left open nor a box that is cut explains a join.
  complex_.unresolved_boxes = 3;
  complex_.lost.push_back({index_of(CriticalType::kSaddle2), Imath::V3d(0.0), "stalled"});
  Topology cut = certified_;
  cut.touches_box = Imath::V3d(6.0, 0.0, 0.0);
  const Audit a = audit_of(cut);
  EXPECT_FALSE(a.conclusive);
  EXPECT_EQ(a.reasons.size(), 2u);
  expect_disagreement(a, "certified to lie in component", {4.0, 0.1, 0.2});
}

// Cells that were left undecided explain a join only where they lie between.
TEST_F(AuditSees, UndecidedCellsExplainOnlyWhatLiesBesideThem) {
  join_all();
  Topology open = certified_;
  open.certified = false;
  const auto forget_faces = [](OctreeNode& node) {
    for (int f = 0; f < 6; ++f) node.set_face_content(f / 2, f % 2, Content::kUndecided);
  };
  // All empty cells and all faces undecided: anything may be joined.
  for (OctreeNode& node : open.nodes) {
    if (!node.is_leaf()) continue;
    forget_faces(node);
    if (node.cell_content() == Content::kEmpty)
      node.content = static_cast<std::uint8_t>(Content::kUndecided);
  }
  const Audit all = audit_of(open);
  EXPECT_TRUE(all.disagreements.empty()) << all.disagreements[0].what;
  EXPECT_EQ(all.verdict(), "not compared");
  // One in a corner of the box only: nothing is explained.
  Topology corner = certified_;
  corner.certified = false;
  corner.unresolved_cells = 1;
  const std::uint32_t leaf = corner.octree().locate(corner.box.max).node;
  ASSERT_EQ(corner.nodes[leaf].cell_content(), Content::kEmpty);
  corner.nodes[leaf].content = static_cast<std::uint8_t>(Content::kUndecided);
  forget_faces(corner.nodes[leaf]);
  expect_disagreement(audit_of(corner), "certified to lie in component", {4.0, 0.1, 0.2});
}

TEST_F(AuditSees, AMaximumInAnEmptyCellWhateverIsOpen) {
  complex_.unresolved_boxes = 1;
  const std::uint32_t maximum = index_of(CriticalType::kMaximum);
  complex_.points[maximum].position = Imath::V3d(-3.0, 4.0, 4.0);
  const Audit a = audit_of(certified_);
  EXPECT_FALSE(a.conclusive);
  expect_disagreement(a, "certified to be empty", {-3.0, 4.0, 4.0});
}

TEST_F(AuditSees, ASaddleInAnotherComponentThanItsSet) {
  CriticalPoint& saddle = complex_.points[index_of(CriticalType::kSaddle2)];
  for (const CriticalPoint& p : complex_.points)
    if (p.set != saddle.set) {
      saddle.set = p.set;
      break;
    }
  expect_disagreement(audit_of(certified_), "a 2-saddle of set", saddle.position);
}

TEST_F(AuditSees, SetsThatOughtToBeJoined) {
  part_all();
  const Audit a = audit_of(certified_);
  expect_disagreement(a, "both have a maximum in component", {0.5, 0.05, 0.0}, 1.0);
  // A lost ascent of the 2-saddle between them explains it; one of another point does not.
  complex_.lost.push_back({index_of(CriticalType::kSaddle2), Imath::V3d(0.0), "stalled"});
  const Audit excused = audit_of(certified_);
  EXPECT_TRUE(excused.disagreements.empty()) << excused.disagreements[0].what;
  EXPECT_EQ(excused.verdict(), "not compared");
  complex_.lost.back().point = index_of(CriticalType::kMaximum);
  EXPECT_EQ(audit_of(certified_).verdict(), "disagreed");
  // So do boxes that may hold further saddles.
  complex_.unresolved_boxes = 1;
  EXPECT_EQ(audit_of(certified_).verdict(), "not compared");
}

TEST_F(AuditSees, AMaximumThatWasNotFound) {
  for (std::size_t i = 0; i < complex_.points.size(); ++i)
    if ((complex_.points[i].position - Imath::V3d(4.0, 0.1, 0.2)).length() < 0.1) {
      complex_.points.erase(complex_.points.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    }
  // A lost ascent is no excuse, since it takes away no maximum.
  complex_.lost.push_back({0, Imath::V3d(0.0), "stalled"});
  expect_disagreement(audit_of(certified_), "has no maximum", {4.0, 0.1, 0.2}, 1.0);
}

TEST_F(AuditSees, ASaddleThatWasNotFound) {
  const std::uint32_t saddle = index_of(CriticalType::kSaddle2);
  complex_.points.erase(complex_.points.begin() + saddle);
  expect_disagreement(audit_of(certified_), "Euler characteristic", {0.5, 0.05, 0.0}, 1.0);
  // Euler characteristics need no ascents: lost ones are no excuse.
  complex_.lost.push_back({0, Imath::V3d(0.0), "stalled"});
  expect_disagreement(audit_of(certified_), "Euler characteristic", {0.5, 0.05, 0.0}, 1.0);
}

TEST_F(AuditSees, NothingIsComparedWithWhatIsKnownToBeIncomplete) {
  complex_.unresolved_boxes = 1;
  const Audit a = audit_of(certified_);
  EXPECT_EQ(a.verdict(), "not compared");
  ASSERT_EQ(a.reasons.size(), 1u);
  EXPECT_NE(a.reasons[0].find("1 boxes undecided"), std::string::npos) << a.reasons[0];
  EXPECT_TRUE(a.euler.empty());
}

// Three balls of which the perturbation lifts or drowns some: the two engines see different fields,
// and the message names places and the perturbation.
TEST(Engine, DisagreementIsAnErrorThatNamesThePlaces) {
  const auto field = geom::testing::field_of(
      {{"density",
        {{"type", "metaballs"},
         {"balls",
          {{{"center", {-0.8, 0.0, 0.0}}, {"radius", 1.4}, {"weight", 1.0}},
           {{"center", {0.8, 0.0, 0.0}}, {"radius", 1.4}, {"weight", 1.0}},
           {{"center", {0.0, 2.6, 0.5}}, {"radius", 1.0}, {"weight", 0.7}}}},
         {"level", 0.6}}}});
  CertifyOptions options;
  options.box = find_solid(*field, *field->solid_bounds());
  EngineOptions engine = Engine::kBoth;
  Sections sections;
  EXPECT_EQ(run_engine(engine, *field, options, sections).engine, "both");
  engine.perturbation = 0.3;
  Sections none;
  try {
    run_engine(engine, *field, options, none);
    ADD_FAILURE() << "no disagreement";
  } catch (const EnginesDisagree& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("at ("), std::string::npos) << text;
    EXPECT_NE(text.find("a linear term of at most 0.3"), std::string::npos) << text;
  }
  EXPECT_TRUE(none.all().empty());
}

TEST(Engine, WhatCouldNotBeComparedIsNoAgreement) {
  const Blobs field({{0.01, 0.02, 0.03}, {1.01, 0.1, 0.0}, {4.0, 0.1, 0.2}}, 1.0, 0.3);
  CertifyOptions options;
  options.box = cube(4.0);  // cuts the last ball
  Sections sections;
  const Topology t = run_engine(Engine::kBoth, field, options, sections);
  EXPECT_EQ(t.engine, "certified");
  EXPECT_TRUE(t.certified);
  const nlohmann::json found = morse_meta(sections, "test")["audit"];
  EXPECT_EQ(found["verdict"], "not compared");
  EXPECT_EQ(found["agreed"], false);
  ASSERT_EQ(found["reasons"].size(), 1u);
  EXPECT_NE(found["reasons"][0].get<std::string>().find("cuts the solid near (4"),
            std::string::npos)
      << found;
  // Counts that may be wrong decide nothing: `main` goes by volume.
  for (const Component& c : t.components) EXPECT_EQ(c.maxima, 0u);
}

TEST(Engine, MorseAloneGivesTheSameLabels) {
  const auto field = geom::testing::field_of(geom::testing::eq13_json(1, 2, 0.8, 1.2));
  CertifyOptions options;
  options.box = find_solid(*field, *field->solid_bounds());
  Sections sections;
  const Topology certified = run_engine(Engine::kCertified, *field, options, sections);
  EXPECT_TRUE(sections.all().empty());
  const Topology morse = run_engine(Engine::kMorse, *field, options, sections);
  EXPECT_FALSE(morse.certified);
  EXPECT_EQ(morse.engine, "morse");
  EXPECT_EQ(morse.unresolved_cells, 0u);
  ASSERT_EQ(morse.components.size(), certified.components.size());
  EXPECT_GT(morse.components.size(), 2u);
  ASSERT_EQ(morse.nodes.size(), certified.nodes.size());
  for (std::size_t i = 0; i < morse.nodes.size(); ++i)
    EXPECT_EQ(morse.nodes[i].component, certified.nodes[i].component);
  // The labels are not certified, and verification of the octree has nothing against that.
  const VerifyReport report = verify(*field, morse, {});
  EXPECT_TRUE(report.passed()) << (report.failures.empty() ? "" : report.failures[0]);
  ASSERT_TRUE(morse.components_hi.has_value());
  EXPECT_LE(morse.components_lo, certified.components.size());
  EXPECT_GE(*morse.components_hi, certified.components.size());
}

// Writes and reads back what an engine made, and proves the octree again.
void expect_readable(const ScalarField& field, const Topology& topology, Sections sections) {
  TopologyCache cache;
  cache.topology = topology;
  cache.sections = std::move(sections);
  cache.field_hash = std::string(32, '0');
  const auto path = std::filesystem::path(::testing::TempDir()) / "morse_readable.topo";
  write_cache(cache, path);
  const TopologyCache back = read_cache(path);
  std::filesystem::remove(path);
  const auto labels_of = [](const Topology& t) {  // nodes may lie in another order
    std::vector<std::uint32_t> labels;
    t.octree().for_each_leaf(
        [&](const OctreeView::Leaf& leaf) { labels.push_back(t.nodes[leaf.node].component); });
    return labels;
  };
  ASSERT_EQ(labels_of(back.topology), labels_of(topology));
  const VerifyReport report = verify(field, back.topology, {});
  EXPECT_TRUE(report.passed()) << (report.failures.empty() ? "" : report.failures[0]);
}

// Maxima and basins are the perturbed field's, so ascents must be too.
TEST(Engine, MorseAloneLabelsWithAPerturbation) {
  const auto field = geom::testing::field_of(
      {{"density",
        {{"type", "capsule"}, {"start", {-1, 0, 0}}, {"end", {1, 0, 0}}, {"radius", 0.5}}}});
  CertifyOptions options;
  options.box = find_solid(*field, *field->solid_bounds());
  EngineOptions engine = Engine::kMorse;
  engine.perturbation = 0.3;
  Sections sections;
  const Topology t = run_engine(engine, *field, options, sections);
  ASSERT_EQ(t.components.size(), 1u);
  EXPECT_GT(t.components[0].cells, 100u);
  EXPECT_EQ(t.unresolved_cells, 0u);
  expect_readable(*field, t, sections);
}

TEST(Engine, CellsWhoseAscentsAreLostAreUndecided) {
  const Blobs field({{0.01, 0.02, 0.03}, {1.01, 0.1, 0.0}, {4.0, 0.1, 0.2}}, 1.0, 0.3);
  const Topology certified = certify_in(field, cube(6.0));
  MorseOptions options;
  options.box = certified.box;
  MorseComplex complex = morse_complex(field, options);
  // As if the ascents to the second maximum of the pair led nowhere.
  for (CriticalPoint& p : complex.points)
    if (p.type == CriticalType::kMaximum && (p.position - Imath::V3d(1.0, 0.1, 0.0)).length() < 0.3)
      p.set = kNoSet;
  Topology t = certified;
  label_by_streamlines(field, complex, t);
  t.engine = to_string(Engine::kMorse);
  EXPECT_GT(t.unresolved_cells, 0u);
  EXPECT_GT(t.components[0].cells, 0u);
  std::uint64_t undecided = 0;
  for (std::size_t i = 0; i < t.nodes.size(); ++i) {
    if (!t.nodes[i].is_leaf()) continue;
    undecided += t.nodes[i].cell_content() == Content::kUndecided;
    // For rendering every cell has the component that it has by certified labels as well.
    EXPECT_EQ(t.nodes[i].component == kNoComponent, certified.nodes[i].component == kNoComponent);
  }
  EXPECT_EQ(undecided, t.unresolved_cells);
  expect_readable(field, t, {});
}

TEST(MorseSections, RoundTripAndHostileRecords) {
  const Blobs field({{0.01, 0.02, 0.03}, {1.01, 0.1, 0.0}, {4.0, 0.1, 0.2}}, 1.0, 0.3);
  CertifyOptions options;
  options.box = cube(6.0);
  TopologyCache cache;
  cache.topology = run_engine(Engine::kBoth, field, options, cache.sections);
  cache.field_hash = std::string(32, '0');
  const auto path = std::filesystem::path(::testing::TempDir()) / "morse_sections.topo";
  write_cache(cache, path);
  const TopologyCache back = read_cache(path);
  std::filesystem::remove(path);
  const auto complex = get_morse(back.sections, back.topology.components.size(), "test");
  ASSERT_TRUE(complex.has_value());
  EXPECT_EQ(complex->count(CriticalType::kMaximum), 3u);
  EXPECT_EQ(complex->count(CriticalType::kSaddle2), 1u);
  ASSERT_EQ(complex->separatrices.size(), 2u);
  for (const Separatrix& s : complex->separatrices) {
    ASSERT_GT(s.path.size(), 2u);
    EXPECT_LT((s.path.front() - complex->points[s.saddle].position).length(), 1e-6);
    EXPECT_LT((s.path.back() - complex->points[s.maximum].position).length(), 1e-6);
  }
  EXPECT_EQ(back.topology.components[complex->main].maxima, 2u);
  const nlohmann::json info = describe(back, KeepRule{});
  EXPECT_EQ(info["critical_points"]["maxima"], 3);
  EXPECT_EQ(info["critical_points"]["saddles2"], 1);
  EXPECT_EQ(info["morse"]["audit"]["agreed"], true);

  // A point of a component that is not there; a separatrix that starts at no 2-saddle.
  for (const char* name : {"morse.points", "morse.separatrices"}) {
    Sections bad = back.sections;
    Section section = *bad.find(name);
    for (std::size_t i = 0; i < section.bytes.size(); ++i) {
      Section changed = section;
      changed.bytes[i] ^= std::byte{0x5a};
      bad.put(changed);
      try {  // any outcome but a crash or a record out of range
        const auto c = get_morse(bad, back.topology.components.size(), "test");
        for (const CriticalPoint& p : c->points)
          EXPECT_TRUE(p.set == kNoSet || p.set < back.topology.components.size());
        for (const Separatrix& s : c->separatrices) EXPECT_LT(s.saddle, c->points.size());
      } catch (const CacheError& e) {
        EXPECT_NE(std::string(e.what()).find(name), std::string::npos);
      }
    }
    section.bytes.pop_back();
    section.element_bytes = 1;
    bad.put(section);
    EXPECT_THROW(get_morse(bad, back.topology.components.size(), "test"), CacheError);
  }
}

}  // namespace
}  // namespace morsel::topology
