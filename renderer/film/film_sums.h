// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "renderer/film/film.h"
#include "renderer/film/pixel_accumulator.h"

namespace morsel::render {

// Which part of every pixel's samples a render takes: a share of the sequence without gaps, so that
// each part is well distributed by itself.
struct Shard {
  std::uint32_t index = 0, count = 1;

  struct Range {
    std::uint32_t begin = 0, end = 0;
    std::uint32_t size() const { return end - begin; }
  };
  // Of a sequence of `samples`.
  Range range(std::uint32_t samples) const {
    const auto at = [&](std::uint64_t i) {
      return static_cast<std::uint32_t>(samples * i / count);
    };
    return {at(index), at(index + 1)};
  }
};

// What a film's shape follows from. Two sums of one layout can be added.
struct FilmLayout {
  int full_width = 0, full_height = 0;
  Crop window;
  std::uint32_t halves = 1;  // adaptive sampling keeps two halves of each pixel apart
  std::uint32_t groups = 0;  // light groups
  bool mattes = false;

  FilmLayout() = default;
  // Throws std::invalid_argument when the crop is empty or not inside the full image.
  FilmLayout(const RenderSettings& settings, std::size_t light_groups);
  bool operator==(const FilmLayout&) const = default;
};

// The samples of a tile of pixels so far. Arrays are [half][pixel], pixels row by row.
struct TileSums {
  Crop window;
  std::vector<PixelAccumulator> pixels;
  // Adaptive sampling: how many samples each half gets in all, over all shards; 0: not yet known.
  std::vector<std::uint32_t> needed;
  std::vector<ColorSum> groups;                  // [group][half][pixel]
  std::vector<cryptomatte::Accumulator> mattes;  // [matte][pixel]
  SampleCounts counts;

  TileSums(const FilmLayout& layout, const Crop& window);
  std::size_t pixel_count() const {
    return static_cast<std::size_t>(window.x1 - window.x0) *
           static_cast<std::size_t>(window.y1 - window.y0);
  }
  // `x`, `y` in pixels of the full image.
  std::size_t offset(int x, int y) const {
    return static_cast<std::size_t>(y - window.y0) *
               static_cast<std::size_t>(window.x1 - window.x0) +
           static_cast<std::size_t>(x - window.x0);
  }
  void add(const TileSums& other);  // of the same window and layout, other samples
  // For what comes from a file: throws std::runtime_error when up to `most` samples a pixel cannot
  // have added up to this. Nothing overflows then when more are added.
  void require_possible(std::uint32_t most) const;
};

// What has been sampled of an image, from which the rest of the sampling follows: whoever goes on
// with it, now or after reading it back from a file, ends at the same pixels. Tiles are locked one
// by one, so it can be looked at while it is rendered: each tile is then consistent in itself.
class FilmSums {
 public:
  static constexpr int kTileSize = 32;

  explicit FilmSums(const FilmLayout& layout, Shard shard = {});

  const FilmLayout& layout() const { return layout_; }
  Shard shard() const { return shard_; }
  int tile_rows() const { return rows_; }
  int tile_columns() const { return columns_; }
  int tile_count() const { return static_cast<int>(tiles_.size()); }

  // Calls use(TileSums&) with the tile locked.
  template <class Use>
  decltype(auto) with_tile(int i, Use&& use) {
    Tile& tile = *tiles_[static_cast<std::size_t>(i)];
    const std::lock_guard lock(tile.mutex);
    return use(tile.sums);
  }

  // The pixels as they stand.
  Film develop();
  // Of all tiles.
  SampleCounts counts();
  // Pixels (or halves of adaptive ones) of 16 samples or more of which one sample is more than
  // half, and the luminance of the brightest sample of all.
  struct Fireflies {
    std::uint64_t pixels = 0;
    float brightest = 0.0f;
  };
  Fireflies fireflies();

  // Adds samples of other shards. Throws std::invalid_argument when the layouts differ.
  void add(FilmSums& other);

 private:
  struct Tile {
    std::mutex mutex;
    TileSums sums;
    Tile(const FilmLayout& layout, const Crop& window) : sums(layout, window) {}
  };
  FilmLayout layout_;
  Shard shard_;
  int columns_ = 0, rows_ = 0;
  std::vector<std::unique_ptr<Tile>> tiles_;
};

}  // namespace morsel::render
