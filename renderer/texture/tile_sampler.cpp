// SPDX-License-Identifier: Apache-2.0
#include "renderer/texture/tile_sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "renderer/texture/linear_image.h"

namespace morsel::render {
namespace {

// Footprints that are longer than this times their width are taken to be wider.
constexpr float kMostAnisotropic = 32.0f;
// Squares of lengths in texels from here on, and what is no number, are of the coarsest level.
constexpr float kFarTooLong = 1e18f;

constexpr auto kTile = static_cast<unsigned>(kLinearImageTile);

using Floats = float __attribute__((vector_size(16)));

// The first `channels` halves of a texel as floats over 2^112, then zeros; exact, for those that
// are finite and not denormal. A table would push other things out of the processor's cache.
Floats small_floats(const std::uint16_t* texel, int channels) {
  using Halves = std::uint16_t __attribute__((vector_size(8)));
  using Words = std::uint32_t __attribute__((vector_size(16)));
  using Ints = std::int32_t __attribute__((vector_size(16)));
  // Put together in a register: memory that was written in parts makes whoever reads it wait.
  std::uint64_t bits = texel[0];
  if (channels >= 2) {
    std::uint32_t two;
    std::memcpy(&two, texel, sizeof two);
    bits = two;
  }
  if (channels >= 3) bits |= std::uint64_t{texel[2]} << 32;
  if (channels >= 4) bits |= std::uint64_t{texel[3]} << 48;
  const auto half = std::bit_cast<Halves>(bits);
  // The sign moves with its copies, which are masked away, and leaves the exponent in place.
  const Words high = __builtin_convertvector(half, Words) << 16;
  const Ints moved = std::bit_cast<Ints>(high) >> 3;
  return std::bit_cast<Floats>(std::bit_cast<Words>(moved) & 0x8fffffffu);
}
constexpr float kHalfScale = 0x1p112f;

Floats floats(const float* texel, int channels) {
  Floats f{};
  for (int c = 0; c < channels; ++c) f[c] = texel[c];
  return f;
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
  return i < 0 ? n - 1 : 0;  // they are within one of the image
}

// The two texels whose centres are about coordinate `u` of an axis of `n`, and the share of the
// second. What is beyond an int, or no number, is the first texel.
struct Pair {
  int first, second;
  float share;
};
Pair pair_at(float u, int n, Wrap wrap) {
  const auto far = [](float x) { return !(std::abs(x) < 1e9f); };
  if (far(u)) u = 0.0f;
  if (wrap == Wrap::kRepeat) u -= static_cast<float>(floor_of(u));
  const float x = u * static_cast<float>(n) - 0.5f;
  if (far(x)) return {wrapped(0, n, wrap), wrapped(1, n, wrap), 0.0f};
  const int i = floor_of(x);
  return {wrapped(i, n, wrap), wrapped(i + 1, n, wrap), x - static_cast<float>(i)};
}

}  // namespace

TexelPlace texel_place(const CachedImage& image, Wrap wrap_u, Wrap wrap_v, V2f uv,
                       const V2f& across, const V2f& along, float random) {
  const V2f size(static_cast<float>(image.width), static_cast<float>(image.height));
  const V2f a = across * size, b = along * size;
  const float a2 = a.x * a.x + a.y * a.y, b2 = b.x * b.x + b.y * b.y;
  const float longest2 = std::max(a2, b2), shortest2 = std::min(a2, b2);
  // The level whose texels are as large as the footprint is wide: one of the two about it, by
  // linear interpolation in the width.
  const float width2 =
      std::max(shortest2, longest2 * (1.0f / (kMostAnisotropic * kMostAnisotropic)));
  TexelPlace place;
  if (!(width2 < kFarTooLong)) {
    place.level = image.levels - 1;
  } else if (width2 > 1.0f) {
    const auto bits = std::bit_cast<std::uint32_t>(std::sqrt(width2));
    // The width is (1 + share) 2^finer.
    const int finer = static_cast<int>(bits >> 23) - 127;
    const float share =
        std::bit_cast<float>((bits & 0x007fffffu) | 0x3f800000u) - 1.0f;  // of the coarser one
    const bool coarser = random < share;
    random = coarser ? random / share : (random - share) / (1.0f - share);
    place.level = std::min(finer + (coarser ? 1 : 0), image.levels - 1);
  }
  // A point of the long axis; what the level's texels cover themselves is not walked again.
  if (longest2 > width2 && longest2 < kFarTooLong)
    uv += (b2 > a2 ? along : across) * ((random - 0.5f) * (1.0f - std::sqrt(width2 / longest2)));

  const Pair x = pair_at(uv.x, std::max(1, image.width >> place.level), wrap_u);
  const Pair y = pair_at(uv.y, std::max(1, image.height >> place.level), wrap_v);
  place.x[0] = x.first;
  place.x[1] = x.second;
  place.y[0] = y.first;
  place.y[1] = y.second;
  const float left = 1.0f - x.share, up = 1.0f - y.share;
  place.weight[0] = left * up;
  place.weight[1] = x.share * up;
  place.weight[2] = left * y.share;
  place.weight[3] = x.share * y.share;
  return place;
}

TileSampler::~TileSampler() {
  for (const Entry& e : entries_)
    if (e.tile != nullptr) cache_.release_tile(e.tile);
}

bool TileSampler::fetch(const CachedImage& image, int level, unsigned tile_x, unsigned tile_y,
                        std::uint64_t key, Entry& e) {
  OIIO::ImageCache::Tile* tile =
      cache_.get_tile(image.handle, nullptr, 0, level, static_cast<int>(tile_x * kTile),
                      static_cast<int>(tile_y * kTile), 0);
  if (tile == nullptr) return false;
  if (e.tile != nullptr) cache_.release_tile(e.tile);
  OIIO::TypeDesc format;
  e.pixels = cache_.tile_pixels(tile, format);
  e.tile = tile;
  e.half = format == OIIO::TypeDesc::HALF;
  e.key = key;
  return true;
}

bool TileSampler::sample(const CachedImage& image, const TexelPlace& place, float texel[4]) {
  // Of those below 0 no tile has the number.
  const auto x0 = static_cast<unsigned>(place.x[0]), x1 = static_cast<unsigned>(place.x[1]),
             y0 = static_cast<unsigned>(place.y[0]), y1 = static_cast<unsigned>(place.y[1]);
  if (x0 / kTile != x1 / kTile || y0 / kTile != y1 / kTile || place.x[0] < 0 || place.y[0] < 0)
      [[unlikely]]
    return sample_across_tiles(image, place, texel);
  const Entry* e = find(image, place.level, x0 / kTile, y0 / kTile);
  if (e == nullptr) return false;
  const int channels = image.channels;
  const auto at = [&](const auto* pixels, unsigned x, unsigned y) {
    return pixels + std::size_t{(y % kTile) * kTile + x % kTile} * static_cast<unsigned>(channels);
  };
  const auto sum = [&](const auto* pixels, auto&& numbers) {
    return numbers(at(pixels, x0, y0)) * place.weight[0] +
           numbers(at(pixels, x1, y0)) * place.weight[1] +
           numbers(at(pixels, x0, y1)) * place.weight[2] +
           numbers(at(pixels, x1, y1)) * place.weight[3];
  };
  Floats mixed;
  if (e->half) [[likely]]
    mixed = sum(static_cast<const std::uint16_t*>(e->pixels),
                [&](const std::uint16_t* t) { return small_floats(t, channels) * kHalfScale; });
  else
    mixed = sum(static_cast<const float*>(e->pixels),
                [&](const float* t) { return floats(t, std::min(channels, 4)); });
  std::memcpy(texel, &mixed, sizeof mixed);
  return true;
}

bool TileSampler::sample_across_tiles(const CachedImage& image, const TexelPlace& place,
                                      float texel[4]) {
  const int channels = image.channels;
  Floats sum{};
  for (int i = 0; i < 4; ++i) {
    const int x = place.x[i % 2], y = place.y[i / 2];
    if (x < 0 || y < 0 || place.weight[i] == 0.0f) continue;
    const auto column = static_cast<unsigned>(x), row = static_cast<unsigned>(y);
    const Entry* e = find(image, place.level, column / kTile, row / kTile);
    if (e == nullptr) return false;
    const std::size_t at =
        std::size_t{(row % kTile) * kTile + column % kTile} * static_cast<unsigned>(channels);
    sum += place.weight[i] *
           (e->half ? small_floats(static_cast<const std::uint16_t*>(e->pixels) + at, channels) *
                          kHalfScale
                    : floats(static_cast<const float*>(e->pixels) + at, std::min(channels, 4)));
  }
  std::memcpy(texel, &sum, sizeof sum);
  return true;
}

}  // namespace morsel::render
