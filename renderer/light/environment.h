// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/math/distribution.h"
#include "renderer/math/vector.h"

namespace morsel::render {

// A lat-long image, top row first. Texels are finite and >= 0.
struct EnvironmentImage {
  int width = 1, height = 1;
  std::vector<V3f> texels{V3f(1.0f)};

  // Reads any image that OpenImageIO reads, as linear RGB (one channel is grey). Negative and
  // non-finite texels become 0. Throws std::runtime_error that names the file.
  static EnvironmentImage read(const std::string& file);
};

struct LightSample {
  V3f wi{0.0f};        // unit, towards the light
  V3f radiance{0.0f};  // that arrives from there if nothing is in between
  float pdf = 0.0f;    // per solid angle; 0: no sample
  float distance = 0;  // to the light's point; infinite for the environment
};

// Light from infinitely far away. The image's centre is seen along -z, its right half towards +x,
// its top row towards +y; a rotation of r degrees turns it about +y by the right-hand rule (seen
// from above: counter-clockwise).
//
// Radiance is interpolated bilinearly. Directions are sampled texel by texel with the mean of the
// interpolated luminance over the texel times its solid angle, uniformly within, so wherever there
// is light it is sampled and the ratio of the two stays bounded.
class Environment {
 public:
  Environment(EnvironmentImage image, const V3f& scale, float rotation_degrees);

  V3f radiance(const V3f& wi) const;
  LightSample sample(const V2f& u) const;
  float pdf(const V3f& wi) const;
  // Mean over all directions.
  const V3f& mean_radiance() const { return mean_; }

 private:
  V2f image_position(const V3f& wi) const;  // in texels, x in [0, width], y in [0, height]
  V3f interpolate(const V2f& position) const;
  const V3f& texel(int x, int y) const {
    return image_.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) +
                         static_cast<std::size_t>(x)];
  }

  EnvironmentImage image_;     // already scaled
  float sine_, cosine_;        // of the rotation
  std::vector<double> row_z_;  // cosine of the angle to +y at the rows' upper edges; height + 1
  std::vector<Distribution1D> in_row_;
  std::optional<Distribution1D> rows_;
  V3f mean_;
};

}  // namespace morsel::render
