// SPDX-License-Identifier: Apache-2.0
#include "renderer/camera/camera.h"

#include <fmt/format.h>

#include <stdexcept>

namespace morsel::render {

Camera::Camera(const PerspectiveCamera& camera, int width, int height)
    : position_(camera.position) {
  if (width < 1 || height < 1)
    throw std::invalid_argument(fmt::format("camera: image of {} x {} pixels", width, height));
  if (!(camera.vertical_fov > 0.0f && camera.vertical_fov < 180.0f))
    throw std::invalid_argument(fmt::format(
        "camera: vertical_fov is {} degrees; valid are 0 < fov < 180", camera.vertical_fov));
  // Double precision: a camera far away that looks at something near it keeps its direction.
  const V3d view = V3d(camera.look_at) - V3d(camera.position);
  if (!(view.length2() > 0.0) || !std::isfinite(view.length2()))
    throw std::invalid_argument("camera: position and look_at must be finite and different points");
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
  aspect_ = static_cast<float>(width) / static_cast<float>(height);
  const double tangent = std::tan(0.5 * camera.vertical_fov * 3.14159265358979323846 / 180.0);
  tan_half_fov_ = static_cast<float>(tangent);
  const double pixel = 2.0 * tangent / height;  // pixels are square
  right_step_ = V3f(right * pixel);
  down_step_ = V3f(up * -pixel);
  corner_ = V3f(forward - right * (0.5 * pixel * width) + up * tangent);
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
  const Imath::M44f projection(1.0f / (tan_half_fov_ * aspect_), 0, 0, 0, 0, 1.0f / tan_half_fov_,
                               0, 0, 0, 0, a, -1.0f, 0, 0, b, 0);
  return world_to_camera() * projection;
}

}  // namespace morsel::render
