// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/environment.h"

#include <limits>
#include <stdexcept>

namespace morsel::render {

Environment::Environment(EnvironmentImage image, const V3f& scale, float rotation_degrees)
    : image_(std::move(image)) {
  const int width = image_.width, height = image_.height;
  if (width < 1 || height < 1 ||
      image_.texels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw std::invalid_argument("environment: an image needs width x height texels");
  for (V3f& t : image_.texels) t *= scale;
  const float rotation = rotation_degrees * (kPi / 180.0f);
  sine_ = std::sin(rotation);
  cosine_ = std::cos(rotation);

  row_z_.resize(static_cast<std::size_t>(height) + 1);
  for (int y = 0; y <= height; ++y)
    row_z_[static_cast<std::size_t>(y)] = std::cos(3.14159265358979323846 * y / height);
  row_z_.front() = 1.0;
  row_z_.back() = -1.0;

  std::vector<double> row_weight(static_cast<std::size_t>(height));
  std::vector<double> weight(static_cast<std::size_t>(width));
  V3d sum(0.0);
  for (int y = 0; y < height; ++y) {
    const double solid_angle = row_z_[static_cast<std::size_t>(y)] -
                               row_z_[static_cast<std::size_t>(y) + 1];  // times 2 pi / width
    const int rows[3] = {std::max(y - 1, 0), y, std::min(y + 1, height - 1)};
    double total = 0.0;
    for (int x = 0; x < width; ++x) {
      // The mean of a bilinear interpolation over a texel weighs neighbours 1 : 6 : 1 an axis.
      const int columns[3] = {(x + width - 1) % width, x, (x + 1) % width};
      constexpr double kTent[3] = {0.125, 0.75, 0.125};
      double mean = 0.0;
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i)
          mean += kTent[i] * kTent[j] * luminance(texel(columns[i], rows[j]));
      weight[static_cast<std::size_t>(x)] = mean;
      total += mean;
      sum += V3d(texel(x, y)) * solid_angle;
    }
    in_row_.emplace_back(weight);
    row_weight[static_cast<std::size_t>(y)] = total * solid_angle;
  }
  rows_.emplace(row_weight);
  mean_ = V3f(sum / (2.0 * width));
}

V2f Environment::image_position(const V3f& wi) const {
  const float x = cosine_ * wi.x - sine_ * wi.z;
  const float z = sine_ * wi.x + cosine_ * wi.z;
  const float longitude = std::atan2(x, -z);  // (-pi, pi], 0 along -z
  const float colatitude = std::acos(std::clamp(wi.y, -1.0f, 1.0f));
  return {(0.5f + longitude * (0.5f * kInvPi)) * static_cast<float>(image_.width),
          colatitude * kInvPi * static_cast<float>(image_.height)};
}

V3f Environment::interpolate(const V2f& position) const {
  const float x = position.x - 0.5f, y = position.y - 0.5f;  // texels' centres are at integers
  const float fx = std::floor(x), fy = std::floor(y);
  const float tx = x - fx, ty = y - fy;
  const int width = image_.width, height = image_.height;
  const int x0 = (static_cast<int>(fx) + width) % width, x1 = (x0 + 1) % width;
  const int y0 = std::clamp(static_cast<int>(fy), 0, height - 1);
  const int y1 = std::clamp(static_cast<int>(fy) + 1, 0, height - 1);
  const V3f upper = texel(x0, y0) * (1.0f - tx) + texel(x1, y0) * tx;
  const V3f lower = texel(x0, y1) * (1.0f - tx) + texel(x1, y1) * tx;
  return upper * (1.0f - ty) + lower * ty;
}

V3f Environment::radiance(const V3f& wi) const { return interpolate(image_position(wi)); }

float Environment::pdf(const V3f& wi) const {
  const V2f p = image_position(wi);
  const int x = std::min(static_cast<int>(p.x), image_.width - 1);
  const int y = std::min(static_cast<int>(p.y), image_.height - 1);
  const auto row = static_cast<std::size_t>(y);
  const auto solid_angle = static_cast<float>((row_z_[row] - row_z_[row + 1]) * 2.0 * kPi);
  return rows_->probability(row) * in_row_[row].probability(static_cast<std::size_t>(x)) *
         static_cast<float>(image_.width) / solid_angle;
}

LightSample Environment::sample(const V2f& u) const {
  const auto row = rows_->sample(u.y);
  const auto column = in_row_[row.index].sample(u.x);
  const double top = row_z_[row.index], bottom = row_z_[row.index + 1];
  const auto y = static_cast<float>(top + (bottom - top) * row.offset);
  const float s =
      (static_cast<float>(column.index) + column.offset) / static_cast<float>(image_.width);
  const float longitude = 2.0f * kPi * (s - 0.5f);
  const float radius = std::sqrt(std::max(0.0f, 1.0f - y * y));
  const float x = radius * std::sin(longitude), z = -radius * std::cos(longitude);

  LightSample sample;
  sample.wi = V3f(cosine_ * x + sine_ * z, y, cosine_ * z - sine_ * x);
  sample.radiance = radiance(sample.wi);
  sample.pdf = row.probability * column.probability * static_cast<float>(image_.width) /
               static_cast<float>((top - bottom) * 2.0 * kPi);
  sample.distance = std::numeric_limits<float>::infinity();
  return sample;
}

}  // namespace morsel::render
