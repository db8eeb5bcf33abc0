// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/sky.h"

#include <array>

namespace morsel::render {
namespace {

constexpr int kWidth = 512, kHeight = 256;

// One of the paper's three quantities: Perez's five coefficients, linear in turbidity.
struct Perez {
  double a, b, c, d, e;
  double operator()(double cos_theta, double gamma, double cos_gamma) const {
    return (1.0 + a * std::exp(b / std::max(cos_theta, 0.01))) *
           (1.0 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
  }
};

struct Model {
  std::array<Perez, 3> perez;    // Y, x, y
  std::array<double, 3> zenith;  // kcd/m^2, chromaticity
  double sun_angle;              // from the zenith

  Model(double turbidity, double angle) : sun_angle(angle) {
    const double t = turbidity;
    perez[0] = {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251,
                0.1206 * t - 2.5771, -0.0670 * t + 0.3703};
    perez[1] = {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125,
                -0.0641 * t - 0.8989, -0.0033 * t + 0.0452};
    perez[2] = {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102,
                -0.0441 * t - 1.6537, -0.0109 * t + 0.0529};
    const double chi = (4.0 / 9.0 - t / 120.0) * (3.14159265358979323846 - 2.0 * angle);
    zenith[0] = std::max(0.0, (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192);
    const double s = angle, s2 = s * s, s3 = s2 * s;
    zenith[1] = t * t * (0.00166 * s3 - 0.00375 * s2 + 0.00209 * s) +
                t * (-0.02903 * s3 + 0.06377 * s2 - 0.03202 * s + 0.00394) +
                (0.11693 * s3 - 0.21196 * s2 + 0.06052 * s + 0.25886);
    zenith[2] = t * t * (0.00275 * s3 - 0.00610 * s2 + 0.00317 * s) +
                t * (-0.04214 * s3 + 0.08970 * s2 - 0.04153 * s + 0.00516) +
                (0.15346 * s3 - 0.26756 * s2 + 0.06670 * s + 0.26688);
  }
  double value(std::size_t i, double cos_theta, double gamma, double cos_gamma) const {
    const double reference = perez[i](1.0, sun_angle, std::cos(sun_angle));
    return zenith[i] * perez[i](cos_theta, gamma, cos_gamma) / reference;
  }
};

// Linear Rec. 709 of CIE xyY.
V3f rgb_of(double x, double y, double luminance_y) {
  const double s = luminance_y / std::max(y, 1e-6);
  const double cx = x * s, cz = (1.0 - x - y) * s, cy = luminance_y;
  return {static_cast<float>(std::max(0.0, 3.2406 * cx - 1.5372 * cy - 0.4986 * cz)),
          static_cast<float>(std::max(0.0, -0.9689 * cx + 1.8758 * cy + 0.0415 * cz)),
          static_cast<float>(std::max(0.0, 0.0557 * cx - 0.2040 * cy + 1.0570 * cz))};
}

double radians(double degrees) { return degrees * 3.14159265358979323846 / 180.0; }

// Towards the sun; azimuth 0 is -z, the middle of an environment image, 90 is +x.
V3d direction_of_sun(const SkyLight& sky) {
  const double elevation = radians(sky.sun_elevation), azimuth = radians(sky.sun_azimuth);
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
          -std::cos(elevation) * std::cos(azimuth)};
}

}  // namespace

EnvironmentImage sky_image(const SkyLight& sky) {
  const V3d sun = direction_of_sun(sky);
  const Model model(sky.turbidity, radians(90.0 - std::max(0.0f, sky.sun_elevation)));
  EnvironmentImage image;
  image.width = kWidth;
  image.height = kHeight;
  image.texels.assign(static_cast<std::size_t>(kWidth) * kHeight, V3f(0.0f));
  V3d irradiance(0.0);
  for (int row = 0; row < kHeight / 2; ++row) {
    const double theta = 3.14159265358979323846 * (row + 0.5) / kHeight;
    const double solid_angle =
        2.0 * 3.14159265358979323846 / kWidth * 3.14159265358979323846 / kHeight * std::sin(theta);
    for (int column = 0; column < kWidth; ++column) {
      const double longitude = 2.0 * 3.14159265358979323846 * ((column + 0.5) / kWidth - 0.5);
      const V3d w(std::sin(theta) * std::sin(longitude), std::cos(theta),
                  -std::sin(theta) * std::cos(longitude));
      const double cos_gamma = std::clamp(w.dot(sun), -1.0, 1.0), gamma = std::acos(cos_gamma);
      const V3f color =
          rgb_of(model.value(1, w.y, gamma, cos_gamma), model.value(2, w.y, gamma, cos_gamma),
                 std::max(0.0, model.value(0, w.y, gamma, cos_gamma))) *
          0.1f;
      image.texels[static_cast<std::size_t>(row) * kWidth + static_cast<std::size_t>(column)] =
          color;
      irradiance += V3d(color) * (w.y * solid_angle);
    }
  }
  // The ground, lit by sky and sun.
  const DistantLight direct = sun_of(sky);
  irradiance += V3d(direct.irradiance) * std::max(0.0, sun.y);
  const V3f ground = sky.ground_color * V3f(irradiance) * kInvPi;
  for (std::size_t i = static_cast<std::size_t>(kWidth) * (kHeight / 2); i < image.texels.size();
       ++i)
    image.texels[i] = ground;
  return image;
}

DistantLight sun_of(const SkyLight& sky) {
  DistantLight light;
  light.name = "sun";
  light.direction = -V3f(direction_of_sun(sky));
  light.angular_diameter = sky.sun_diameter;
  light.irradiance = V3f(0.0f);
  if (sky.sun_elevation <= 0.0f) return light;
  const double zenith = radians(90.0 - sky.sun_elevation);
  const double mass =
      1.0 / (std::cos(zenith) + 0.15 * std::pow(93.885 - (90.0 - sky.sun_elevation), -1.253));
  const double beta = std::max(0.0, 0.04608 * sky.turbidity - 0.04586);
  const double micrometres[] = {0.630, 0.532, 0.465};
  for (int i = 0; i < 3; ++i) {
    const double rayleigh = std::exp(-mass * 0.008735 * std::pow(micrometres[i], -4.08));
    const double aerosols = std::exp(-mass * beta * std::pow(micrometres[i], -1.3));
    light.irradiance[i] = static_cast<float>(12.8 * rayleigh * aerosols);
  }
  return light;
}

}  // namespace morsel::render
