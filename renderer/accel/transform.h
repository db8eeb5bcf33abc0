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

  V3d point_to_world(const V3d& p) const { return p * to_world_; }
  V3d point_to_object(const V3d& p) const { return p * to_object_; }
  // Outward normals stay outward under mirroring: n (M^-1)^T, normalised. `stretch` is the length
  // before that: how much distances along the normal grow on the way from the world to the object.
  V3d normal_to_world(const V3d& n, double& stretch) const;
  V3d normal_to_world(const V3d& n) const {
    double stretch;
    return normal_to_world(n, stretch);
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
  Imath::M44d to_world_, to_object_;
  float columns_[12];
  V3d translation_;  // absolute values
  V3d error_[3];     // rows: error of the object coordinates for each unit of a world coordinate
  double inverse_norm_;
  float mean_scale_;
};

}  // namespace morsel::render
