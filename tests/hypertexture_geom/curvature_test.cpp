// SPDX-License-Identifier: Apache-2.0
// Curvature against closed forms on spheres, ellipsoids and tori, and against differences of the
// normal on a hypertexture.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "hypertexture_geom/field/curvature.h"
#include "hypertexture_geom/field/field.h"
#include "tests/hypertexture_geom/eq13.h"

namespace morsel::geom {
namespace {

using topology::Jet;

// Jet of a function given by its second-order derivatives; the fields of the densities are smoothed
// and so differ a little from the closed forms.
Jet sphere_jet(const Imath::V3d& x, double r) {
  Jet j;  // (r^2 - |x|^2) / 2
  j.value = 0.5 * (r * r - x.length2());
  j.gradient = -x;
  j.hessian[0] = j.hessian[1] = j.hessian[2] = -1.0;
  return j;
}

TEST(Curvature, Sphere) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (const double r : {1e-6, 0.3, 1.0, 7.0, 1e6})
    for (int i = 0; i < 20; ++i) {
      const Imath::V3d x = Imath::V3d(normal(random), normal(random), normal(random)).normalized();
      const Curvature c = curvature(sphere_jet(x * r, r));
      EXPECT_NEAR(c.mean * r, 1.0, 1e-13);
      EXPECT_NEAR(c.gaussian * r * r, 1.0, 1e-13);
      EXPECT_NEAR(c.largest() * r, 1.0, 1e-6);
      EXPECT_NEAR(c.smallest() * r, 1.0, 1e-6);
    }
}

TEST(Curvature, TheOtherSideIsNegative) {
  Jet j = sphere_jet({2, 0, 0}, 2);
  j.gradient = -j.gradient;
  for (double& h : j.hessian) h = -h;
  EXPECT_NEAR(curvature(j).mean, -0.5, 1e-15);
  EXPECT_NEAR(curvature(j).gaussian, 0.25, 1e-15);
}

// F = 1 - x^2/a^2 - y^2/b^2 - z^2/c^2, and a rotation about (1, 1, 1) by 120 degrees, so that no
// axis is special. K = 1 / (a b c h)^2 with h^2 = x^2/a^4 + y^2/b^4 + z^2/c^4 and H = (|x|^2 - a^2
// - b^2 - c^2) / (2 (a b c)^2 h^3), negative of the outward sign (do Carmo, section 3-3).
TEST(Curvature, Ellipsoid) {
  const double a = 0.7, b = 1.3, c = 2.1;
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    const double theta = std::acos(2.0 * u(random) - 1.0), phi = 2.0 * std::numbers::pi * u(random);
    const Imath::V3d x(a * std::sin(theta) * std::cos(phi), b * std::sin(theta) * std::sin(phi),
                       c * std::cos(theta));
    Jet j;
    j.gradient = -2.0 * Imath::V3d(x.x / (a * a), x.y / (b * b), x.z / (c * c));
    j.hessian[0] = -2.0 / (a * a);
    j.hessian[1] = -2.0 / (b * b);
    j.hessian[2] = -2.0 / (c * c);
    const double h2 =
        x.x * x.x / std::pow(a, 4) + x.y * x.y / std::pow(b, 4) + x.z * x.z / std::pow(c, 4);
    const double gaussian = 1.0 / (a * a * b * b * c * c * h2 * h2);
    const double mean =
        (a * a + b * b + c * c - x.length2()) / (2.0 * a * a * b * b * c * c * std::pow(h2, 1.5));
    const Curvature k = curvature(j);
    EXPECT_NEAR(k.gaussian, gaussian, 1e-12 * gaussian);
    EXPECT_NEAR(k.mean, mean, 1e-12 * mean);
    EXPECT_NEAR(k.largest() * k.smallest(), gaussian, 1e-9);
    // Any scale of F has the same level sets.
    for (double& v : j.hessian) v *= 1e3;
    j.gradient *= 1e3;
    EXPECT_NEAR(curvature(j).mean, mean, 1e-12 * mean);
  }
}

// On the torus density of the scenes, whose smoothing is far below the tolerance here. Radii R, r,
// angle v about the tube: k1 = 1 / r, k2 = cos v / (R + r cos v).
TEST(Curvature, Torus) {
  const double big = 1.0, small = 0.3;
  const auto field = field_from_json({{"density",
                                       {{"type", "torus"},
                                        {"axis", {0.3, 0.5, 1.0}},
                                        {"major_radius", big},
                                        {"minor_radius", small},
                                        {"smoothing", 1e-5}}}},
                                     {"torus", ""});
  const Imath::V3d axis = Imath::V3d(0.3, 0.5, 1.0).normalized();
  const Imath::V3d e1 = axis.cross({1, 0, 0}).normalized(), e2 = axis.cross(e1);
  for (int i = 0; i < 24; ++i)
    for (int k = 0; k < 24; ++k) {
      const double phi = i * std::numbers::pi / 12, v = k * std::numbers::pi / 12;
      const Imath::V3d spoke = e1 * std::cos(phi) + e2 * std::sin(phi);
      const Imath::V3d x = spoke * (big + small * std::cos(v)) + axis * (small * std::sin(v));
      const double k1 = 1.0 / small, k2 = std::cos(v) / (big + small * std::cos(v));
      const Curvature c = curvature(field->jet(x));
      EXPECT_NEAR(c.mean, 0.5 * (k1 + k2), 1e-6);
      EXPECT_NEAR(c.gaussian, k1 * k2, 1e-6);
      EXPECT_NEAR(c.largest(), k1, 1e-6);
      EXPECT_NEAR(c.smallest(), k2, 1e-6);
    }
}

// The shape operator by differences: the normal's change along two tangents.
TEST(Curvature, HypertextureByDifferencesOfTheNormal) {
  const auto field = test::eq13(2).field;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const Imath::V3d x = Imath::V3d(normal(random), normal(random), normal(random)).normalized();
    const Jet j = field->jet(x);
    if (j.gradient.length() < 0.3) continue;
    const auto n = [&](const Imath::V3d& p) { return -field->jet(p).gradient.normalized(); };
    const Imath::V3d m = n(x);
    const Imath::V3d t1 = m.cross(std::abs(m.x) < 0.5 ? Imath::V3d(1, 0, 0) : Imath::V3d(0, 1, 0))
                              .normalized(),
                     t2 = m.cross(t1);
    const double h = 1e-5;
    const Imath::V3d d1 = (n(x + t1 * h) - n(x - t1 * h)) / (2.0 * h);
    const Imath::V3d d2 = (n(x + t2 * h) - n(x - t2 * h)) / (2.0 * h);
    const double s11 = d1.dot(t1), s12 = d1.dot(t2), s21 = d2.dot(t1), s22 = d2.dot(t2);
    const Curvature c = curvature(j);
    const double scale = 1.0 + std::abs(s11) + std::abs(s22) + std::abs(s12);
    EXPECT_NEAR(c.mean, 0.5 * (s11 + s22), 1e-6 * scale * scale);
    EXPECT_NEAR(c.gaussian, s11 * s22 - s12 * s21, 1e-5 * scale * scale);
  }
}

TEST(Curvature, NoTangentPlaneGivesZero) {
  Jet j;
  j.hessian[0] = 3.0;
  EXPECT_EQ(curvature(j).mean, 0.0);
  EXPECT_EQ(curvature(j).gaussian, 0.0);
}

}  // namespace
}  // namespace morsel::geom
