// SPDX-License-Identifier: Apache-2.0
#include "renderer/texture/tile_sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "renderer/texture/linear_image.h"

namespace morsel::render {
namespace {

// Footprints that are longer than this times their width are taken to be wider.
constexpr float kMostAnisotropic = 32.0f;

// Of a finite half; exact, for what is not denormal. A table would push other things out of the
// processor's cache.
float from_half(std::uint16_t h) {
  const auto magnitude = std::bit_cast<float>(static_cast<std::uint32_t>(h & 0x7fffu) << 13);
  return (h & 0x8000u ? -0x1p112f : 0x1p112f) * magnitude;
}

float number(std::uint16_t half) { return from_half(half); }
float number(float x) { return x; }

// The weighted sum of four texels of a tile.
template <class Value>
void mix(const Value* tile, int channels, const int columns[2], const int rows[2],
         const float weight[4], float texel[4]) {
  const auto at = [&](int column, int row) {
    return tile + static_cast<std::ptrdiff_t>((row * kLinearImageTile + column) * channels);
  };
  const Value *a = at(columns[0], rows[0]), *b = at(columns[1], rows[0]),
              *c = at(columns[0], rows[1]), *d = at(columns[1], rows[1]);
  for (int k = 0; k < std::min(channels, 4); ++k)
    texel[k] = weight[0] * number(a[k]) + weight[1] * number(b[k]) + weight[2] * number(c[k]) +
               weight[3] * number(d[k]);
}

// A texel's index in an image that goes on as `wrap` says; -1: black.
int wrapped(int i, int n, Wrap wrap) {
  if (i >= 0 && i < n) return i;
  switch (wrap) {
    case Wrap::kClamp:
      return i < 0 ? 0 : n - 1;
    case Wrap::kBlack:
      return -1;
    case Wrap::kMirror: {
      const int period = ((i % (2 * n)) + 2 * n) % (2 * n);
      return period < n ? period : 2 * n - 1 - period;
    }
    case Wrap::kRepeat:
      break;
  }
  return ((i % n) + n) % n;
}

// The texel's centre at or before `x` and the share of the way to the next; 0 for what is beyond an
// int, or no number.
std::pair<int, float> split(float x) {
  if (!(std::abs(x) < 1e9f)) return {0, 0.0f};
  const float floor = std::floor(x);
  return {static_cast<int>(floor), x - floor};
}

}  // namespace

TileSampler::~TileSampler() {
  for (const Entry& e : entries_)
    if (e.tile != nullptr) cache_.release_tile(e.tile);
}

const TileSampler::Entry* TileSampler::find(const CachedImage& image, int level, int tile_x,
                                            int tile_y) {
  const std::uint64_t key =
      std::uint64_t{image.number} << 40 | static_cast<std::uint64_t>(level) << 32 |
      static_cast<std::uint64_t>(tile_y) << 16 | static_cast<std::uint64_t>(tile_x);
  Entry& e = entries_[(key * 0x9e3779b97f4a7c15u) >> (64 - std::bit_width(kTiles - 1))];
  if (e.key == key) return &e;
  OIIO::ImageCache::Tile* tile = cache_.get_tile(
      image.handle, nullptr, 0, level, tile_x * kLinearImageTile, tile_y * kLinearImageTile, 0);
  if (tile == nullptr) return nullptr;
  if (e.tile != nullptr) cache_.release_tile(e.tile);
  OIIO::TypeDesc format;
  e.pixels = cache_.tile_pixels(tile, format);
  e.tile = tile;
  e.half = format == OIIO::TypeDesc::HALF;
  e.key = key;
  return &e;
}

bool TileSampler::add(const CachedImage& image, int level, int x, int y, float weight,
                      float texel[4]) {
  if (x < 0 || y < 0 || weight == 0.0f) return true;
  const Entry* e = find(image, level, x / kLinearImageTile, y / kLinearImageTile);
  if (e == nullptr) return false;
  const auto at =
      static_cast<std::size_t>((y % kLinearImageTile) * kLinearImageTile + x % kLinearImageTile) *
      static_cast<std::size_t>(image.channels);
  const int channels = std::min(image.channels, 4);
  if (e->half) {
    const auto* values = static_cast<const std::uint16_t*>(e->pixels) + at;
    for (int c = 0; c < channels; ++c) texel[c] += weight * from_half(values[c]);
  } else {
    const auto* values = static_cast<const float*>(e->pixels) + at;
    for (int c = 0; c < channels; ++c) texel[c] += weight * values[c];
  }
  return true;
}

bool TileSampler::sample(const CachedImage& image, Wrap wrap_u, Wrap wrap_v, V2f uv,
                         const V2f& across, const V2f& along, float random, float texel[4]) {
  const V2f size(static_cast<float>(image.width), static_cast<float>(image.height));
  V2f major = across;
  float longest = (across * size).length(), shortest = (along * size).length();
  if (shortest > longest) {
    std::swap(longest, shortest);
    major = along;
  }
  // The level whose texels are as large as the footprint is wide: one of the two about it, by
  // linear interpolation in the width.
  const float width = std::max(shortest, longest / kMostAnisotropic);
  int level = 0;
  if (!(width < 1e9f)) {
    level = image.levels - 1;
  } else if (width > 1.0f) {
    const float share = 2.0f * std::frexp(width, &level) - 1.0f;  // of the coarser one
    if (random < share) {
      random /= share;
    } else {
      random = (random - share) / (1.0f - share);
      --level;
    }
    level = std::min(level, image.levels - 1);
  }
  // A point of the long axis; what the level's texels cover themselves is not walked again.
  if (longest > width && longest < 1e9f) uv += major * ((random - 0.5f) * (1.0f - width / longest));

  const int columns = std::max(1, image.width >> level), rows = std::max(1, image.height >> level);
  const auto [x, fx] = split(uv.x * static_cast<float>(columns) - 0.5f);
  const auto [y, fy] = split(uv.y * static_cast<float>(rows) - 0.5f);
  const int x0 = wrapped(x, columns, wrap_u), x1 = wrapped(x + 1, columns, wrap_u);
  const int y0 = wrapped(y, rows, wrap_v), y1 = wrapped(y + 1, rows, wrap_v);
  const float weight[] = {(1.0f - fx) * (1.0f - fy), fx * (1.0f - fy), (1.0f - fx) * fy, fx * fy};
  if (x0 >= 0 && y0 >= 0 && x0 / kLinearImageTile == x1 / kLinearImageTile &&
      y0 / kLinearImageTile == y1 / kLinearImageTile) [[likely]] {
    const Entry* e = find(image, level, x0 / kLinearImageTile, y0 / kLinearImageTile);
    if (e == nullptr) return false;
    const int columns_in[] = {x0 % kLinearImageTile, x1 % kLinearImageTile};
    const int rows_in[] = {y0 % kLinearImageTile, y1 % kLinearImageTile};
    if (e->half)
      mix(static_cast<const std::uint16_t*>(e->pixels), image.channels, columns_in, rows_in, weight,
          texel);
    else
      mix(static_cast<const float*>(e->pixels), image.channels, columns_in, rows_in, weight, texel);
    return true;
  }
  std::fill_n(texel, std::min(image.channels, 4), 0.0f);
  return add(image, level, x0, y0, weight[0], texel) &&
         add(image, level, x1, y0, weight[1], texel) &&
         add(image, level, x0, y1, weight[2], texel) && add(image, level, x1, y1, weight[3], texel);
}

}  // namespace morsel::render
