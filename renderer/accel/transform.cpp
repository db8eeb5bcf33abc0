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

  // Rounding M perturbs its inverse N by up to eps |N||M||N|, and so does inverting in float, to
  // within a small factor; multiplying adds eps |N| for each operation. 8 is about twice the count.
  const auto absolute = [](const Imath::M44d& a, int i, int j) { return std::abs(a[i][j]); };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = absolute(to_object_, i, j);
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l)
          sum += absolute(to_object_, i, k) * absolute(m, k, l) * absolute(to_object_, l, j);
      error_[i][j] = 8.0 * 0x1p-24 * sum;
    }
  translation_ = V3d(absolute(m, 3, 0), absolute(m, 3, 1), absolute(m, 3, 2));
  inverse_norm_ = std::sqrt(3.0) * norm(to_object_);
  mean_scale_ = static_cast<float>(std::cbrt(std::abs(to_object_.determinant())));
}

}  // namespace morsel::render
