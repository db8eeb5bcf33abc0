// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>

#include <array>
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
  V3d vector_to_world(const V3d& v) const {
    const auto& m = to_world_;
    return {v.x * m[0][0] + v.y * m[1][0] + v.z * m[2][0],
            v.x * m[0][1] + v.y * m[1][1] + v.z * m[2][1],
            v.x * m[0][2] + v.y * m[1][2] + v.z * m[2][2]};
  }
  // Outward normals stay outward under mirroring: n (M^-1)^T, not normalised. Its length over that
  // of n is how much distances along the normal grow on the way from the world to the object.
  V3d normal_direction(const V3d& n) const {
    const auto& i = to_object_;
    return {n.x * i[0][0] + n.y * i[0][1] + n.z * i[0][2],
            n.x * i[1][0] + n.y * i[1][1] + n.z * i[1][2],
            n.x * i[2][0] + n.y * i[2][1] + n.z * i[2][2]};
  }
  V3d normal_to_world(const V3d& n) const {
    const V3d w = normal_direction(n);
    return w * (1.0 / std::sqrt(w.dot(w)));
  }

  // Bounds, for each object-space coordinate, on how far off Embree's traversal takes a world point
  // to be in object space: by the rounding of the matrix, of its inverse and of the product.
  V3d object_error(const V3f& p) const {
    const auto term = [&](int j) {
      const double x = double{std::abs(p.x)} + double{translation_[0]},
                   y = double{std::abs(p.y)} + double{translation_[1]},
                   z = double{std::abs(p.z)} + double{translation_[2]};
      return x * double{error_[0][j]} + y * double{error_[1][j]} + z * double{error_[2][j]};
    };
    return {term(0), term(1), term(2)};
  }
  // Length in object space of a world length of 1, of a mean direction.
  float mean_scale() const { return mean_scale_; }
  // A length in the world is at most this long in object space.
  double object_length(double world_length) const { return world_length * inverse_norm_; }

  // RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR.
  std::array<float, 12> columns() const;

 private:
  // Affine: three columns, which is all that hits have to fetch.
  using Affine = double[4][3];
  static V3d transformed(const V3d& p, const Affine& m) {
    return {p.x * m[0][0] + p.y * m[1][0] + p.z * m[2][0] + m[3][0],
            p.x * m[0][1] + p.y * m[1][1] + p.z * m[2][1] + m[3][1],
            p.x * m[0][2] + p.y * m[1][2] + p.z * m[2][2] + m[3][2]};
  }

  Affine to_world_;
  // Rounded up. Rows: error of the object coordinates for each unit of a world coordinate, and the
  // absolute values of the translation.
  float error_[3][3], translation_[3];
  float mean_scale_;
  Affine to_object_;
  double inverse_norm_;
};

}  // namespace morsel::render
