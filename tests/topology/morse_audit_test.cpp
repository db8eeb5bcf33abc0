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
TEST(Audit, SeesWrongAnswers) {
  const Blobs field({{0.01, 0.02, 0.03}, {1.01, 0.1, 0.0}, {4.0, 0.1, 0.2}}, 1.0, 0.3);
  const Topology t = certify_in(field, cube(6.0));
  MorseOptions options;
  options.box = t.box;
  const MorseComplex good = morse_complex(field, options);
  ASSERT_TRUE(audit(field, t, good).agreed());
  ASSERT_EQ(good.sets.size(), 2u);

  MorseComplex joined = good;  // one set for both pieces
  for (CriticalPoint& p : joined.points) p.set = 0;
  joined.sets.resize(1);
  EXPECT_FALSE(audit(field, t, joined).agreed());

  MorseComplex split = good;  // a third set
  split.sets.push_back({});
  for (CriticalPoint& p : split.points)
    if (p.set == good.main && p.type == CriticalType::kMaximum) {
      p.set = 2;
      break;
    }
  const Audit a = audit(field, t, split);
  ASSERT_FALSE(a.disagreements.empty());
  EXPECT_LT(a.disagreements[0].place.length(), 2.0);

  MorseComplex lost = good;  // a saddle that was not found
  lost.sets[lost.main].saddles2 = 0;
  EXPECT_FALSE(audit(field, t, lost).agreed());

  MorseComplex open = good;  // nothing is compared with what is known to be incomplete
  open.unresolved_boxes = 1;
  EXPECT_FALSE(audit(field, t, open).conclusive);
  EXPECT_FALSE(audit(field, t, open).agreed());
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
