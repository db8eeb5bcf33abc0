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

  double total_weight = 0.0;
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
  return p;
}

Environment::Corners<V3f> Environment::texels(const Patch& p) const {
  return {texel(p.x0, p.y0), texel(p.x1, p.y0), texel(p.x0, p.y1), texel(p.x1, p.y1)};
}

Environment::Corners<float> Environment::targets(const Corners<V3f>& texels) const {
  return {target_of(texels.a), target_of(texels.b), target_of(texels.c), target_of(texels.d)};
}

// The chance of a patch is its mean times its row's solid angle, and the density within it is the
// target over that mean: the mean cancels, and no table of probabilities is asked.
float Environment::density(const Patch& p, const Corners<float>& target) const {
  return p.sine > 0.0f ? target.at(p.position) * density_[p.row] / p.sine : 0.0f;
}

V3f Environment::radiance(const V3f& wi) const {
  const Patch p = patch(wi);
  return texels(p).at(p.position);
}

float Environment::pdf(const V3f& wi) const { return arriving(wi).pdf; }

Environment::Arriving Environment::arriving(const V3f& wi) const {
  if (constant()) return {texel(0, 0), 0.25f * kInvPi};
  const Patch p = patch(wi);
  const Corners<V3f> around = texels(p);
  return {around.at(p.position), density(p, targets(around))};
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
  p.x0 = static_cast<int>(column.index);
  p.x1 = (p.x0 + 1) % width;
  p.y0 = std::max(static_cast<int>(row.index) - 1, 0);
  p.y1 = std::min(static_cast<int>(row.index), height - 1);
  const Corners<V3f> around = texels(p);
  const Corners<float> target = targets(around);
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
  sample.radiance = around.at(p.position);
  sample.pdf = density(p, target);
  sample.distance = std::numeric_limits<float>::infinity();
  return sample;
}

}  // namespace morsel::render
