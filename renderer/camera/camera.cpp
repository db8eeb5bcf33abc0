// SPDX-License-Identifier: Apache-2.0
#include "renderer/camera/camera.h"

#include <fmt/format.h>

#include <stdexcept>

#include "renderer/math/warp.h"

namespace morsel::render {

Camera::Camera(const SceneCamera& camera, int width, int height)
    : projection_(camera.projection),
      position_(camera.position),
      width_(static_cast<float>(width)),
      height_(static_cast<float>(height)),
      aperture_radius_(camera.aperture_radius),
      blades_(camera.blades),
      blade_rotation_(camera.blade_rotation * (kPi / 180.0f)),
      shutter_open_(camera.shutter_open),
      shutter_close_(camera.shutter_close) {
  if (width < 1 || height < 1)
    throw std::invalid_argument(fmt::format("camera: image of {} x {} pixels", width, height));
  if (!(camera.vertical_fov > 0.0f && camera.vertical_fov < 180.0f))
    throw std::invalid_argument(fmt::format(
        "camera: vertical_fov is {} degrees; valid are 0 < fov < 180", camera.vertical_fov));
  if (!(camera.height > 0.0f) || !(camera.aperture_radius >= 0.0f))
    throw std::invalid_argument("camera: its height must be positive, its aperture not negative");
  if (!(camera.shutter_open >= 0.0f && camera.shutter_open <= camera.shutter_close &&
        camera.shutter_close <= 1.0f))
    throw std::invalid_argument("camera: the shutter must open before it closes, within [0, 1]");
  // Double precision: a camera far away that looks at something near it keeps its direction.
  const V3d view = V3d(camera.look_at) - V3d(camera.position);
  if (!(view.length2() > 0.0) || !std::isfinite(view.length2()))
    throw std::invalid_argument("camera: position and look_at must be finite and different points");
  focus_distance_ =
      camera.focus_distance > 0.0f ? camera.focus_distance : static_cast<float>(view.length());
  const V3d forward = view.normalized();
  V3d right = forward.cross(V3d(camera.up));
  if (!(right.length() > 1e-6 * V3d(camera.up).length())) {
    const V3d other = std::abs(forward.z) < 0.9 ? V3d(0, 0, 1) : V3d(0, 1, 0);
    right = forward.cross(other);
  }
  right.normalize();
  const V3d up = right.cross(forward);

  forward_ = V3f(forward);
  right_ = V3f(right);
  up_ = V3f(up);
  aspect_ = width_ / height_;
  const double tangent = std::tan(0.5 * camera.vertical_fov * 3.14159265358979323846 / 180.0);
  tan_half_fov_ = static_cast<float>(tangent);
  half_height_ = 0.5f * camera.height;
  const bool perspective = projection_ != Projection::kOrthographic;
  const double half = perspective ? tangent : half_height_;
  const double pixel = 2.0 * half / height;  // pixels are square
  right_step_ = V3f(right * pixel);
  down_step_ = V3f(up * -pixel);
  const V3d corner = up * half - right * (0.5 * pixel * width);
  corner_ = perspective ? V3f(forward + corner) : V3f(corner);
  pixel_width_ = perspective ? 0.0f : static_cast<float>(pixel);
  pixel_angle_ = perspective ? static_cast<float>(pixel) : 0.0f;
  if (projection_ == Projection::kSpherical) pixel_angle_ = kPi / height_;
}

// On the unit disk, or in the regular polygon in it.
V2f Camera::lens_point(const V2f& u) const {
  if (blades_ < 3) return square_to_disk(u);
  const auto n = static_cast<float>(blades_);
  const float scaled = u.x * n;
  const float edge = std::min(std::floor(scaled), n - 1.0f);
  const float root = std::sqrt(scaled - edge);
  const float a = 2.0f * kPi * edge / n + blade_rotation_, b = a + 2.0f * kPi / n;
  const V2f first(std::cos(a), std::sin(a)), second(std::cos(b), std::sin(b));
  return first * (root * (1.0f - u.y)) + second * (root * u.y);
}

Ray Camera::ray(float x, float y, const V2f& lens, float time) const {
  Ray ray;
  ray.time = shutter_open_ + time * (shutter_close_ - shutter_open_);
  ray.origin = position_;
  if (projection_ == Projection::kSpherical) {
    const float longitude = 2.0f * kPi * (x / width_ - 0.5f), latitude = kPi * (0.5f - y / height_);
    ray.direction =
        normalize(forward_ * (std::cos(latitude) * std::cos(longitude)) +
                  right_ * (std::cos(latitude) * std::sin(longitude)) + up_ * std::sin(latitude));
    return ray;
  }
  const V3f in_plane = corner_ + right_step_ * x + down_step_ * y;
  V3f focus;  // relative to position_
  if (projection_ == Projection::kOrthographic) {
    ray.origin += in_plane;
    ray.direction = forward_;
    focus = in_plane + forward_ * focus_distance_;
  } else {
    ray.direction = normalize(in_plane);
    focus = in_plane * focus_distance_;
  }
  if (aperture_radius_ > 0.0f) {
    const V2f l = lens_point(lens) * aperture_radius_;
    const V3f offset = right_ * l.x + up_ * l.y;
    const V3f start = ray.origin - position_ + offset;
    ray.direction = normalize(focus - start);
    ray.origin += offset;
  }
  return ray;
}

Imath::M44f Camera::world_to_camera() const {
  const V3f& r = right_;
  const V3f& u = up_;
  const V3f& f = forward_;
  return {r.x,
          u.x,
          -f.x,
          0.0f,
          r.y,
          u.y,
          -f.y,
          0.0f,
          r.z,
          u.z,
          -f.z,
          0.0f,
          -dot(position_, r),
          -dot(position_, u),
          dot(position_, f),
          1.0f};
}

Imath::M44f Camera::world_to_ndc() const {
  const float a = (kFar + kNear) / (kNear - kFar), b = 2.0f * kFar * kNear / (kNear - kFar);
  if (projection_ == Projection::kOrthographic) {
    const Imath::M44f projection(1.0f / (half_height_ * aspect_), 0, 0, 0, 0, 1.0f / half_height_,
                                 0, 0, 0, 0, 2.0f / (kNear - kFar), 0, 0, 0,
                                 (kFar + kNear) / (kNear - kFar), 1);
    return world_to_camera() * projection;
  }
  const Imath::M44f projection(1.0f / (tan_half_fov_ * aspect_), 0, 0, 0, 0, 1.0f / tan_half_fov_,
                               0, 0, 0, 0, a, -1.0f, 0, 0, b, 0);
  return world_to_camera() * projection;
}

}  // namespace morsel::render
