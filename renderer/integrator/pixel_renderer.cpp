// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/pixel_renderer.h"

namespace morsel::render {
namespace {

// The error is relative to the pixel's luminance plus this: the eye does not see less in the dark.
constexpr double kDarkest = 0.02;

}  // namespace

struct PixelRenderer::Half {
  int x, y;
  PixelSampler sampler;
  std::size_t pixel;  // in the tile
  std::uint32_t which;
  TileSums& tile;
  PixelAccumulator& accumulator;
  std::uint32_t* needed;  // null: not adaptive
};

PixelRenderer::PixelRenderer(const PathTracer& tracer, const Camera& camera,
                             const RenderSettings& settings, const MatteNames* mattes, Shard shard,
                             NonFiniteReport& non_finite, const Watch* watch)
    : tracer_(tracer),
      camera_(camera),
      settings_(settings),
      mattes_(mattes),
      shard_(shard),
      non_finite_(non_finite),
      filter_(settings.filter, settings.filter_radius),
      watch_(watch) {}

bool PixelRenderer::adaptive() const { return settings_.noise_target > 0.0f && settings_.spp >= 4; }

std::uint32_t PixelRenderer::most_samples() const {
  const int most = adaptive() ? settings_.spp / 2 : settings_.spp;
  return shard_.range(static_cast<std::uint32_t>(most)).size() + (adaptive() ? 1u : 0u);
}

std::uint32_t PixelRenderer::first_target() const {
  if (!adaptive() || shard_.count > 1) return 1;
  return static_cast<std::uint32_t>(std::clamp(settings_.min_spp / 2, 2, settings_.spp / 2));
}

PixelRenderer::Half PixelRenderer::half(int x, int y, std::uint32_t which, TileSums& tile) const {
  const std::uint32_t seed = which == 0 ? settings_.seed : mix_bits(settings_.seed ^ 0x5bd1e995u);
  const std::size_t pixel = tile.offset(x, y), at = which * tile.pixel_count() + pixel;
  return {x,     y,    PixelSampler(x, y, seed), pixel,
          which, tile, tile.pixels[at],          tile.needed.empty() ? nullptr : &tile.needed[at]};
}

// `offset` becomes the place in the pixel. Radiance that is not finite is reported, and stays.
PathSample PixelRenderer::trace(const Half& half, std::uint32_t index, V2f& offset,
                                RayCounts& rays) const {
  PixelSampler sampler = half.sampler;
  sampler.start_sample(index);
  offset = V2f(0.5f) + filter_.sample(sampler.get_2d(kPixelDimension));
  const Ray ray = camera_ray(camera_, sampler,
                             V2f(static_cast<float>(half.x), static_cast<float>(half.y)) + offset);
  const PathSample sample = tracer_.trace(ray, sampler, rays);
  if (sample.non_finite_bounce != PathSample::kAllFinite)
    non_finite_.add({half.y, half.x, half.which, index, sample.non_finite_bounce});
  return sample;
}

// Until the half has `target` samples of `range`.
void PixelRenderer::add_samples(Half& half, std::uint32_t target, Shard::Range range,
                                LuminanceStatistics* luminances) const {
  TileSums& tile = half.tile;
  const std::size_t n = tile.pixel_count();
  const std::size_t halves = tile.pixels.size() / n, groups = tile.groups.size() / (n * halves);
  target = std::min(target, range.size());
  while (half.accumulator.samples() < target) {
    const std::uint32_t index = range.begin + half.accumulator.samples();
    V2f offset;
    PathSample sample = trace(half, index, offset, tile.counts.rays);
    if (watch_ != nullptr)
      (*watch_)(half.which, index,
                V2f(static_cast<float>(half.x), static_cast<float>(half.y)) + offset, sample);
    ++tile.counts.samples;
    if (sample.non_finite_bounce != PathSample::kAllFinite) {
      ++tile.counts.non_finite;
      sample.radiance = V3f(0.0f);
      sample.groups.fill(V3f(0.0f));
    }
    if (luminances != nullptr) luminances->add(luminance(sample.radiance));
    half.accumulator.add(sample, offset.x, offset.y, index);
    for (std::size_t g = 0; g < groups; ++g)
      tile.groups[(g * halves + half.which) * n + half.pixel].add(sample.groups[g]);
    if (mattes_ == nullptr) continue;
    for (std::size_t m = 0; m < kMattes; ++m)
      tile.mattes[m * n + half.pixel].add(mattes_->id(static_cast<Matte>(m), sample));
    if (sample.component > 0.0f)
      tile.counts.components.emplace(sample.instance,
                                     static_cast<std::uint32_t>(sample.component) - 1);
  }
}

// Of a half, by the estimate of the other: both halves' variances together are s^2 / (2 n).
std::uint32_t PixelRenderer::samples_needed(const LuminanceStatistics& other) const {
  const double wanted = settings_.noise_target * (other.mean() + kDarkest);
  const double count = 0.5 * other.variance() / (wanted * wanted);
  const int most = settings_.spp / 2, least = std::min(settings_.min_spp / 2, most);
  int n = std::max(least, 1);  // powers of two times it keep the sequence's nets whole
  while (n < count && n < most) n *= 2;
  return static_cast<std::uint32_t>(std::min(n, most));
}

void PixelRenderer::decide(Half& first, Half& second) const {
  const auto pilot =
      static_cast<std::uint32_t>(std::clamp(settings_.min_spp / 2, 2, settings_.spp / 2));
  LuminanceStatistics luminances[2];
  for (Half* half : {&first, &second}) {
    if (shard_.count == 1) {
      add_samples(*half, pilot, {0, pilot}, &luminances[half->which]);
      continue;
    }
    for (std::uint32_t i = 0; i < pilot; ++i) {
      V2f offset;
      const PathSample sample = trace(*half, i, offset, half->tile.counts.rays);
      luminances[half->which].add(is_finite(sample.radiance) ? luminance(sample.radiance) : 0.0f);
    }
  }
  *first.needed = samples_needed(luminances[1]);
  *second.needed = samples_needed(luminances[0]);
}

void PixelRenderer::advance(int x, int y, std::uint32_t target, TileSums& tile) const {
  Half first = half(x, y, 0, tile);
  if (!adaptive()) {
    add_samples(first, target, shard_.range(static_cast<std::uint32_t>(settings_.spp)), nullptr);
    return;
  }
  Half second = half(x, y, 1, tile);
  if (*first.needed == 0) decide(first, second);
  for (Half* half : {&first, &second})
    add_samples(*half, target, shard_.range(*half->needed), nullptr);
}

}  // namespace morsel::render
