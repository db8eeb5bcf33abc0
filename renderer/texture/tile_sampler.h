// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagecache.h>

#include <array>
#include <bit>
#include <cstdint>

#include "renderer/math/vector.h"
#include "renderer/scene/texture.h"

namespace morsel::render {

// An image in OpenImageIO's cache, made by LinearImage: square tiles, levels down to one texel.
struct CachedImage {
  OIIO::ImageCache::ImageHandle* handle = nullptr;
  std::uint32_t number = 0;  // of the cache's images
  int width = 0, height = 0, levels = 0, channels = 0;
};

// Four texels of a level and their weights: what bilinear interpolation at a point asks for. The
// same for all images of one size that go on beyond their edges in the same way.
struct TexelPlace {
  int level = 0;
  int x[2] = {0, 0}, y[2] = {0, 0};            // below 0: black
  float weight[4] = {1.0f, 0.0f, 0.0f, 0.0f};  // of (x0, y0), (x1, y0), (x0, y1), (x1, y1)
};
// Of one point, chosen by `random` in [0, 1), of the footprint that TextureStore::lookup describes,
// but with v down.
TexelPlace texel_place(const CachedImage& image, Wrap wrap_u, Wrap wrap_v, V2f uv,
                       const V2f& across, const V2f& along, float random);

// Looks texels of images up, through a small table of the tiles that it met last: what
// OpenImageIO's own look-up spends on finding a tile and on its general case is most of the work
// here. Of one thread; holds on to its tiles.
class TileSampler {
 public:
  explicit TileSampler(OIIO::ImageCache& cache) : cache_(cache) {}
  ~TileSampler();
  TileSampler(const TileSampler&) = delete;
  TileSampler& operator=(const TileSampler&) = delete;

  // Writes up to four channels; false if a tile cannot be read.
  bool sample(const CachedImage& image, const TexelPlace& place, float texel[4]);

 private:
  static constexpr std::size_t kTiles = 128;
  struct Entry {
    std::uint64_t key = ~std::uint64_t{0};
    OIIO::ImageCache::Tile* tile = nullptr;
    const void* pixels = nullptr;
    bool half = false;
  };
  const Entry* find(const CachedImage& image, int level, unsigned tile_x, unsigned tile_y) {
    const std::uint64_t key = std::uint64_t{image.number} << 40 |
                              static_cast<std::uint64_t>(level) << 32 |
                              std::uint64_t{tile_y} << 16 | std::uint64_t{tile_x};
    Entry& e = entries_[(key * 0x9e3779b97f4a7c15u) >> (64 - std::bit_width(kTiles - 1))];
    return e.key == key || fetch(image, level, tile_x, tile_y, key, e) ? &e : nullptr;
  }
  bool fetch(const CachedImage& image, int level, unsigned tile_x, unsigned tile_y,
             std::uint64_t key, Entry& entry);
  bool sample_across_tiles(const CachedImage& image, const TexelPlace& place, float texel[4]);

  OIIO::ImageCache& cache_;
  std::array<Entry, kTiles> entries_;
};

}  // namespace morsel::render
