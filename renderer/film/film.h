// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "renderer/film/cryptomatte.h"
#include "renderer/film/pixel.h"
#include "renderer/film/ray_counts.h"

namespace morsel::render {

// The pixels to render: the crop or everything. Throws std::invalid_argument when the crop is empty
// or not inside the full image.
Crop window_of(const RenderSettings& settings);

// The finished pixels of a window of the full image. Different pixels may be written by different
// threads.
class Film {
 public:
  // Throws what window_of() throws.
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
  // For the mattes' manifest. To be added by one thread at a time.
  void add_components(const SeenComponents& seen) { components_.insert(seen.begin(), seen.end()); }
  const SeenComponents& seen_components() const { return components_; }

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
  SeenComponents components_;
};

}  // namespace morsel::render
