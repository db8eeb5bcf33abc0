// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagecache.h>

#include <array>
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

// Looks single points of images up, through a small table of the tiles that it met last: what
// OpenImageIO's own look-up spends on finding a tile and on its general case is most of the work
// here. Of one thread; holds on to its tiles.
class TileSampler {
 public:
  explicit TileSampler(OIIO::ImageCache& cache) : cache_(cache) {}
  ~TileSampler();
  TileSampler(const TileSampler&) = delete;
  TileSampler& operator=(const TileSampler&) = delete;

  // One point, chosen by `random` in [0, 1), of the footprint that TextureStore::lookup describes,
  // but with v down. Writes up to four channels; false if a tile cannot be read.
  bool sample(const CachedImage& image, Wrap wrap_u, Wrap wrap_v, V2f uv, const V2f& across,
              const V2f& along, float random, float texel[4]);

 private:
  static constexpr std::size_t kTiles = 128;
  struct Entry {
    std::uint64_t key = ~std::uint64_t{0};
    OIIO::ImageCache::Tile* tile = nullptr;
    const void* pixels = nullptr;
    bool half = false;
  };
  const Entry* find(const CachedImage& image, int level, int tile_x, int tile_y);
  bool add(const CachedImage& image, int level, int x, int y, float weight, float texel[4]);

  OIIO::ImageCache& cache_;
  std::array<Entry, kTiles> entries_;
};

}  // namespace morsel::render
