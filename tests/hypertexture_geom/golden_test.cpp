// SPDX-License-Identifier: Apache-2.0
// Values of the noises that must never change, on any machine: every cache and picture depends on
// them. After a deliberate change of the field the files are written anew with
// MORSEL_UPDATE_GOLDEN=1 in the environment.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iomanip>

#include "hypertexture_geom/field/impulse_process.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

// 64 places that no lattice plane or symmetry is special for.
Imath::V3d place(int i) {
  return {-2.1 + 0.0731 * i, 1.9 - 0.0617 * i, -0.7 + 0.0293 * i + 0.001 * i * i};
}

void check_golden(const nlohmann::json& description, const std::string& name) {
  const auto field = testing::field_of(description);
  const std::string path = std::string(MORSEL_SOURCE_DIR) + "/tests/data/golden/" + name + ".txt";
  if (std::getenv("MORSEL_UPDATE_GOLDEN") != nullptr) {
    std::ofstream out(path);
    out << std::setprecision(17);
    for (int i = 0; i < 64; ++i) out << field->value(place(i)) << "\n";
  }
  std::ifstream in(path);
  ASSERT_TRUE(in.good()) << path;
  for (int i = 0; i < 64; ++i) {
    double expected = 0.0;
    ASSERT_TRUE(in >> expected) << path << " line " << i + 1;
    EXPECT_NEAR(field->value(place(i)), expected, 1e-13) << path << " line " << i + 1;
  }
}

TEST(Golden, SparseConvolution) {
  check_golden(testing::eq13_json(1, 1), "sparse_convolution_l1");
  check_golden(testing::eq13_json(4, 12345), "sparse_convolution_l4");
}

TEST(Golden, Perlin) {
  check_golden(testing::perlin_json(1, 1, 0.8, 4.0), "perlin_l1");
  check_golden(testing::perlin_json(4, 12345), "perlin_l4");
}

TEST(Golden, ImpulseProcessIsExact) {
  const CellImpulse a = cell_impulse(0, 0, 0, 0, 0, 0);
  const CellImpulse b = cell_impulse(-5, 1000000, 7, 2, 3, 42);
  // Multiples of 2^-32 and 2^-31, so equality is exact.
  EXPECT_EQ(a.x, 0x1.db3f9778p-1);
  EXPECT_EQ(a.weight, -0x1.1f07a94p-4);
  EXPECT_EQ(b.y, 0x1.0d0fd0b4p-2);
  EXPECT_EQ(b.z, 0x1.763540ap-5);
}

TEST(ImpulseProcess, IsUniformAndUncorrelated) {
  // Means and correlations of 120,000 impulses: within 5 standard errors of a uniform process.
  double mean[4] = {}, cross = 0.0, neighbour = 0.0;
  int n = 0;
  for (int i = -10; i < 10; ++i)
    for (int j = 0; j < 20; ++j)
      for (int k = 0; k < 100; ++k)
        for (std::uint32_t m = 0; m < 3; ++m, ++n) {
          const CellImpulse c = cell_impulse(i, j, k, m, 0, 7),
                            d = cell_impulse(i + 1, j, k, m, 0, 7);
          mean[0] += c.x - 0.5;
          mean[1] += c.y - 0.5;
          mean[2] += c.z - 0.5;
          mean[3] += c.weight;
          cross += (c.x - 0.5) * c.weight;
          neighbour += c.weight * d.weight;
        }
  const double root = std::sqrt(static_cast<double>(n));
  for (int axis = 0; axis < 3; ++axis) EXPECT_LT(std::abs(mean[axis]) / n, 5.0 * 0.2887 / root);
  EXPECT_LT(std::abs(mean[3]) / n, 5.0 * 0.5774 / root);
  EXPECT_LT(std::abs(cross) / n, 5.0 * 0.2887 * 0.5774 / root);
  EXPECT_LT(std::abs(neighbour) / n, 5.0 / 3.0 / root);
}

}  // namespace
}  // namespace morsel::geom
