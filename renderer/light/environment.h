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
// Radiance is interpolated bilinearly, and sampled by exactly that: a patch between four texels'
// centres is chosen by its mean luminance times its solid angle, then a point in it with density
// proportional to the interpolated luminance. So wherever there is light it is sampled, and no
// sample is brighter than about twice the mean.
class Environment {
 public:
  Environment(EnvironmentImage image, const V3f& scale, float rotation_degrees);

  V3f radiance(const V3f& wi) const;
  LightSample sample(const V2f& u) const;
  float pdf(const V3f& wi) const;
  // Mean over all directions.
  const V3f& mean_radiance() const { return mean_; }

 private:
  // The patch that a direction falls into and where in it.
  struct Patch {
    int x0, x1;    // columns of texels, wrapped around
    int y0, y1;    // rows, equal at the poles
    V2f position;  // between them, [0, 1]^2
    float sine;    // of the angle to the +y axis
    // Index of the patch: column x0 and row 0 .. height, the first and the last being the halves
    // between a pole and the nearest texels' centres.
    std::size_t row, column;
  };
  // One texel: the same everywhere, sampled uniformly.
  bool constant() const { return image_.texels.size() == 1; }
  Patch patch(const V3f& wi) const;
  V3f interpolate(const Patch& patch) const;
  // Density in the patch's unit square times the number of patches over the solid angle of all.
  float density(const Patch& patch, float probability) const;
  const V3f& texel(int x, int y) const {
    return image_.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) +
                         static_cast<std::size_t>(x)];
  }

  EnvironmentImage image_;              // already scaled
  float sine_, cosine_;                 // of the rotation
  std::vector<Distribution1D> in_row_;  // height + 1
  std::optional<Distribution1D> rows_;
  V3f mean_;
};

}  // namespace morsel::render
