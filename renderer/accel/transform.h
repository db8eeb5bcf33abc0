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
  // Outward normals stay outward under mirroring: n (M^-1)^T, normalised.
  V3d normal_to_world(const V3d& n) const;

  // A bound on how far (in world lengths) the point where Embree's traversal takes a world point
  // `p` to be in object space lies from where it is: the rounding of the matrix, of its inverse and
  // of the product.
  float world_error(const V3f& p) const { return error_scale_ * (max_abs(p) + translation_); }
  // The same in object lengths.
  float object_error(const V3f& p) const { return world_error(p) * inverse_norm_; }

  // A length in object space is at most this long in the world.
  double object_to_world_length(double length) const { return length * norm_; }

  // And the other way.
  float object_length(float world_length) const { return world_length * inverse_norm_; }

  // The twelve floats of RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR.
  const float* columns() const { return columns_; }

 private:
  Imath::M44d to_world_, to_object_;
  float columns_[12];
  float error_scale_, translation_, inverse_norm_;
  double norm_;
};

}  // namespace morsel::render
