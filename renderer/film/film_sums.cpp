// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/film_sums.h"

#include <fmt/format.h>

#include <stdexcept>

#include "renderer/film/matte_names.h"

namespace morsel::render {
namespace {

// The mean of two independent halves, not of all their samples: see PixelRenderer.
Pixel mean_of(const Pixel& a, const Pixel& b) {
  if (b.samples == 0) return a;
  if (a.samples == 0) return b;
  Pixel m = a;  // ids, depth and place of the first half
  m.color = (a.color + b.color) * 0.5f;
  m.alpha = (a.alpha + b.alpha) * 0.5f;
  m.albedo = (a.albedo + b.albedo) * 0.5f;
  m.normal = (a.normal + b.normal) * 0.5f;
  m.variance = (a.variance + b.variance) * 0.25f;
  m.steps = (a.steps + b.steps) * 0.5f;
  m.samples = a.samples + b.samples;
  return m;
}

void develop_tile(const FilmLayout& layout, const TileSums& tile, Film& film) {
  const std::size_t n = tile.pixel_count();
  const auto mean_group = [&](std::size_t group, std::size_t pixel) {
    V3f sum(0.0f);
    int halves = 0;
    for (std::size_t h = 0; h < layout.halves; ++h) {
      const std::uint32_t samples = tile.pixels[h * n + pixel].samples();
      if (samples == 0) continue;
      sum += V3f(tile.groups[(group * layout.halves + h) * n + pixel].mean(samples));
      ++halves;
    }
    return halves == 2 ? sum * 0.5f : sum;
  };
  for (int y = tile.window.y0; y < tile.window.y1; ++y)
    for (int x = tile.window.x0; x < tile.window.x1; ++x) {
      const std::size_t i = tile.offset(x, y);
      Pixel& pixel = film.at(x, y);
      pixel = tile.pixels[i].result();
      if (layout.halves == 2) pixel = mean_of(pixel, tile.pixels[n + i].result());
      for (std::size_t g = 0; g < layout.groups; ++g) film.group(g, x, y) = mean_group(g, i);
      if (pixel.samples == 0) continue;
      for (std::size_t m = 0; m < film.matte_count(); ++m)
        film.matte(m, x, y) = tile.mattes[m * n + i].ranks(pixel.samples);
    }
}

}  // namespace

FilmLayout::FilmLayout(const RenderSettings& settings, std::size_t light_groups)
    : full_width(settings.width),
      full_height(settings.height),
      window(window_of(settings)),
      halves(settings.noise_target > 0.0f && settings.spp >= 4 ? 2 : 1),
      groups(static_cast<std::uint32_t>(light_groups)),
      mattes(settings.cryptomatte) {}

TileSums::TileSums(const FilmLayout& layout, const Crop& w) : window(w) {
  const std::size_t n = pixel_count();
  pixels.resize(n * layout.halves);
  if (layout.halves > 1) needed.resize(n * layout.halves, 0);
  groups.resize(n * layout.halves * layout.groups);
  if (layout.mattes) mattes.resize(n * kMattes);
}

void TileSums::require_possible(std::uint32_t most) const {
  for (const PixelAccumulator& pixel : pixels)
    if (!pixel.is_possible(most))
      throw std::runtime_error(
          fmt::format("a pixel has sums that no {} samples have", pixel.samples()));
  for (const ColorSum& group : groups)
    if (!group.is_sum_of(most))
      throw std::runtime_error(
          fmt::format("a light group has a sum that no {} samples have", most));
}

void TileSums::add(const TileSums& other) {
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i].add(other.pixels[i]);
  for (std::size_t i = 0; i < groups.size(); ++i) groups[i].add(other.groups[i]);
  for (std::size_t i = 0; i < mattes.size(); ++i) mattes[i].add(other.mattes[i]);
  counts.add(other.counts);
}

FilmSums::FilmSums(const FilmLayout& layout, Shard shard) : layout_(layout), shard_(shard) {
  if (shard.count < 1 || shard.index >= shard.count)
    throw std::invalid_argument(
        fmt::format("film: shard {} of {}; shards count from 0", shard.index, shard.count));
  const Crop& w = layout.window;
  columns_ = (w.x1 - w.x0 + kTileSize - 1) / kTileSize;
  rows_ = (w.y1 - w.y0 + kTileSize - 1) / kTileSize;
  for (int y = w.y0; y < w.y1; y += kTileSize)
    for (int x = w.x0; x < w.x1; x += kTileSize)
      tiles_.push_back(std::make_unique<Tile>(
          layout, Crop{x, y, std::min(x + kTileSize, w.x1), std::min(y + kTileSize, w.y1)}));
}

Film FilmSums::develop() {
  RenderSettings settings;
  settings.width = layout_.full_width;
  settings.height = layout_.full_height;
  settings.crop = layout_.window;
  settings.cryptomatte = layout_.mattes;
  Film film(settings, layout_.groups);
  for (int i = 0; i < tile_count(); ++i)
    with_tile(i, [&](const TileSums& tile) {
      develop_tile(layout_, tile, film);
      film.add_components(tile.counts.components);
    });
  return film;
}

SampleCounts FilmSums::counts() {
  SampleCounts all;
  for (int i = 0; i < tile_count(); ++i)
    with_tile(i, [&](const TileSums& tile) { all.add(tile.counts); });
  return all;
}

FilmSums::Fireflies FilmSums::fireflies() {
  Fireflies found;
  for (int i = 0; i < tile_count(); ++i)
    with_tile(i, [&](const TileSums& tile) {
      for (const PixelAccumulator& p : tile.pixels) {
        found.pixels += p.firefly();
        found.brightest = std::max(found.brightest, p.brightest());
      }
    });
  return found;
}

void FilmSums::add(FilmSums& other) {
  if (layout_ != other.layout_)
    throw std::invalid_argument("film: sums of images of another kind cannot be added");
  for (int i = 0; i < tile_count(); ++i)
    with_tile(i, [&](TileSums& tile) {
      other.with_tile(i, [&](const TileSums& more) { tile.add(more); });
    });
}

}  // namespace morsel::render
