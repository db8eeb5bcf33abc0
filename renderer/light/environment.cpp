// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/environment.h"

#include <array>
#include <limits>
#include <stdexcept>

#include "renderer/math/atan2.h"
#include "renderer/math/sine_cosine.h"

namespace morsel::render {
namespace {

// Draws x in [0, 1] with density proportional to a (1 - x) + b x, by inversion.
float sample_linear(float u, float a, float b) {
  if (!(a + b > 0.0f)) return u;
  const float divisor = a + std::sqrt(a * a * (1.0f - u) + b * b * u);
  return divisor > 0.0f ? std::min(u * (a + b) / divisor, 1.0f) : 0.0f;
}

// Refuses what is not an image before anything reads it.
const EnvironmentImage& checked(const EnvironmentImage& image) {
  if (image.width < 1 || image.height < 1 ||
      image.texels.size() !=
          static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    throw std::invalid_argument("environment: an image needs width x height texels");
  return image;
}

}  // namespace

Environment::Environment(const EnvironmentImage& image, const V3f& scale, float rotation_degrees,
                         bool only_highlights)
    : texels_(checked(image)),
      scale_(scale),
      luminance_of_texel_(luminance(V3f(scale.x, 0.0f, 0.0f)), luminance(V3f(0.0f, scale.y, 0.0f)),
                          luminance(V3f(0.0f, 0.0f, scale.z))) {
  const int width = texels_.width(), height = texels_.height();
  if (width == 1 && height == 1) constant_ = image.texels[0] * scale;
  const float rotation = rotation_degrees * (kPi / 180.0f);
  sine_ = std::sin(rotation);
  cosine_ = std::cos(rotation);

  constexpr double kDoublePi = 3.14159265358979323846;
  const auto band = [&](double top, double bottom) {  // share of the sphere between two rows
    return 0.5 * (std::cos(kDoublePi * top / height) - std::cos(kDoublePi * bottom / height));
  };
  const auto mean_target = [&] {
    double mean = 0.0;
    for (int y = 0; y < height; ++y) {
      double sum = 0.0;
      for (int x = 0; x < width; ++x) sum += double{targets(texels_.corners(y, x))[2]};
      mean += sum / width * band(y, y + 1.0);
    }
    return static_cast<float>(mean);
  };
  sampled_luminance_ = constant_ ? luminance(*constant_) : mean_target();
  if (only_highlights) {
    not_sampled_ = sampled_luminance_;
    sampled_luminance_ = constant_ ? 0.0f : mean_target();
  }

  in_row_.emplace(static_cast<std::size_t>(height + 1), static_cast<std::size_t>(texels_.blocks()));
  double total_weight = 0.0;
  std::vector<double> row_weight, weight(static_cast<std::size_t>(texels_.blocks()));
  for (int row = 0; row <= height; ++row) {
    double total = 0.0;
    std::fill(weight.begin(), weight.end(), 0.0);
    for (int x = 0; x < width; ++x) {
      const Floats target = targets(texels_.corners(row, x));
      const double mean = 0.25 * (double{target[0]} + target[1] + target[2] + target[3]);
      weight[static_cast<std::size_t>(x / EnvironmentTexels::kPatches)] += mean;
      total += mean;
    }
    in_row_->set(static_cast<std::size_t>(row), weight);
    const double share = band(std::max(row - 0.5, 0.0), std::min(row + 0.5, 1.0 * height));
    row_weight.push_back(total * share);
    total_weight += row_weight.back();
    const double half = row == 0 || row == height ? 0.5 : 1.0;
    density_.push_back(
        static_cast<float>(share / half * width * height / (2.0 * kDoublePi * kDoublePi)));
  }
  rows_.emplace(row_weight);
  for (float& d : density_) d = total_weight > 0.0 ? static_cast<float>(d / total_weight) : 0.0f;
}

void Environment::find(const V3f& wi, Patch& p) const {
  if (constant()) return;
  const int width = texels_.width(), height = texels_.height();
  const float x = cosine_ * wi.x - sine_ * wi.z;
  const float z = sine_ * wi.x + cosine_ * wi.z;
  const float sine = std::sqrt(x * x + z * z);
  // Acos would lose digits near the poles.
  const FourFloats angles =
      fast_atan2(FourFloats{x, sine, 0.0f, 0.0f}, FourFloats{-z, wi.y, 0.0f, 0.0f});
  const float longitude = angles[0], colatitude = angles[1];  // (-pi, pi], 0 along -z
  // Texels' centres are at integers of these.
  const float s = (0.5f + longitude * (0.5f * kInvPi)) * static_cast<float>(width) - 0.5f;
  const float t = colatitude * kInvPi * static_cast<float>(height) - 0.5f;
  const int column = floor_of(s), row = floor_of(t);
  p.column = column < 0 ? width - 1 : column < width ? column : 0;
  p.row = std::clamp(row + 1, 0, height);
  p.position = V2f(s - static_cast<float>(column), t - static_cast<float>(row));
  p.sine = sine;
  texels_.prefetch(p.row, p.column / EnvironmentTexels::kPatches);
}

Environment::Floats Environment::targets(const EnvironmentTexels::Corners& texels) const {
  const Floats more = texels.weighed(luminance_of_texel_) - not_sampled_;
  return more > Floats{} ? more : Floats{};
}

// The chance of a patch is its mean times its row's solid angle, and the density within it is the
// target over that mean: the mean cancels, and no table of probabilities is asked.
float Environment::density(const Patch& p, const Floats& target) const {
  return p.sine > 0.0f ? EnvironmentTexels::at(target, p.position) *
                             density_[static_cast<std::size_t>(p.row)] / p.sine
                       : 0.0f;
}

V3f Environment::radiance(const Patch& p) const {
  if (constant()) return *constant_;
  return texels_.corners(p.row, p.column).at(p.position) * scale_;
}

float Environment::pdf(const V3f& wi) const { return arriving(wi).pdf; }

Environment::Arriving Environment::arriving(const Patch& p) const {
  if (constant()) return {*constant_, 0.25f * kInvPi};
  const EnvironmentTexels::Corners around = texels_.corners(p.row, p.column);
  return {around.at(p.position) * scale_, density(p, targets(around))};
}

void Environment::place(const V2f& u, Place& place) const {
  place.u = u;
  if (constant()) return;
  place.row = rows_->sample(u.y);
  in_row_->prefetch(place.row.index, u.x);
}

void Environment::fetch(Place& place) const {
  if (constant()) return;
  place.block = in_row_->sample(place.row.index, place.u.x);
  texels_.prefetch(static_cast<int>(place.row.index), static_cast<int>(place.block.index));
}

void Environment::sample(const Place& place, LightSample& sample) const {
  sample.distance = std::numeric_limits<float>::infinity();
  if (constant()) {
    const V2f& u = place.u;
    const float y = 1.0f - 2.0f * u.y, longitude = 2.0f * kPi * u.x;
    const float sine = std::sqrt(std::max(0.0f, 1.0f - y * y));
    sample.wi = V3f(sine * std::cos(longitude), y, sine * std::sin(longitude));
    sample.radiance = *constant_;
    sample.pdf = 0.25f * kInvPi;
    return;
  }
  const int width = texels_.width(), height = texels_.height();
  const auto &row = place.row, &block = place.block;
  Patch p;
  p.row = static_cast<int>(row.index);
  // Among the block's patches by what the four texels of each have in sum.
  constexpr int kPatches = EnvironmentTexels::kPatches;
  const int index = static_cast<int>(block.index), first = index * kPatches;
  const auto block_texels = texels_.weigh(p.row, index, luminance_of_texel_, not_sampled_);
  const Floats sums = (block_texels.upper_left + block_texels.upper_right) +
                      (block_texels.lower_left + block_texels.lower_right);
  const int patches = std::min(kPatches, width - first);
  float up_to[kPatches + 1] = {0.0f};  // of the patches before each, in sum
  for (int i = 0; i < kPatches; ++i) up_to[i + 1] = up_to[i] + (i < patches ? sums[i] : 0.0f);
  const float total = up_to[kPatches], wanted = block.offset * total;
  // Counted, for no processor foresees which.
  int in_block = (wanted >= up_to[1]) + (wanted >= up_to[2]) + (wanted >= up_to[3]);
  // Where rounding left something over, and where there is nothing.
  while (in_block > 0 && !(sums[in_block] > 0.0f && in_block < patches)) --in_block;
  const float offset =
      total > 0.0f ? std::min((wanted - up_to[in_block]) / sums[in_block], kOneMinusEpsilon) : 0.5f;
  p.column = first + in_block;
  const EnvironmentTexels::Corners around = texels_.corners(p.row, index, in_block);
  const float a = block_texels.upper_left[in_block], b = block_texels.upper_right[in_block],
              c = block_texels.lower_left[in_block], d = block_texels.lower_right[in_block];
  // At a pole the patch is half as high, and the light does not change along it.
  float y = sample_linear(row.offset, a + b, c + d);
  if (p.row == 0) y = 0.5f + 0.5f * y;
  if (p.row == height) y *= 0.5f;
  const float x = sample_linear(offset, a + (c - a) * y, b + (d - b) * y);
  p.position = V2f(x, y);

  const SineCosine longitude = sine_cosine_of_turns(
      (static_cast<float>(p.column) + 0.5f + x) / static_cast<float>(width) - 0.5f);
  const SineCosine colatitude = sine_cosine_of_turns(0.5f * (static_cast<float>(p.row) - 0.5f + y) /
                                                     static_cast<float>(height));
  p.sine = std::max(0.0f, colatitude.sine);
  const float east = p.sine * longitude.sine, south = -p.sine * longitude.cosine;

  sample.wi =
      V3f(cosine_ * east + sine_ * south, colatitude.cosine, cosine_ * south - sine_ * east);
  sample.radiance = around.at(p.position) * scale_;
  sample.pdf = density(p, Floats{a, b, c, d});
}

}  // namespace morsel::render
