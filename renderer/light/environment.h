// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "renderer/light/light.h"
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

// Light from infinitely far away. The image's centre is seen along -z, its right half towards +x,
// its top row towards +y; a rotation of r degrees turns it about +y by the right-hand rule (seen
// from above: counter-clockwise).
//
// Radiance is interpolated bilinearly, and sampled by exactly that: a patch between four texels'
// centres is chosen by its mean luminance times its solid angle, then a point in it with density
// proportional to the interpolated luminance. So wherever there is light it is sampled, and no
// sample is brighter than about twice the mean.
//
// Where other samples (of BSDFs) look after the even part of the light, the sampling density need
// only follow what stands out: with `only_highlights` the mean luminance is taken off it, which
// lowers the noise of the combination (Karlik et al., "MIS Compensation", 2019). The density is
// then 0 where there is light: not for use without MIS.
class Environment {
 public:
  Environment(EnvironmentImage image, const V3f& scale, float rotation_degrees,
              bool only_highlights = false);

  V3f radiance(const V3f& wi) const;
  LightSample sample(const V2f& u) const;
  float pdf(const V3f& wi) const;
  // radiance() and pdf() at once, which is less work than one after the other.
  struct Arriving {
    V3f radiance;
    float pdf;
  };
  Arriving arriving(const V3f& wi) const;
  // Mean over all directions of the luminance that sample() follows. 0: nothing to sample.
  float sampled_luminance() const { return sampled_luminance_; }

 private:
  // The patch that a direction falls into and where in it.
  struct Patch {
    int x0, x1;    // columns of texels, wrapped around
    int y0, y1;    // rows, equal at the poles
    V2f position;  // between them, [0, 1]^2
    float sine;    // of the angle to the +y axis
    // 0 .. height, the first and the last being the halves between a pole and the nearest texels'
    // centres. The column is x0.
    std::size_t row;
  };
  // One texel: the same everywhere, sampled uniformly.
  bool constant() const { return image_.texels.size() == 1; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) +
           static_cast<std::size_t>(x);
  }
  Patch patch(const V3f& wi) const;
  // What sampling follows, of a texel. Not a table of its own: wherever it is asked for, the texel
  // is wanted too, and fetching from memory is what costs here.
  float target_of(const V3f& texel) const {
    return std::max(0.0f, luminance(texel) - not_sampled_);
  }
  // Of the four texels about a patch.
  template <typename T>
  struct Corners {
    T a, b, c, d;  // upper left and right, lower left and right
    T at(const V2f& p) const {
      return (a * (1.0f - p.x) + b * p.x) * (1.0f - p.y) + (c * (1.0f - p.x) + d * p.x) * p.y;
    }
  };
  Corners<V3f> texels(const Patch& patch) const;
  Corners<float> targets(const Corners<V3f>& texels) const;
  // Per solid angle, of a point in the patch.
  float density(const Patch& patch, const Corners<float>& target) const;
  const V3f& texel(int x, int y) const { return image_.texels[index(x, y)]; }

  EnvironmentImage image_;              // already scaled
  float not_sampled_ = 0.0f;            // luminance that is left to other samples
  float sine_, cosine_;                 // of the rotation
  std::vector<Distribution1D> in_row_;  // height + 1
  std::optional<Distribution1D> rows_;
  std::vector<float> density_;  // by row: times target over sine gives the density
  float sampled_luminance_ = 0.0f;
};

}  // namespace morsel::render
