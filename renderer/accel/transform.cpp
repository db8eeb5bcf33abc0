// SPDX-License-Identifier: Apache-2.0
#include "renderer/accel/transform.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
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

// A float that is not below x >= 0, nor denormal, for threads that trace take those for 0; infinite
// beyond the largest one.
float rounded_up(double x) {
  if (x > 0.0 && x < double{std::numeric_limits<float>::min()})
    return std::numeric_limits<float>::min();
  const auto nearest = static_cast<float>(x);
  return double{nearest} >= x ? nearest
                              : std::nextafter(nearest, std::numeric_limits<float>::infinity());
}

}  // namespace

InstanceTransform::InstanceTransform(const Imath::M44d& m, const std::string& name) {
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
  const Imath::M44d inverse = m.inverse();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j) {
      to_world_[i][j] = m[i][j];
      to_object_[i][j] = inverse[i][j];
    }

  // Rounding M perturbs its inverse N by up to eps |N||M||N|, and so does inverting in float, to
  // within a small factor; multiplying adds eps |N| for each operation. 8 is about twice the count.
  const auto absolute = [](const Imath::M44d& a, int i, int j) { return std::abs(a[i][j]); };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = absolute(inverse, i, j);
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l)
          sum += absolute(inverse, i, k) * absolute(m, k, l) * absolute(inverse, l, j);
      error_[i][j] = rounded_up(8.0 * 0x1p-24 * sum);
    }
  for (int j = 0; j < 3; ++j) translation_[j] = rounded_up(absolute(m, 3, j));
  inverse_norm_ = std::sqrt(3.0) * norm(inverse);
  mean_scale_ = static_cast<float>(std::cbrt(std::abs(inverse.determinant())));
}

std::array<float, 12> InstanceTransform::columns() const {
  std::array<float, 12> c{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 3; ++j) c[3 * i + j] = static_cast<float>(to_world_[i][j]);
  return c;
}

}  // namespace morsel::render
