// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/pixel_renderer.h"

#include <array>

namespace morsel::render {
namespace {

// The error is relative to the pixel's luminance plus this: the eye does not see less in the dark.
constexpr double kDarkest = 0.02;

Pixel mean_of(const Pixel& a, const Pixel& b) {
  Pixel m = a;  // ids and depth of the first half
  m.color = (a.color + b.color) * 0.5f;
  m.alpha = (a.alpha + b.alpha) * 0.5f;
  m.albedo = (a.albedo + b.albedo) * 0.5f;
  m.normal = (a.normal + b.normal) * 0.5f;
  m.variance = (a.variance + b.variance) * 0.25f;
  m.steps = (a.steps + b.steps) * 0.5f;
  m.samples = a.samples + b.samples;
  return m;
}

}  // namespace

struct PixelRenderer::Half {
  PixelSampler sampler;
  PixelAccumulator accumulator;
  std::array<cryptomatte::Accumulator, kMattes>& mattes;
  int done = 0;
};

PixelRenderer::PixelRenderer(const PathTracer& tracer, const Camera& camera,
                             const RenderSettings& settings, const MatteNames* mattes)
    : tracer_(tracer),
      camera_(camera),
      settings_(settings),
      mattes_(mattes),
      filter_(settings.filter, settings.filter_radius) {}

void PixelRenderer::add_samples(Half& half, int count, int x, int y, TileCounts& counts) const {
  for (; half.done < count; ++half.done) {
    const PixelSampler& sampler = half.sampler;
    half.sampler.start_sample(static_cast<std::uint32_t>(half.done));
    const V2f offset = V2f(0.5f) + filter_.sample(sampler.get_2d(kPixelDimension));
    const Ray ray = camera_.ray(static_cast<float>(x) + offset.x, static_cast<float>(y) + offset.y,
                                sampler.get_2d(kLensDimension), sampler.get_1d(kTimeDimension));
    PathSample sample = tracer_.trace(ray, sampler, counts.rays);
    ++counts.samples;
    if (!is_finite(sample.radiance)) {
      ++counts.non_finite;
      sample.radiance = V3f(0.0f);
      sample.groups.fill(V3f(0.0f));
    }
    half.accumulator.add(sample, offset.x, offset.y);
    if (mattes_ == nullptr) continue;
    for (std::size_t m = 0; m < kMattes; ++m)
      half.mattes[m].add(mattes_->id(static_cast<Matte>(m), sample));
    if (sample.component > 0.0f)
      counts.components.emplace(sample.instance, static_cast<std::uint32_t>(sample.component) - 1);
  }
}

// Of a half, by the estimate of the other: both halves' variances together are s^2 / (2 n).
int PixelRenderer::samples_needed(const PixelAccumulator& other) const {
  const double wanted = settings_.noise_target * (other.mean_luminance() + kDarkest);
  const double count = 0.5 * other.luminance_variance() / (wanted * wanted);
  const int most = settings_.spp / 2, least = std::min(settings_.min_spp / 2, most);
  int n = std::max(least, 1);  // powers of two times it keep the sequence's nets whole
  while (n < count && n < most) n *= 2;
  return std::min(n, most);
}

void PixelRenderer::render(int x, int y, Film& film, TileCounts& counts) const {
  std::array<cryptomatte::Accumulator, kMattes> mattes;
  const auto finish = [&](const PixelAccumulator& a) {
    counts.fireflies += a.firefly();
    counts.brightest = std::max(counts.brightest, a.brightest());
  };
  Half first{PixelSampler(x, y, settings_.seed), {}, mattes};
  if (!(settings_.noise_target > 0.0f) || settings_.spp < 4) {
    add_samples(first, settings_.spp, x, y, counts);
    film.at(x, y) = first.accumulator.result();
    for (std::size_t i = 0; i < film.group_count(); ++i)
      film.group(i, x, y) = first.accumulator.group(static_cast<std::uint32_t>(i));
    finish(first.accumulator);
  } else {
    Half second{PixelSampler(x, y, mix_bits(settings_.seed ^ 0x5bd1e995u)), {}, mattes};
    const int pilot = std::clamp(settings_.min_spp / 2, 2, settings_.spp / 2);
    add_samples(first, pilot, x, y, counts);
    add_samples(second, pilot, x, y, counts);
    const int of_first = samples_needed(second.accumulator);
    const int of_second = samples_needed(first.accumulator);
    add_samples(first, of_first, x, y, counts);
    add_samples(second, of_second, x, y, counts);
    film.at(x, y) = mean_of(first.accumulator.result(), second.accumulator.result());
    for (std::size_t i = 0; i < film.group_count(); ++i) {
      const auto g = static_cast<std::uint32_t>(i);
      film.group(i, x, y) = (first.accumulator.group(g) + second.accumulator.group(g)) * 0.5f;
    }
    finish(first.accumulator);
    finish(second.accumulator);
  }
  for (std::size_t m = 0; m < film.matte_count(); ++m)
    film.matte(m, x, y) = mattes[m].ranks(film.at(x, y).samples);
}

}  // namespace morsel::render
