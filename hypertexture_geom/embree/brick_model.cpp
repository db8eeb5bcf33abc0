// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/brick_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hypertexture_geom/embree/ray_cubic.h"

namespace morsel::geom {
namespace {

using namespace topology::monomial;

// Powers of x, y, z in each monomial.
constexpr int kPowers[kCount][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0},
                                    {0, 2, 0}, {0, 0, 2}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1},
                                    {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {2, 1, 0}, {2, 0, 1},
                                    {1, 2, 0}, {0, 2, 1}, {1, 0, 2}, {0, 1, 2}, {1, 1, 1}};

// Errors are held as floats, rounded up; what is not finite becomes "nothing is known", large
// enough to exclude nothing and small enough to compute with.
constexpr double kNothingKnown = 1e30;
float rounded_up(double x) {
  if (!(x < kNothingKnown)) x = kNothingKnown;
  const auto f = static_cast<float>(x);
  return f >= x ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

struct Cubic1 {
  double b[4];
};

// Coefficients in powers of u on [-1, 1] to Bernstein's.
Cubic1 bernstein(double a0, double a1, double a2, double a3) {
  const double even = a0 + a2, odd = a1 + a3, inner = a0 - a2 / 3.0, odd_inner = a1 / 3.0 - a3;
  return {{even - odd, inner - odd_inner, inner + odd_inner, even + odd}};
}

// The blossom of a cubic on [0, 1]; with its arguments among s and t, the Bernstein coefficients of
// the part [s, t].
double blossom(const Cubic1& p, double r, double s, double t) {
  const auto mix = [](double a, double b, double x) { return a + (b - a) * x; };
  const double a = mix(p.b[0], p.b[1], r), b = mix(p.b[1], p.b[2], r), c = mix(p.b[2], p.b[3], r);
  const double d = mix(a, b, s), e = mix(b, c, s);
  return mix(d, e, t);
}
double least_on(const Cubic1& p, double s, double t) {
  return std::min(std::min(blossom(p, s, s, s), blossom(p, s, s, t)),
                  std::min(blossom(p, s, t, t), blossom(p, t, t, t)));
}
double greatest_on(const Cubic1& p, double s, double t) {
  return std::max(std::max(blossom(p, s, s, s), blossom(p, s, s, t)),
                  std::max(blossom(p, s, t, t), blossom(p, t, t, t)));
}

// Slices of the box that may hold zeros of P + error, axis by axis: of the tensor of Bernstein
// coefficients the extremes over two axes bound P by two cubics in the third.
void find_slices(Brick& brick) {
  double power[4][4][4] = {};
  for (int m = 0; m < kCount; ++m)
    power[kPowers[m][0]][kPowers[m][1]][kPowers[m][2]] = static_cast<double>(brick.c[m]);
  const auto transform = [](double& a0, double& a1, double& a2, double& a3) {
    const Cubic1 p = bernstein(a0, a1, a2, a3);
    a0 = p.b[0], a1 = p.b[1], a2 = p.b[2], a3 = p.b[3];
  };
  for (auto& plane : power)
    for (auto& line : plane) transform(line[0], line[1], line[2], line[3]);
  for (auto& plane : power)
    for (int k = 0; k < 4; ++k) transform(plane[0][k], plane[1][k], plane[2][k], plane[3][k]);
  for (int j = 0; j < 4; ++j)
    for (int k = 0; k < 4; ++k)
      transform(power[0][j][k], power[1][j][k], power[2][j][k], power[3][j][k]);
  const auto error = static_cast<double>(brick.value_error);
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Cubic1 lower{{kInfinity, kInfinity, kInfinity, kInfinity}};
    Cubic1 upper{{-kInfinity, -kInfinity, -kInfinity, -kInfinity}};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 4; ++k) {
          const int at = axis == 0 ? i : axis == 1 ? j : k;
          lower.b[at] = std::min(lower.b[at], power[i][j][k]);
          upper.b[at] = std::max(upper.b[at], power[i][j][k]);
        }
    const auto is_free = [&](int slice) {
      const double s = slice / static_cast<double>(Brick::kSlices);
      const double t = (slice + 1) / static_cast<double>(Brick::kSlices);
      return least_on(lower, s, t) > error || greatest_on(upper, s, t) < -error;
    };
    int lo = 0, hi = Brick::kSlices;
    while (lo < hi - 1 && is_free(lo)) ++lo;
    while (hi > lo + 1 && is_free(hi - 1)) --hi;
    brick.surface_lo[axis] = static_cast<std::uint8_t>(lo);
    brick.surface_hi[axis] = static_cast<std::uint8_t>(hi);
  }
}

}  // namespace

void set_model(Brick& brick, const topology::LocalModel& model, const Imath::V3d& half) {
  double sum = 0.0, rounding_of_c = 0.0;
  for (int m = 0; m < kCount; ++m) {
    double scale = 1.0;
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < kPowers[m][axis]; ++k) scale *= half[axis];
    const double c = model.c[static_cast<std::size_t>(m)] * scale;
    brick.c[m] = static_cast<float>(c);
    rounding_of_c += std::abs(static_cast<double>(brick.c[m]) - c);
    sum += std::abs(c);
  }
  double gradient_error = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    gradient_error = std::max(gradient_error, model.gradient_error[axis] * half[axis]);
  const double largest = std::max({half.x, half.y, half.z});
  const double hessian_error = model.hessian_error * largest * largest;
  if (!std::isfinite(sum) || !(sum < kNothingKnown)) {
    std::fill(std::begin(brick.c), std::end(brick.c), 0.0f);
    sum = rounding_of_c = kNothingKnown;
  }
  // Rounding of the coefficients counts up to three and six times in the derivatives.
  const double rounding = sum * static_cast<double>(kRayCubicRounding) + rounding_of_c;
  brick.rounding = rounded_up(rounding);
  brick.value_error = rounded_up(model.value_error + rounding);
  brick.gradient_error = rounded_up(gradient_error + 3.0 * rounding_of_c);
  brick.hessian_error = rounded_up(hessian_error + 6.0 * rounding_of_c);
  find_slices(brick);
}

}  // namespace morsel::geom
