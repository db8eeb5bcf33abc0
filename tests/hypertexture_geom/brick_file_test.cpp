// SPDX-License-Identifier: Apache-2.0
// Bricks that are kept from one run for the next: the same to the last bit, or made anew.
#include "hypertexture_geom/embree/brick_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <random>

#include "hypertexture_geom/embree/geometry.h"
#include "hypertexture_geom/field/tape_check.h"
#include "tests/hypertexture_geom/ball_geometry.h"
#include "tests/hypertexture_geom/test_fields.h"
#include "tests/temporary_folder.h"

namespace morsel::geom {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using topology::TopologyCache;

json fbm_of(const char* noise, double amplitude, double frequency, int layers) {
  json field = testing::eq13_json(layers, 1, amplitude, frequency);
  field["modulations"][0]["noise"] = noise;
  return field;
}

// A field, its topology and a folder for its bricks.
class KeptBricks {
 public:
  explicit KeptBricks(const json& field, int max_depth = 7) {
    // Given, as the search for it takes long.
    const json bounds{{"min", {-2.0, -2.0, -2.0}}, {"max", {2.0, 2.0, 2.0}}};
    const json geometry{{"name", "test"},
                        {"type", "hypertexture"},
                        {"field", field},
                        {"bounds", bounds},
                        {"max_depth", max_depth}};
    hypertexture_ = hypertexture_from_json(geometry, params::Place{"test", ""});
    cache = std::make_shared<TopologyCache>(build_cache(hypertexture_));
    options_.bricks.stem = folder_ / "bricks" / "rock";
    options_.bricks.warn = [this](const std::string& text) { warnings_.push_back(text); };
  }

  std::unique_ptr<HypertextureGeometry> geometry() {
    warnings_.clear();
    return std::make_unique<HypertextureGeometry>(hypertexture_.field, cache, options_);
  }
  std::vector<fs::path> files() const {
    std::vector<fs::path> all;
    if (fs::exists(folder_ / "bricks"))
      for (const auto& entry : fs::directory_iterator(folder_ / "bricks"))
        all.push_back(entry.path());
    return all;
  }
  fs::path file() const {
    EXPECT_EQ(files().size(), 1u);
    return files().at(0);
  }

  GeometryOptions& options() { return options_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const morsel::test::TemporaryFolder& folder() const { return folder_; }
  std::shared_ptr<TopologyCache> cache;

 private:
  morsel::test::TemporaryFolder folder_;
  Hypertexture hypertexture_;
  GeometryOptions options_;
  std::vector<std::string> warnings_;
};

// Everything that rays ask, to the last bit.
void expect_same(const HypertextureGeometry& a, const HypertextureGeometry& b) {
  const GeometryStatistics sa = a.statistics(), sb = b.statistics();
  ASSERT_EQ(sa.bricks, sb.bricks);
  EXPECT_EQ(sa.blocks, sb.blocks);
  EXPECT_EQ(a.bounds_padding(), b.bounds_padding());
  std::mt19937 random(7);
  const auto bricks = static_cast<std::uint32_t>(sa.bricks);
  int hits = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::uint32_t brick = std::uniform_int_distribution<std::uint32_t>(0, bricks - 1)(random);
    const topology::Box box = a.primitive_bounds(brick);
    ASSERT_EQ(box.min, b.primitive_bounds(brick).min);
    ASSERT_EQ(box.max, b.primitive_bounds(brick).max);
    ASSERT_EQ(a.component(brick), b.component(brick));
    const Imath::V3d d(test::random_direction(random));
    const Imath::V3d o = (box.min + box.max) * 0.5 - d;
    const auto ha = a.intersect_brick(brick, o, d, 0.0, 2.0);
    const auto hb = b.intersect_brick(brick, o, d, 0.0, 2.0);
    ASSERT_EQ(ha.has_value(), hb.has_value());
    if (!ha) continue;
    ++hits;
    ASSERT_EQ(ha->t, hb->t);
    ASSERT_EQ(ha->gradient, hb->gradient);
    ASSERT_EQ(ha->evaluations, hb->evaluations);
    const Imath::V3f p(o + d * ha->t);
    const ShadingPoint pa = a.shade(brick, p), pb = b.shade(brick, p);
    ASSERT_EQ(pa.position, pb.position);
    ASSERT_EQ(pa.normal, pb.normal);
  }
  EXPECT_GT(hits, 500);
}

TEST(BrickFileTest, BricksThatAreReadAreThoseThatWereMade) {
  json warped = testing::eq13_json(1, 1);
  warped["modulations"][0] = {{"type", "warp"}, {"amplitude", 0.1}, {"frequency", 2.0}};
  const json fields[] = {fbm_of("sparse_convolution", 0.8, 3.0, 2), fbm_of("perlin", 0.8, 3.0, 2),
                         warped};
  for (const json& field : fields) {
    KeptBricks kept(field);
    for (const Solver solver : {Solver::kModel, Solver::kSegment}) {
      kept.options().solver = solver;
      const auto made = kept.geometry();
      EXPECT_FALSE(made->statistics().bricks_were_read);
      const auto read = kept.geometry();
      EXPECT_TRUE(read->statistics().bricks_were_read) << field;
      expect_same(*made, *read);
      EXPECT_TRUE(kept.warnings().empty());
    }
    EXPECT_EQ(kept.files().size(), 2u);
  }
}

// Blocks with noise too fine to be listed ask the field, which the file does not hold.
TEST(BrickFileTest, BlocksThatReferToTheFieldAreCompiledAgain) {
  for (const char* noise : {"sparse_convolution", "perlin"}) {
    KeptBricks kept(fbm_of(noise, 1e-3, 60.0, 1), 5);
    const auto made = kept.geometry(), read = kept.geometry();
    EXPECT_TRUE(read->statistics().bricks_were_read);
    expect_same(*made, *read);
    // A record of each, but no impulses, which would be hundreds of thousands.
    const GeometryStatistics s = made->statistics();
    EXPECT_LT(fs::file_size(kept.file()), 128 * (s.bricks + s.blocks) + 4096);
  }
}

TEST(BrickFileTest, EachChoiceOfWhatIsKeptHasItsOwn) {
  KeptBricks kept(fbm_of("sparse_convolution", 0.8, 3.0, 1));
  const auto main = kept.geometry();
  kept.options().keep = topology::KeepRule::parse("all");
  const auto all = kept.geometry();
  EXPECT_FALSE(all->statistics().bricks_were_read);
  EXPECT_GT(all->statistics().bricks, main->statistics().bricks);
  EXPECT_TRUE(kept.geometry()->statistics().bricks_were_read);
  kept.options().keep = {};
  EXPECT_TRUE(kept.geometry()->statistics().bricks_were_read);
  EXPECT_EQ(kept.files().size(), 2u);
}

TEST(BrickFileTest, TheSameBricksMakeTheSameFile) {
  KeptBricks kept(fbm_of("sparse_convolution", 0.8, 3.0, 2), 6);
  kept.geometry();
  const std::string bytes = morsel::test::read_text(kept.file());
  fs::remove(kept.file());
  kept.geometry();
  EXPECT_TRUE(morsel::test::read_text(kept.file()) == bytes);
}

TEST(BrickFileTest, ThoseOfAnotherFieldAreReplacedWithoutAWord) {
  KeptBricks kept(fbm_of("sparse_convolution", 0.8, 3.0, 1));
  kept.geometry();
  const std::string before = morsel::test::read_text(kept.file());
  kept.cache->field_hash[0] ^= 1;
  EXPECT_FALSE(kept.geometry()->statistics().bricks_were_read);
  EXPECT_TRUE(kept.warnings().empty());
  EXPECT_NE(morsel::test::read_text(kept.file()), before);
  EXPECT_TRUE(kept.geometry()->statistics().bricks_were_read);
  // Another octree of the same field.
  kept.cache->field_hash[0] ^= 1;
  for (topology::OctreeNode& n : kept.cache->topology.nodes)
    if (n.is_leaf() && n.cell_content() == topology::Content::kConnected) {
      n.content = static_cast<std::uint8_t>(topology::Content::kUndecided);
      n.component = topology::kNoComponent;
      break;
    }
  EXPECT_FALSE(kept.geometry()->statistics().bricks_were_read);
}

TEST(BrickFileTest, WhatAKilledWriterLeftGoesWithTheNextReading) {
  KeptBricks kept(fbm_of("sparse_convolution", 0.8, 3.0, 1), 6);
  kept.geometry();
  const fs::path file = kept.file();
  // No process has a number as large as this one.
  std::string name = ".";
  name += file.stem().string();
  name += ".999999999.0.bricks";
  const fs::path left = file.parent_path() / name;
  std::ofstream(left) << "half of it";
  fs::last_write_time(left, fs::file_time_type::clock::now() - 2 * topology::kLeftoverAge);
  EXPECT_TRUE(kept.geometry()->statistics().bricks_were_read);
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(file));
}

TEST(BrickFileTest, NothingIsKeptThatWasNotAskedFor) {
  KeptBricks kept(fbm_of("sparse_convolution", 0.8, 3.0, 1));
  kept.options().bricks.max_bytes = 10'000;
  kept.geometry();
  EXPECT_TRUE(kept.files().empty());
  kept.options().bricks.max_bytes = 1u << 30;
  kept.options().bricks.may_write = false;
  kept.geometry();
  EXPECT_TRUE(kept.files().empty());
  kept.options().bricks.may_write = true;
  kept.options().solver = Solver::kSphere;
  kept.geometry();
  EXPECT_TRUE(kept.files().empty());
  // Whose bricks they are must be known.
  kept.options().solver = Solver::kModel;
  kept.cache->field_hash.clear();
  kept.geometry();
  EXPECT_TRUE(kept.files().empty());
}

// A file that is damaged anywhere is told, left as it is, and harms nothing.
TEST(BrickFileTest, DamageIsToldAndBricksAreMade) {
  KeptBricks kept(fbm_of("sparse_convolution", 0.8, 3.0, 1), 6);
  const auto made = kept.geometry();
  const fs::path file = kept.file();
  const std::string whole = morsel::test::read_text(file);
  const auto put = [&](const std::string& bytes) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
  };
  const auto expect_made = [&](const std::string& bytes) {
    put(bytes);
    const auto geometry = kept.geometry();
    ASSERT_FALSE(geometry->statistics().bricks_were_read);
    ASSERT_EQ(kept.warnings().size(), 1u);
    EXPECT_NE(kept.warnings()[0].find(file.string()), std::string::npos) << kept.warnings()[0];
    EXPECT_EQ(morsel::test::read_text(file), bytes);
  };
  std::mt19937 random(3);
  for (int i = 0; i < 12; ++i) {
    std::string damaged = whole;
    const auto at = std::uniform_int_distribution<std::size_t>(0, whole.size() - 1)(random);
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (i % 8)));
    expect_made(damaged);
  }
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{5}, std::size_t{100}, whole.size() / 2, whole.size() - 1})
    expect_made(whole.substr(0, size));
  expect_made("{ \"a\": \"scene\" }");
  put(whole);
  EXPECT_TRUE(kept.geometry()->statistics().bricks_were_read);
  fs::remove(file);
  fs::create_directory(file);
  kept.geometry();
  EXPECT_EQ(kept.warnings().size(), 1u);
  EXPECT_TRUE(fs::is_directory(file));
}

TEST(BrickFileTest, ThatTheyCannotBeWrittenIsToldAndNothingElse) {
  KeptBricks kept(fbm_of("sparse_convolution", 0.8, 3.0, 1), 6);
  std::ofstream(kept.folder() / "bricks") << "in the way of the folder";
  EXPECT_GT(kept.geometry()->statistics().bricks, 100u);
  ASSERT_EQ(kept.warnings().size(), 1u);
  EXPECT_NE(kept.warnings()[0].find("not kept"), std::string::npos) << kept.warnings()[0];
}

Tape<double> tape_of(const json& field) {
  const auto f = testing::field_of(field);
  const CompiledField<double> compiled(*f, {Imath::V3d(0.7, 0.1, 0.1), Imath::V3d(0.9, 0.3, 0.2)});
  EXPECT_FALSE(compiled.refers_to_field());
  return compiled.tape();
}

TEST(TapeCheckTest, CompiledFieldsHaveNoProblem) {
  json warped = testing::eq13_json(1, 1);
  warped["modulations"][0] = {{"type", "warp"}, {"amplitude", 0.1}, {"frequency", 2.0}};
  for (const json& field :
       {fbm_of("sparse_convolution", 0.8, 3.0, 3), fbm_of("perlin", 0.8, 6.0, 3), warped})
    EXPECT_EQ(problem_of(tape_of(field)), "");
}

TEST(TapeCheckTest, FindsEachProblem) {
  const Tape<double> good = tape_of(fbm_of("perlin", 0.8, 6.0, 1));
  const auto with = [&](const auto& change) {
    Tape<double> tape = good;
    change(tape);
    return problem_of(tape);
  };
  const auto perlin = static_cast<std::size_t>(
      std::find_if(good.instructions.begin(), good.instructions.end(),
                   [](const TapeInstruction& in) { return in.op == TapeOp::kPerlin; }) -
      good.instructions.begin());
  ASSERT_LT(perlin, good.instructions.size());
  EXPECT_NE(with([](auto& t) { t.opaque.push_back({}); }), "");
  EXPECT_NE(with([](auto& t) { t.constants.back() = std::nan(""); }), "");
  EXPECT_NE(with([](auto& t) { t.constants.clear(); }), "");
  EXPECT_NE(with([](auto& t) { t.words.pop_back(); }), "");
  EXPECT_NE(with([](auto& t) { t.instructions.clear(); }), "");
  EXPECT_NE(with([](auto& t) { t.registers = 1; }), "");
  EXPECT_NE(with([](auto& t) { t.registers = 0xffff; }), "");
  EXPECT_NE(with([](auto& t) { t.instructions[0].reserved = 1; }), "");
  EXPECT_NE(with([](auto& t) { t.instructions[0].reserved_too = 1; }), "");
  EXPECT_NE(with([](auto& t) { t.result = t.registers; }), "");
  for (const int op : {5, 7, 8, 15, 255})  // hashed, opaque, none
    if (op != static_cast<int>(TapeOp::kPerlin)) {
      EXPECT_NE(with([&](auto& t) { t.instructions[0].op = static_cast<TapeOp>(op); }), "") << op;
    }
  for (auto& in : good.instructions) {
    const auto i = static_cast<std::size_t>(&in - good.instructions.data());
    EXPECT_NE(with([&](auto& t) { t.instructions[i].out = 0xfffe; }), "");
    if (in.op != TapeOp::kAdd && in.op != TapeOp::kMultiply && in.op != TapeOp::kSmoothStep) {
      EXPECT_NE(with([&](auto& t) { t.instructions[i].constants = 0xffffffff; }), "");
    }
    if (in.op == TapeOp::kAdd) {
      EXPECT_NE(with([&](auto& t) { t.instructions[i].b = t.registers; }), "");
    }
  }
  const std::size_t table = good.instructions[perlin].words;
  for (const std::int32_t bad : {0, -1, 1 << 20, 0x7fffffff})
    EXPECT_NE(with([&](auto& t) { t.words[table] = bad; }), "") << bad;
  EXPECT_NE(with([&](auto& t) { t.words[table + 3] = 0x0c000000; }), "");
  EXPECT_NE(with([&](auto& t) { t.instructions[perlin].words = 0xffffffff; }), "");
  EXPECT_NE(with([&](auto& t) { t.instructions[perlin].point[1] = 0; }), "");
  TapeInstruction many;
  many.op = TapeOp::kImpulses;
  many.count = 0xffffffff;
  EXPECT_NE(with([&](auto& t) { t.instructions.push_back(many); }), "");
}

// What is let through is run, beyond the box as well; the sanitizers watch.
TEST(TapeCheckTest, WhatHasNoProblemCanBeRun) {
  std::mt19937 random(5);
  json warped = testing::eq13_json(1, 1);
  warped["modulations"][0] = {{"type", "warp"}, {"amplitude", 0.1}, {"frequency", 2.0}};
  int run = 0;
  for (const json& field :
       {warped, fbm_of("perlin", 0.8, 6.0, 2), fbm_of("sparse_convolution", 0.8, 3.0, 2)}) {
    const Tape<double> good = tape_of(field);
    for (int i = 0; i < 20000; ++i) {
      Tape<double> tape = good;
      const auto pick = [&](std::size_t n) {
        return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
      };
      TapeInstruction& in = tape.instructions[pick(tape.instructions.size())];
      unsigned char bytes[sizeof in];
      std::memcpy(bytes, &in, sizeof in);
      bytes[pick(sizeof in)] = static_cast<unsigned char>(random() % 40);
      std::memcpy(&in, bytes, sizeof in);
      if (!tape.words.empty() && i % 3 == 0)
        tape.words[pick(tape.words.size())] = static_cast<std::int32_t>(random() % 7);
      if (i % 5 == 0) tape.constants[pick(tape.constants.size())] = 1e300;
      if (!problem_of(tape).empty()) continue;
      ++run;
      const double x[3] = {0.1 * static_cast<double>(i % 7) - 0.3, 1e6, -0.05};
      const double* const at[3] = {&x[0], &x[1], &x[2]};
      double value, g[3];
      double* const gradient[3] = {&g[0], &g[1], &g[2]};
      run_tape<double>(tape, at, 1, &value, gradient);
      const double many[3][5] = {{0, 0.1, 1e9, -1e300, 0}, {0, 0.2, 0, 1, 5}, {0, -0.1, 3, 3, 3}};
      const double* const places[3] = {many[0], many[1], many[2]};
      double values[5];
      run_tape<double>(tape, places, 5, values, nullptr);
    }
  }
  EXPECT_GT(run, 1000);
}

}  // namespace
}  // namespace morsel::geom
