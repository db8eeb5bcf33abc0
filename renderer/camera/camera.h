// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>

#include "renderer/math/vector.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Pinhole camera over an image of width x height pixels; (0, 0) is the top left corner of the
// image, y grows downwards.
class Camera {
 public:
  // Throws std::invalid_argument for a view direction without length, a field of view outside
  // (0, 180) degrees or an empty image. An `up` parallel to the view is replaced by another axis.
  Camera(const PerspectiveCamera& camera, int width, int height);

  // Unit direction through image position (x, y) in pixels: pixel (i, j) spans [i, i+1) x [j, j+1).
  V3f direction(float x, float y) const {
    return normalize(corner_ + right_step_ * x + down_step_ * y);
  }
  const V3f& position() const { return position_; }
  const V3f& forward() const { return forward_; }  // unit; the axis that Z is measured along

  // Row-vector matrices (p' = p * M) as EXR headers have them. Camera space looks along -z.
  Imath::M44f world_to_camera() const;
  // Maps the view frustum to x, y in [-1, 1] after division by w; z is depth, see kNear, kFar.
  Imath::M44f world_to_ndc() const;

  static constexpr float kNear = 0.01f, kFar = 10000.0f;

 private:
  V3f position_, right_, up_, forward_;
  V3f corner_, right_step_, down_step_;  // of the image plane at distance 1
  float tan_half_fov_, aspect_;
};

}  // namespace morsel::render
