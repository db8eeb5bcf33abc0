// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/transform.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace morsel::render {
namespace {

// Counter-clockwise about coordinate axis `axis`; right angles are exact, so that a scene turned by
// 90 degrees has no rounding in its normals.
Imath::M44d rotation(int axis, double degrees) {
  const double turn = std::fmod(degrees, 360.0);
  double c = std::cos(turn * std::numbers::pi / 180), s = std::sin(turn * std::numbers::pi / 180);
  if (std::fmod(turn, 90.0) == 0) {
    c = std::round(c);
    s = std::round(s);
  }
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  Imath::M44d m;
  m[i][i] = c;
  m[i][j] = s;
  m[j][i] = -s;
  m[j][j] = c;
  return m;
}

}  // namespace

Imath::M44d make_transform(const Imath::V3d& scale, const Imath::V3d& rotate_degrees,
                           const Imath::V3d& translate) {
  Imath::M44d m;
  for (int axis = 0; axis < 3; ++axis) m[axis][axis] = scale[axis];
  for (int axis = 0; axis < 3; ++axis) m *= rotation(axis, rotate_degrees[axis]);
  for (int axis = 0; axis < 3; ++axis) m[3][axis] = translate[axis];
  return m;
}

Imath::M44d read_transform(const nlohmann::json& rows, const params::Place& place) {
  Imath::M44d m;
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c)
      m[static_cast<int>(c)][static_cast<int>(r)] = rows[r][c].get<double>();
  if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
    (place / std::size_t{3}).fail("must be 0 0 0 1: projections are not supported");
  if (!is_invertible(m)) place.fail("has no inverse: it flattens the geometry");
  return m;
}

}  // namespace morsel::render
