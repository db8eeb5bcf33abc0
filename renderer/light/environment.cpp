// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/environment.h"

#include <array>
#include <limits>
#include <stdexcept>

namespace morsel::render {
namespace {

// Draws x in [0, 1] with density proportional to a (1 - x) + b x, by inversion.
float sample_linear(float u, float a, float b) {
  if (!(a + b > 0.0f)) return u;
  const float divisor = a + std::sqrt(a * a * (1.0f - u) + b * b * u);
  return divisor > 0.0f ? std::min(u * (a + b) / divisor, 1.0f) : 0.0f;
}

}  // namespace

Environment::Environment(EnvironmentImage image, const V3f& scale, float rotation_degrees,
                         bool only_highlights)
    : image_(std::move(image)) {
  const int width = image_.width, height = image_.height;
  if (width < 1 || height < 1 ||
      image_.texels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw std::invalid_argument("environment: an image needs width x height texels");
  for (V3f& t : image_.texels) t *= scale;
  const float rotation = rotation_degrees * (kPi / 180.0f);
  sine_ = std::sin(rotation);
  cosine_ = std::cos(rotation);

  constexpr double kDoublePi = 3.14159265358979323846;
  const auto band = [&](double top, double bottom) {  // share of the sphere between two rows
    return 0.5 * (std::cos(kDoublePi * top / height) - std::cos(kDoublePi * bottom / height));
  };
  std::vector<float> target;  // of each texel
  const auto mean_target = [&] {
    double mean = 0.0;
    for (int y = 0; y < height; ++y) {
      double sum = 0.0;
      for (int x = 0; x < width; ++x) sum += target[index(x, y)];
      mean += sum / width * band(y, y + 1.0);
    }
    return static_cast<float>(mean);
  };
  for (const V3f& t : image_.texels) target.push_back(luminance(t));
  sampled_luminance_ = mean_target();
  if (only_highlights) {
    not_sampled_ = sampled_luminance_;
    for (std::size_t i = 0; i < target.size(); ++i) target[i] = target_of(image_.texels[i]);
    sampled_luminance_ = mean_target();
  }

  std::vector<double> row_weight, weight(static_cast<std::size_t>(width));
  for (int row = 0; row <= height; ++row) {
    const int y0 = std::max(row - 1, 0), y1 = std::min(row, height - 1);
    double total = 0.0;
    for (int x = 0; x < width; ++x) {
      const int x1 = (x + 1) % width;
      const double mean = 0.25 * (double{target[index(x, y0)]} + target[index(x1, y0)] +
                                  target[index(x, y1)] + target[index(x1, y1)]);
      weight[static_cast<std::size_t>(x)] = mean;
      total += mean;
    }
    in_row_.emplace_back(weight);
    row_weight.push_back(total * band(std::max(row - 0.5, 0.0), std::min(row + 0.5, 1.0 * height)));
  }
  rows_.emplace(row_weight);
}

Environment::Patch Environment::patch(const V3f& wi) const {
  const int width = image_.width, height = image_.height;
  const float x = cosine_ * wi.x - sine_ * wi.z;
  const float z = sine_ * wi.x + cosine_ * wi.z;
  const float longitude = std::atan2(x, -z);  // (-pi, pi], 0 along -z
  const float sine = std::sqrt(x * x + z * z);
  const float colatitude = std::atan2(sine, wi.y);  // acos would lose digits near the poles
  // Texels' centres are at integers of these.
  const float s = (0.5f + longitude * (0.5f * kInvPi)) * static_cast<float>(width) - 0.5f;
  const float t = colatitude * kInvPi * static_cast<float>(height) - 0.5f;
  const float floor_s = std::floor(s), floor_t = std::floor(t);

  Patch p;
  p.x0 = (static_cast<int>(floor_s) + width) % width;
  p.x1 = (p.x0 + 1) % width;
  const int row = std::clamp(static_cast<int>(floor_t) + 1, 0, height);
  p.y0 = std::max(row - 1, 0);
  p.y1 = std::min(row, height - 1);
  p.position = V2f(s - floor_s, t - floor_t);
  p.sine = sine;
  p.row = static_cast<std::size_t>(row);
  p.column = static_cast<std::size_t>(p.x0);
  return p;
}

V3f Environment::interpolate(const Patch& p) const {
  const auto [x, y] = std::pair(p.position.x, p.position.y);
  const V3f upper = texel(p.x0, p.y0) * (1.0f - x) + texel(p.x1, p.y0) * x;
  const V3f lower = texel(p.x0, p.y1) * (1.0f - x) + texel(p.x1, p.y1) * x;
  return upper * (1.0f - y) + lower * y;
}

Environment::Corners Environment::corners(const Patch& p) const {
  return {target_of(texel(p.x0, p.y0)), target_of(texel(p.x1, p.y0)), target_of(texel(p.x0, p.y1)),
          target_of(texel(p.x1, p.y1))};
}

float Environment::density(const Patch& p, const Corners& target, float probability) const {
  const float mean = target.mean();
  if (!(mean > 0.0f) || !(p.sine > 0.0f)) return 0.0f;
  const bool pole = p.row == 0 || p.row == static_cast<std::size_t>(image_.height);
  const float height = pole ? 0.5f : 1.0f;
  const float patches = static_cast<float>(image_.width) * static_cast<float>(image_.height);
  return probability * target.at(p.position) / (mean * height) * patches /
         (2.0f * kPi * kPi * p.sine);
}

V3f Environment::radiance(const V3f& wi) const { return interpolate(patch(wi)); }

float Environment::pdf(const V3f& wi) const {
  if (constant()) return 0.25f * kInvPi;
  return pdf(patch(wi));
}

float Environment::pdf(const Patch& p) const {
  return density(p, corners(p), rows_->probability(p.row) * in_row_[p.row].probability(p.column));
}

Environment::Arriving Environment::arriving(const V3f& wi) const {
  if (constant()) return {texel(0, 0), pdf(wi)};
  const Patch p = patch(wi);
  return {interpolate(p), pdf(p)};
}

LightSample Environment::sample(const V2f& u) const {
  if (constant()) {
    const float y = 1.0f - 2.0f * u.y, longitude = 2.0f * kPi * u.x;
    const float sine = std::sqrt(std::max(0.0f, 1.0f - y * y));
    return {.wi = V3f(sine * std::cos(longitude), y, sine * std::sin(longitude)),
            .radiance = texel(0, 0),
            .pdf = 0.25f * kInvPi,
            .distance = std::numeric_limits<float>::infinity()};
  }
  const int width = image_.width, height = image_.height;
  const auto row = rows_->sample(u.y);
  const auto column = in_row_[row.index].sample(u.x);
  Patch p;
  p.row = row.index;
  p.column = column.index;
  p.x0 = static_cast<int>(column.index);
  p.x1 = (p.x0 + 1) % width;
  p.y0 = std::max(static_cast<int>(row.index) - 1, 0);
  p.y1 = std::min(static_cast<int>(row.index), height - 1);
  const Corners target = corners(p);
  const auto [a, b, c, d] = target;
  // At a pole the patch is half as high, and the light does not change along it.
  float y = sample_linear(row.offset, a + b, c + d);
  if (row.index == 0) y = 0.5f + 0.5f * y;
  if (row.index == static_cast<std::size_t>(height)) y *= 0.5f;
  const float x = sample_linear(column.offset, a + (c - a) * y, b + (d - b) * y);
  p.position = V2f(x, y);

  const float longitude =
      2.0f * kPi * ((static_cast<float>(p.x0) + 0.5f + x) / static_cast<float>(width) - 0.5f);
  const float colatitude =
      kPi * (static_cast<float>(row.index) - 0.5f + y) / static_cast<float>(height);
  p.sine = std::max(0.0f, std::sin(colatitude));
  const float east = p.sine * std::sin(longitude), south = -p.sine * std::cos(longitude);

  LightSample sample;
  sample.wi =
      V3f(cosine_ * east + sine_ * south, std::cos(colatitude), cosine_ * south - sine_ * east);
  sample.radiance = interpolate(p);
  sample.pdf = density(p, target, row.probability * column.probability);
  sample.distance = std::numeric_limits<float>::infinity();
  return sample;
}

}  // namespace morsel::render
