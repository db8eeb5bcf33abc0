// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>

#include "renderer/accel/interaction.h"
#include "renderer/math/vector.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Camera over an image of width x height pixels; (0, 0) is the top left corner of the image, y
// grows downwards. Perspective or orthographic, both with a thin lens if wanted, or spherical: a
// latitude-longitude image of all directions with the view in its middle.
class Camera {
 public:
  // Throws std::invalid_argument for a view direction without length, a field of view outside
  // (0, 180) degrees or an empty image. An `up` parallel to the view is replaced by another axis.
  Camera(const SceneCamera& camera, int width, int height);

  // The ray through image position (x, y) in pixels: pixel (i, j) spans [i, i+1) x [j, j+1).
  // `lens` and `time` are random numbers in [0, 1). The direction is a unit vector.
  Ray ray(float x, float y, const V2f& lens, float time) const;
  // Whether rays depend on these.
  bool has_lens() const { return aperture_radius_ > 0.0f; }
  bool has_shutter() const { return shutter_close_ > shutter_open_; }
  // Of the pinhole.
  V3f direction(float x, float y) const { return ray(x, y, V2f(0.5f), 0.0f).direction; }
  // Angle that a pixel covers, and at orthographic projection its width instead: how wide a ray's
  // footprint is after t is width + angle * t.
  float pixel_angle() const { return pixel_angle_; }
  float pixel_width() const { return pixel_width_; }

  const V3f& position() const { return position_; }
  const V3f& forward() const { return forward_; }  // unit; the axis that Z is measured along
  // Z of a point: along the axis, or the distance in the spherical projection.
  float depth(const V3f& p) const {
    const V3f d = p - position_;
    return projection_ == Projection::kSpherical ? std::sqrt(dot(d, d)) : dot(d, forward_);
  }

  // Row-vector matrices (p' = p * M) as EXR headers have them. Camera space looks along -z.
  Imath::M44f world_to_camera() const;
  // Maps the view frustum to x, y in [-1, 1] after division by w; z is depth, see kNear, kFar. Of
  // the spherical projection there is none: that of a perspective of 90 degrees.
  Imath::M44f world_to_ndc() const;

  static constexpr float kNear = 0.01f, kFar = 10000.0f;

 private:
  V2f lens_point(const V2f& u) const;

  Projection projection_;
  V3f position_, right_, up_, forward_;
  V3f corner_, right_step_, down_step_;  // of the image plane at distance 1
  float tan_half_fov_, aspect_, half_height_;
  float width_, height_;  // pixels
  float aperture_radius_, focus_distance_;
  int blades_;
  float blade_rotation_;  // radians
  float shutter_open_, shutter_close_;
  float pixel_angle_, pixel_width_;
};

}  // namespace morsel::render
