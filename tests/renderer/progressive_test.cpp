// SPDX-License-Identifier: Apache-2.0
// Renders in parts: stopped and gone on with, read back from files, split into shards. Each has to
// end at the very bits of a render in one go.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <random>

#include "renderer/film/checkpoint.h"
#include "renderer/film/film_sums.h"
#include "renderer/image/exr.h"
#include "renderer/image/merge_shards.h"
#include "renderer/image/shard_layers.h"
#include "renderer/integrator/pass_schedule.h"
#include "renderer/integrator/render.h"
#include "tests/renderer/test_scenes.h"
#include "tests/temporary_folder.h"

namespace morsel::render {
namespace {

using namespace testing;
using morsel::test::TemporaryFolder;

// A ball on a floor under a sky and a lamp, each light in its group; with mattes.
Scene small_scene(bool adaptive) {
  Scene scene;
  add_material(scene, MaterialType::kDiffuse, V3f(0.6f));
  add_material(scene, MaterialType::kConductor, V3f(0.8f), 0.4f);
  add_mesh(scene, plane_mesh(20.0f), 0);
  add_mesh(scene, sphere_mesh(3), 1, translated(0, 1, 0));
  add_constant_environment(scene, 0.4f);
  add_rectangle(scene, V3f(-1, 4, -1), V3f(2, 0, 0), V3f(0, 0, 2), 6.0f);
  scene.light_groups = {"sky", "lamp"};
  scene.environment->group = 0;
  scene.rectangles[0].group = 1;
  scene.camera.position = V3f(0, 2, 6);
  scene.camera.look_at = V3f(0, 1, 0);
  set_image(scene, 70, 45, 23, 4);
  scene.settings.cryptomatte = true;
  scene.settings.filter = PixelFilter::kGaussian;
  scene.settings.filter_radius = 1.5f;
  if (adaptive) {
    scene.settings.spp = 48;
    scene.settings.min_spp = 8;
    scene.settings.noise_target = 0.15f;
  }
  return scene;
}

FilmSums sums_of(const Scene& scene, Shard shard = {}) {
  return FilmSums(FilmLayout(scene.settings, scene.light_groups.size()), shard);
}

void expect_same(const Film& a, const Film& b) {
  for (int y = a.window().y0; y < a.window().y1; ++y)
    for (int x = a.window().x0; x < a.window().x1; ++x) {
      const auto all = [&](const Film& f) {
        const Pixel& p = f.at(x, y);
        return std::tuple(p.color, p.alpha, p.albedo, p.normal, p.variance, p.depth, p.component,
                          p.position, p.geometric_normal, p.steps, p.samples, f.group(0, x, y),
                          f.group(1, x, y));
      };
      ASSERT_EQ(all(a), all(b)) << x << ", " << y;
      for (std::size_t m = 0; m < a.matte_count(); ++m)
        for (std::size_t r = 0; r < cryptomatte::kRanks; ++r) {
          ASSERT_EQ(a.matte(m, x, y)[r].id, b.matte(m, x, y)[r].id) << x << ", " << y;
          ASSERT_EQ(a.matte(m, x, y)[r].coverage, b.matte(m, x, y)[r].coverage);
        }
    }
  EXPECT_EQ(a.seen_components(), b.seen_components());
}

class Progressive : public ::testing::TestWithParam<bool> {
 protected:
  const Scene scene_ = small_scene(GetParam());
  const RenderResult whole_ = render(scene_);
};
INSTANTIATE_TEST_SUITE_P(Sampling, Progressive, ::testing::Bool(),
                         [](const auto& p) { return p.param ? "Adaptive" : "Fixed"; });

// Cancelled after more and more tiles (those that need nothing any more count too), then gone on
// with, until it is done.
TEST_P(Progressive, StoppedRendersGoOnToTheSamePixels) {
  FilmSums sums = sums_of(scene_);
  int stops = 0;
  for (RenderEnd end = RenderEnd::kCancelled; end != RenderEnd::kDone;) {
    std::atomic<bool> cancel{false};
    RenderOptions options;
    options.threads = 1 + stops % 3;
    options.cancel = &cancel;
    int tiles = 5 * (stops + 1);
    options.progress = [&](double) {
      if (--tiles == 0) cancel = true;
    };
    end = render_into(sums, scene_, options).end;
    ASSERT_LT(++stops, 100);
  }
  EXPECT_GT(stops, 2);
  expect_same(sums.develop(), whole_.film);
  EXPECT_EQ(sums.counts().samples, whole_.statistics.samples);
  EXPECT_EQ(sums.counts().rays.total(), whole_.statistics.rays.total());
}

TEST_P(Progressive, CheckpointsGoOnToTheSamePixels) {
  const TemporaryFolder folder;
  const nlohmann::json identity = {{"scene", "a"}};
  FilmSums first = sums_of(scene_);
  std::atomic<bool> cancel{false};
  RenderOptions options;
  options.cancel = &cancel;
  options.progress = [&](double f) { cancel = f > 0.4; };
  EXPECT_EQ(render_into(first, scene_, options).end, RenderEnd::kCancelled);
  write_checkpoint(folder / "a.checkpoint", first, {identity, 2.5});

  FilmSums second = sums_of(scene_);
  EXPECT_EQ(read_checkpoint(folder / "a.checkpoint", identity, second).seconds, 2.5);
  expect_same(first.develop(), second.develop());
  const RenderRun run = render_into(second, scene_);
  EXPECT_EQ(run.end, RenderEnd::kDone);
  EXPECT_EQ(run.statistics.earlier_samples, first.counts().samples);
  expect_same(second.develop(), whole_.film);
}

// Written while rendering goes on, again and again; every file is good.
TEST_P(Progressive, CheckpointsOfARunningRenderAreGood) {
  const TemporaryFolder folder;
  FilmSums sums = sums_of(scene_);
  int files = 0;
  RenderOptions options;
  options.threads = 3;
  options.progress = [&](double) {
    if (files < 6) write_checkpoint(folder / std::to_string(files++), sums, {nullptr, 0.0});
  };
  render_into(sums, scene_, options);
  ASSERT_EQ(files, 6);
  for (int i = 1; i < files; i += 2) {
    FilmSums from = sums_of(scene_);
    read_checkpoint(folder / std::to_string(i), nullptr, from);
    EXPECT_LT(from.counts().samples, whole_.statistics.samples);
    render_into(from, scene_);
    expect_same(from.develop(), whole_.film);
  }
}

TEST_P(Progressive, ShardsAddUpToTheSamePixels) {
  const TemporaryFolder folder;
  for (const std::uint32_t count : {2u, 5u}) {
    std::vector<std::filesystem::path> files;
    for (std::uint32_t i = 0; i < count; ++i) {
      FilmSums sums = sums_of(scene_, {i, count});
      const RenderRun run = render_into(sums, scene_);
      const RenderResult result{sums.develop(), run.statistics, run.end};
      files.push_back(folder / (std::to_string(i) + ".exr"));
      write_shard(files.back(), scene_, result, sums, "hash");
    }
    std::swap(files.front(), files.back());  // their order does not matter
    const MergedShards merged = merge_shards(files, folder / "whole.exr");
    EXPECT_TRUE(merged.missing.empty());
    EXPECT_TRUE(merged.unfinished.empty());
    expect_same(merged.film, whole_.film);
  }
}

// Every sample of the sequence is in one shard.
TEST(Shard, RangesPartitionTheSequence) {
  for (const std::uint32_t samples : {1u, 7u, 64u, 1u << 20})
    for (const std::uint32_t count : {1u, 2u, 3u, 7u, 64u}) {
      std::uint32_t next = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        const Shard::Range r = Shard{i, count}.range(samples);
        EXPECT_EQ(r.begin, next);
        next = r.end;
      }
      EXPECT_EQ(next, samples);
    }
}

TEST(PassSchedule, GrowsToTheEnd) {
  EXPECT_EQ(pass_schedule(1, 1), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(pass_schedule(1, 50), (std::vector<std::uint32_t>{1, 2, 4, 8, 16, 32, 48, 50}));
  EXPECT_EQ(pass_schedule(8, 5), (std::vector<std::uint32_t>{5}));
  const auto long_one = pass_schedule(1, 1 << 20);
  for (std::size_t i = 1; i < long_one.size(); ++i) {
    EXPECT_GT(long_one[i], long_one[i - 1]);
    EXPECT_LE(long_one[i] - long_one[i - 1], 64u);
  }
}

// Sums do not depend on the order of the samples, nor on how they are grouped.
TEST(PixelAccumulator, IsIndependentOfOrder) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  struct Sample {
    PathSample sample;
    float x, y;
  };
  std::vector<Sample> samples(200);
  for (Sample& s : samples) {
    s.sample.radiance = V3f(std::exp(20.0f * u(random) - 10.0f), u(random), 1e-6f * u(random));
    s.sample.albedo = V3f(u(random), u(random), u(random));
    s.sample.alpha = u(random) < 0.5f ? 0.0f : 1.0f;
    s.sample.depth = u(random);
    s.x = std::round(4.0f * u(random)) / 4.0f;  // so that some are equally near
    s.y = std::round(4.0f * u(random)) / 4.0f;
  }
  std::vector<std::uint32_t> order(samples.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto bytes_of = [&](std::size_t parts) {
    std::vector<PixelAccumulator> accumulators(parts);
    for (std::size_t k = 0; k < order.size(); ++k) {
      const Sample& s = samples[order[k]];
      accumulators[k % parts].add(s.sample, s.x, s.y, order[k]);
    }
    PixelAccumulator all;
    for (const PixelAccumulator& a : accumulators) all.add(a);
    std::vector<char> bytes(sizeof all);
    std::memcpy(bytes.data(), &all, sizeof all);
    return bytes;
  };
  const std::vector<char> expected = bytes_of(1);
  for (const std::size_t parts : {1u, 2u, 7u}) {
    std::shuffle(order.begin(), order.end(), random);
    EXPECT_EQ(bytes_of(parts), expected) << parts;
  }
}

// The brightest floats neither overflow nor spoil what the others add.
TEST(PixelAccumulator, HugeSamplesSaturate) {
  PixelAccumulator pixel;
  PathSample s;
  s.radiance = V3f(std::numeric_limits<float>::max(), 1.0f, 0.0f);
  for (std::uint32_t i = 0; i < 1000; ++i) pixel.add(s, 0.5f, 0.5f, i);
  const Pixel p = pixel.result();
  EXPECT_EQ(p.color, V3f(0x1p40f, 1.0f, 0.0f));
  EXPECT_EQ(p.variance.x, std::numeric_limits<float>::max());
  EXPECT_EQ(p.variance.y, 0.0f);
}

class CheckpointFile : public ::testing::Test {
 protected:
  CheckpointFile() {
    set_image(scene_, 40, 33, 1);
    sums_ = std::make_unique<FilmSums>(FilmLayout(scene_.settings, 0));
    write_checkpoint(file_, *sums_, {identity_, 1.0});
  }
  std::string error(const std::filesystem::path& file, const nlohmann::json& identity) {
    FilmSums sums(FilmLayout(scene_.settings, 0));
    try {
      read_checkpoint(file, identity, sums);
    } catch (const CheckpointError& e) {
      return e.what();
    }
    return "";
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "a.checkpoint";
  const nlohmann::json identity_ = {{"scene", {{"render", {{"max_depth", 8}}}}}};
  Scene scene_;
  std::unique_ptr<FilmSums> sums_;
};

TEST_F(CheckpointFile, SaysWhatHasChanged) {
  EXPECT_EQ(error(file_, identity_), "");
  nlohmann::json other = identity_;
  other["scene"]["render"]["max_depth"] = 4;
  EXPECT_NE(error(file_, other).find("/scene/render/max_depth was 8, is 4"), std::string::npos)
      << error(file_, other);
  scene_.settings.crop = Crop{0, 0, 10, 10};
  EXPECT_NE(error(file_, identity_).find("/crop"), std::string::npos) << error(file_, identity_);
}

TEST_F(CheckpointFile, DamageIsFound) {
  const std::string good = morsel::test::read_text(file_);
  const std::filesystem::path bad = folder_ / "bad.checkpoint";
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    std::string text = good;
    if (i % 2 == 0) {
      text.resize(std::uniform_int_distribution<std::size_t>(0, good.size() - 1)(random));
    } else {
      const auto at = std::uniform_int_distribution<std::size_t>(0, good.size() - 1)(random);
      text[at] = static_cast<char>(text[at] ^ (1 << (i / 2 % 8)));
    }
    std::ofstream(bad, std::ios::binary | std::ios::trunc) << text;
    EXPECT_NE(error(bad, identity_).find(bad.string()), std::string::npos) << i;
  }
  EXPECT_NE(error(folder_ / "gone", identity_).find("cannot open"), std::string::npos);
  std::ofstream(bad, std::ios::binary | std::ios::trunc) << std::string(1000, 'x');
  EXPECT_NE(error(bad, identity_).find("not a checkpoint of a render"), std::string::npos);
}

// Sums with right checksums that overflow when another sample is added.
void forge(FilmSums& sums) {
  sums.with_tile(0, [](TileSums& tile) {
    std::memset(static_cast<void*>(tile.pixels.data()), 0x7f, sizeof tile.pixels[0]);
  });
}

TEST_F(CheckpointFile, SumsThatNoSamplesHaveAreRefused) {
  forge(*sums_);
  write_checkpoint(file_, *sums_, {identity_, 1.0});
  EXPECT_NE(error(file_, identity_).find("a pixel has sums that no 2139062143 samples have"),
            std::string::npos)
      << error(file_, identity_);
}

TEST(MergeShards, RefusesWhatDoesNotBelongTogether) {
  const TemporaryFolder folder;
  Scene scene;
  set_image(scene, 8, 8, 4);
  const auto shard = [&](const char* name, std::uint32_t i, std::uint32_t n, const char* hash,
                         const Scene& s) {
    FilmSums sums(FilmLayout(s.settings, 0), {i, n});
    const RenderRun run = render_into(sums, s);
    const std::filesystem::path file = folder / name;
    write_shard(file, s, {sums.develop(), run.statistics, run.end}, sums, hash);
    return file;
  };
  const auto a = shard("a.exr", 0, 2, "h", scene), b = shard("b.exr", 1, 2, "h", scene);
  const auto twice = shard("twice.exr", 0, 2, "h", scene);
  const auto changed = shard("changed.exr", 1, 2, "other", scene);
  const auto thirds = shard("thirds.exr", 1, 3, "h", scene);
  Scene more = scene;
  more.settings.spp = 8;
  const auto longer = shard("longer.exr", 1, 2, "h", more);
  const std::filesystem::path forged = folder / "forged.exr";
  FilmSums impossible(FilmLayout(scene.settings, 0), {1, 2});
  forge(impossible);
  write_shard(forged, scene, {Film(scene.settings), {}, {}}, impossible, "h");
  const std::filesystem::path plain = folder / "plain.exr";
  write_exr(plain, scene, render(scene));

  const auto error = [&](const std::filesystem::path& second) -> std::string {
    try {
      merge_shards({a, second}, folder / "out.exr");
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(error(b), "");
  std::filesystem::remove(folder / "out.exr");
  for (const auto& [file, words] : std::vector<std::pair<std::filesystem::path, std::string>>{
           {a, "is shard 0 of 2, as "},
           {twice, "is shard 0 of 2, as "},
           {changed, "is of another scene"},
           {thirds, "one of 3 shards"},
           {longer, "for 8 samples a pixel"},
           {forged, "has sums that no"},
           {plain, "not a shard"},
           {folder / "gone.exr", "cannot read"}}) {
    EXPECT_NE(error(file).find(words), std::string::npos) << error(file);
    EXPECT_NE(error(file).find(file.string()), std::string::npos) << error(file);
    EXPECT_FALSE(std::filesystem::exists(folder / "out.exr"));
  }
  const MergedShards half = merge_shards({b}, folder / "out.exr");
  EXPECT_EQ(half.missing, (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(half.film.at(0, 0).samples, 2u);
}

TEST(Render, TimeLimitStopsAfterTheFirstPass) {
  Scene scene = small_scene(false);
  scene.settings.spp = 1 << 20;
  RenderOptions options;
  options.time_limit = 0.05;
  const RenderResult result = render(scene, options);
  EXPECT_EQ(result.end, RenderEnd::kDeadline);
  for (int y = 0; y < 45; ++y)
    for (int x = 0; x < 70; ++x) EXPECT_GE(result.film.at(x, y).samples, 1u);
}

}  // namespace
}  // namespace morsel::render
