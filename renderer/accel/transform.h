// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>

#include <string>

#include "renderer/math/vector.h"

namespace morsel::render {

// An affine map between an instance's object space and the world, with bounds on what Embree, which
// works in float, makes of it.
class InstanceTransform {
 public:
  // Row vectors: p' = p * m. Throws std::invalid_argument naming the instance when `m` is not
  // finite, not affine or not invertible.
  InstanceTransform(const Imath::M44d& m, const std::string& name);

  V3d point_to_world(const V3d& p) const { return transformed(p, to_world_); }
  V3d point_to_object(const V3d& p) const { return transformed(p, to_object_); }
  // Outward normals stay outward under mirroring: n (M^-1)^T, normalised. `length` is the length
  // before that; over that of n it is how much distances along the normal grow on the way from the
  // world to the object.
  V3d normal_to_world(const V3d& n, double& length) const {
    const Imath::M44d& i = to_object_;
    const V3d w(n.x * i[0][0] + n.y * i[0][1] + n.z * i[0][2],
                n.x * i[1][0] + n.y * i[1][1] + n.z * i[1][2],
                n.x * i[2][0] + n.y * i[2][1] + n.z * i[2][2]);
    length = std::sqrt(w.dot(w));
    return w * (1.0 / length);
  }
  V3d normal_to_world(const V3d& n) const {
    double length;
    return normal_to_world(n, length);
  }

  // Bounds, for each object-space coordinate, on how far off Embree's traversal takes a world point
  // to be in object space: by the rounding of the matrix, of its inverse and of the product.
  V3d object_error(const V3f& p) const {
    const V3d a(std::abs(p.x) + translation_.x, std::abs(p.y) + translation_.y,
                std::abs(p.z) + translation_.z);
    return a.x * error_[0] + a.y * error_[1] + a.z * error_[2];
  }
  // Length in object space of a world length of 1, of a mean direction.
  float mean_scale() const { return mean_scale_; }
  // A length in the world is at most this long in object space.
  double object_length(double world_length) const { return world_length * inverse_norm_; }

  // The twelve floats of RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR.
  const float* columns() const { return columns_; }

 private:
  // Imath's product divides by the last column, which is that of an affine map here.
  static V3d transformed(const V3d& p, const Imath::M44d& m) {
    return {p.x * m[0][0] + p.y * m[1][0] + p.z * m[2][0] + m[3][0],
            p.x * m[0][1] + p.y * m[1][1] + p.z * m[2][1] + m[3][1],
            p.x * m[0][2] + p.y * m[1][2] + p.z * m[2][2] + m[3][2]};
  }

  Imath::M44d to_world_, to_object_;
  float columns_[12];
  V3d translation_;  // absolute values
  V3d error_[3];     // rows: error of the object coordinates for each unit of a world coordinate
  double inverse_norm_;
  float mean_scale_;
};

}  // namespace morsel::render
