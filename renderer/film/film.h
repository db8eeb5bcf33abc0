// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "renderer/film/cryptomatte.h"
#include "renderer/math/vector.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Depth of pixels that see nothing: finite, so that differences of images stay finite.
inline constexpr float kFarDepth = 1e10f;

// A colour for each light group; black. (Imath's vectors are not initialised by themselves.)
struct GroupColors : std::array<V3f, kMaxLightGroups> {
  GroupColors() { fill(V3f(0.0f)); }
};

// What one path brings to its pixel.
struct PathSample {
  V3f radiance{0.0f};
  GroupColors groups;  // the part of `radiance` of each light group
  float alpha = 0.0f;  // 1: something is there, 0: not
  V3f albedo{0.0f};    // of the first vertex that is not a mirror or clear glass, in [0, 1]
  V3f normal{0.0f};    // there, unit, world space, towards the viewer; 0 when nothing is hit
  // Of the first hit:
  float depth = kFarDepth;                                       // along the camera's axis
  V3f position{0.0f};                                            // in the world
  V3f geometric_normal{0.0f};                                    // unit, towards the viewer
  std::uint32_t instance = 0xffffffffu, material = 0xffffffffu;  // none: a light, or nothing
  float component = 0.0f;  // 1 + id of the hypertexture component, 0 for anything else
  float steps = 0.0f;      // evaluations that its search took
};

// A finished pixel.
struct Pixel {
  V3f color{0.0f};  // mean radiance
  float alpha = 0.0f;
  V3f albedo{0.0f};
  V3f normal{0.0f};    // mean of unit normals: shorter than 1 across edges
  V3f variance{0.0f};  // of `color`: the samples' variance / their number (for independent samples)
  // Means of depths or ids would be of nothing that exists: these are those of the sample nearest
  // to the pixel's centre.
  float depth = kFarDepth;
  float component = 0.0f;
  V3f position{0.0f};
  V3f geometric_normal{0.0f};
  float steps = 0.0f;  // mean
  std::uint32_t samples = 0;
};

// Mean of the samples of one pixel, in their order; the filter is in where they are.
class PixelAccumulator {
 public:
  // `x`, `y`: position relative to the pixel's corner, beyond [0, 1) under wide filters. Non-finite
  // radiance must not come here.
  void add(const PathSample& sample, float x, float y);
  Pixel result() const;
  V3f group(std::uint32_t i) const { return groups_[i] * scale(); }
  // Luminance of the brightest sample, and whether it alone is more than half of the pixel (of 16
  // samples or more).
  float brightest() const { return brightest_; }
  bool firefly() const {
    return samples_ >= 16 &&
           brightest_ > 0.5f * luminance(V3f(color_)) * static_cast<float>(samples_);
  }
  // Mean luminance, and the variance of a single sample's.
  double mean_luminance() const { return luminance_mean_; }
  double luminance_variance() const {
    return samples_ > 1 ? luminance_deviation_ / (samples_ - 1.0) : 0.0;
  }

 private:
  float scale() const { return samples_ > 0 ? 1.0f / static_cast<float>(samples_) : 0.0f; }

  Imath::V3d color_{0.0}, squared_deviation_{0.0};  // Welford's mean and sum
  double luminance_mean_ = 0.0, luminance_deviation_ = 0.0;
  GroupColors groups_;
  float brightest_ = 0.0f, steps_ = 0.0f;
  V3f position_{0.0f}, geometric_normal_{0.0f};
  V3f albedo_{0.0f}, normal_{0.0f};
  float alpha_ = 0.0f;
  float depth_ = kFarDepth, component_ = 0.0f;
  float nearest_ = std::numeric_limits<float>::infinity();
  std::uint32_t samples_ = 0;
};

// The pixels of a window of the full image. Different pixels may be written by different threads.
class Film {
 public:
  // Throws std::invalid_argument when the crop is empty or not inside the full image.
  explicit Film(const RenderSettings& settings, std::size_t light_groups = 0);

  int full_width() const { return full_width_; }
  int full_height() const { return full_height_; }
  const Crop& window() const { return window_; }
  int width() const { return window_.x1 - window_.x0; }
  int height() const { return window_.y1 - window_.y0; }

  // `x`, `y` in pixels of the full image, within window().
  Pixel& at(int x, int y) { return pixels_[offset(x, y)]; }
  const Pixel& at(int x, int y) const { return pixels_[offset(x, y)]; }

  // Light groups.
  std::size_t group_count() const { return groups_.size(); }
  V3f& group(std::size_t i, int x, int y) { return groups_[i][offset(x, y)]; }
  const V3f& group(std::size_t i, int x, int y) const { return groups_[i][offset(x, y)]; }

  // ID mattes, in the order of enum Matte; none unless the settings ask for them.
  std::size_t matte_count() const { return mattes_.size(); }
  cryptomatte::Ranks& matte(std::size_t i, int x, int y) { return mattes_[i][offset(x, y)]; }
  const cryptomatte::Ranks& matte(std::size_t i, int x, int y) const {
    return mattes_[i][offset(x, y)];
  }
  // Instances and components that samples met, for the mattes' manifest. To be added by one thread
  // at a time.
  using Components = std::set<std::pair<std::uint32_t, std::uint32_t>>;
  void add_components(const Components& seen) { components_.insert(seen.begin(), seen.end()); }
  const Components& seen_components() const { return components_; }

 private:
  std::size_t offset(int x, int y) const {
    return static_cast<std::size_t>(y - window_.y0) * static_cast<std::size_t>(width()) +
           static_cast<std::size_t>(x - window_.x0);
  }

  int full_width_, full_height_;
  Crop window_;
  std::vector<Pixel> pixels_;
  std::vector<std::vector<V3f>> groups_;
  std::vector<std::vector<cryptomatte::Ranks>> mattes_;
  Components components_;
};

}  // namespace morsel::render
