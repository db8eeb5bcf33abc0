// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/math/vector.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Depth of pixels that see nothing: finite, so that differences of images stay finite.
inline constexpr float kFarDepth = 1e10f;

// What one path brings to its pixel.
struct PathSample {
  V3f radiance{0.0f};
  float alpha = 0.0f;       // 1: something is there, 0: not
  V3f albedo{0.0f};         // of the first vertex that is not a mirror or clear glass, in [0, 1]
  V3f normal{0.0f};         // there, unit, world space, towards the viewer; 0 when nothing is hit
  float depth = kFarDepth;  // of the first hit along the camera's axis
  float component = 0.0f;   // 1 + id of the hypertexture component first hit, 0 for anything else
};

// A finished pixel.
struct Pixel {
  V3f color{0.0f};  // mean radiance
  float alpha = 0.0f;
  V3f albedo{0.0f};
  V3f normal{0.0f};    // mean of unit normals: shorter than 1 across edges
  V3f variance{0.0f};  // of `color`: the samples' variance / their number (for independent samples)
  float depth = kFarDepth;  // means of depths or ids would be of nothing that exists: these two
  float component = 0.0f;   // are those of the sample nearest to the pixel's centre
  std::uint32_t samples = 0;
};

// Box filter over one pixel, in the order of the samples.
class PixelAccumulator {
 public:
  // `x`, `y`: position in the pixel, [0, 1)^2. Non-finite radiance must not come here.
  void add(const PathSample& sample, float x, float y);
  Pixel result() const;

 private:
  Imath::V3d color_{0.0}, squared_deviation_{0.0};  // Welford's mean and sum
  V3f albedo_{0.0f}, normal_{0.0f};
  float alpha_ = 0.0f;
  float depth_ = kFarDepth, component_ = 0.0f, nearest_ = 2.0f;
  std::uint32_t samples_ = 0;
};

// The pixels of a window of the full image. Different pixels may be written by different threads.
class Film {
 public:
  // Throws std::invalid_argument when the crop is empty or not inside the full image.
  explicit Film(const RenderSettings& settings);

  int full_width() const { return full_width_; }
  int full_height() const { return full_height_; }
  const Crop& window() const { return window_; }
  int width() const { return window_.x1 - window_.x0; }
  int height() const { return window_.y1 - window_.y0; }

  // `x`, `y` in pixels of the full image, within window().
  Pixel& at(int x, int y) { return pixels_[offset(x, y)]; }
  const Pixel& at(int x, int y) const { return pixels_[offset(x, y)]; }

 private:
  std::size_t offset(int x, int y) const {
    return static_cast<std::size_t>(y - window_.y0) * static_cast<std::size_t>(width()) +
           static_cast<std::size_t>(x - window_.x0);
  }

  int full_width_, full_height_;
  Crop window_;
  std::vector<Pixel> pixels_;
};

}  // namespace morsel::render
