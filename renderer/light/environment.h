// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "renderer/light/environment_texels.h"
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
// sample is brighter than about twice the mean. (Tables choose a block of four patches; among these
// it is the texels that decide, which are read anyway.)
//
// Where other samples (of BSDFs) look after the even part of the light, the sampling density need
// only follow what stands out: with `only_highlights` the mean luminance is taken off it, which
// lowers the noise of the combination (Karlik et al., "MIS Compensation", 2019). The density is
// then 0 where there is light: not for use without MIS.
class Environment {
 public:
  Environment(const EnvironmentImage& image, const V3f& scale, float rotation_degrees,
              bool only_highlights = false);

  V3f radiance(const V3f& wi) const { return radiance(patch(wi)); }
  LightSample sample(const V2f& u) const {
    Place p;
    place(u, p);
    fetch(p);
    LightSample s;
    sample(p, s);
    return s;
  }
  float pdf(const V3f& wi) const;
  // radiance() and pdf() at once, which is less work than one after the other.
  struct Arriving {
    V3f radiance;
    float pdf;
  };
  Arriving arriving(const V3f& wi) const { return arriving(patch(wi)); }
  // The same in two steps, between which what the second needs of memory is fetched.
  struct Patch {         // that a direction falls into, and where in it
    int column = 0;      // of the texels to the left
    int row = 0;         // see EnvironmentTexels
    V2f position{0.0f};  // between the texels, [0, 1]^2
    float sine = 0.0f;   // of the angle to the +y axis
  };
  Patch patch(const V3f& wi) const {
    Patch p;
    find(wi, p);
    return p;
  }
  void find(const V3f& wi, Patch& patch) const;
  V3f radiance(const Patch& patch) const;
  Arriving arriving(const Patch& patch) const;
  // sample() in three steps, between which what the next one needs of memory is fetched.
  struct Place {
    DistributionRows::Cell row{}, block{};
    V2f u{0.0f};
  };
  void place(const V2f& u, Place& place) const;
  void fetch(Place& place) const;
  void sample(const Place& place, LightSample& sample) const;  // a new one
  // Mean over all directions of the luminance that sample() follows. 0: nothing to sample.
  float sampled_luminance() const { return sampled_luminance_; }

 private:
  // One texel: the same everywhere, sampled uniformly.
  bool constant() const { return constant_.has_value(); }
  using Floats = EnvironmentTexels::Floats;
  // What sampling follows, of four texels before scaling. Not a table of its own: wherever it is
  // asked for, the texels are wanted too, and fetching from memory is what costs here.
  Floats targets(const EnvironmentTexels::Corners& texels) const;
  // Per solid angle, of a point in the patch.
  float density(const Patch& patch, const Floats& target) const;

  EnvironmentTexels texels_;
  V3f scale_;               // radiance of a texel of 1
  V3f luminance_of_texel_;  // of each channel of one
  std::optional<V3f> constant_;
  float not_sampled_ = 0.0f;                // luminance that is left to other samples
  float sine_, cosine_;                     // of the rotation
  std::optional<DistributionRows> in_row_;  // height + 1, among the row's blocks
  std::optional<Distribution1D> rows_;
  std::vector<float> density_;  // by row: times target over sine gives the density
  float sampled_luminance_ = 0.0f;
};

}  // namespace morsel::render
