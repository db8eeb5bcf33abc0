// SPDX-License-Identifier: Apache-2.0
#include "renderer/accel/transform.h"

#include <fmt/format.h>

#include <stdexcept>

namespace morsel::render {
namespace {

// Largest sum of absolute values over the inputs of one output coordinate.
double norm(const Imath::M44d& m) {
  double largest = 0.0;
  for (int j = 0; j < 3; ++j)
    largest = std::max(largest, std::abs(m[0][j]) + std::abs(m[1][j]) + std::abs(m[2][j]));
  return largest;
}

}  // namespace

InstanceTransform::InstanceTransform(const Imath::M44d& m, const std::string& name) : to_world_(m) {
  const auto fail = [&](const char* what) {
    throw std::invalid_argument(fmt::format("instance '{}': its transform is {}", name, what));
  };
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      if (!std::isfinite(m[i][j])) fail("not finite");
  if (m[0][3] != 0.0 || m[1][3] != 0.0 || m[2][3] != 0.0 || m[3][3] != 1.0)
    fail("not affine (its last column must be 0, 0, 0, 1)");
  const double scale = norm(m);
  if (!(std::abs(m.determinant()) > 1e-18 * scale * scale * scale)) fail("not invertible");
  to_object_ = m.inverse();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j) columns_[3 * i + j] = static_cast<float>(m[i][j]);

  const double inverse_norm = norm(to_object_);
  // Each of the matrix, its inverse (computed by cofactors) and the products rounds a handful of
  // times; an error in object space comes back multiplied by the norm of the matrix. 16 roundings
  // are about twice what a count of the operations gives.
  const double condition = std::max(1.0, scale * inverse_norm);
  error_scale_ = static_cast<float>(16.0 * 0x1p-24 * condition);
  translation_ = max_abs(V3f(V3d(m[3][0], m[3][1], m[3][2])));
  inverse_norm_ = static_cast<float>(inverse_norm);
  norm_ = std::sqrt(3.0) * scale;
}

V3d InstanceTransform::normal_to_world(const V3d& n) const {
  const Imath::M44d& i = to_object_;
  const V3d w(n.x * i[0][0] + n.y * i[0][1] + n.z * i[0][2],
              n.x * i[1][0] + n.y * i[1][1] + n.z * i[1][2],
              n.x * i[2][0] + n.y * i[2][1] + n.z * i[2][2]);
  return w / std::sqrt(w.dot(w));
}

}  // namespace morsel::render
