// SPDX-License-Identifier: Apache-2.0
#include "renderer/sampler/sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "renderer/math/distribution.h"
#include "tests/renderer/statistics.h"

namespace morsel::render {
namespace {

TEST(Sobol, SecondDimensionIsTheVanDerCorputPascalSequence) {
  // The first eight points of the second Sobol dimension, in eighths.
  const unsigned expected[8] = {0, 4, 6, 2, 5, 1, 3, 7};
  for (unsigned i = 0; i < 8; ++i)
    EXPECT_EQ(reverse_bits(sobol_second_reversed(i)) >> 29, expected[i]) << i;
}

TEST(Sobol, OwenScrambleIsABijectionThatKeepsAlignedBlocks) {
  for (const std::uint32_t seed : {0u, 1u, 0xdeadbeefu, 0x80000000u})
    for (int k = 0; k <= 10; ++k) {
      std::set<std::uint32_t> images;
      const std::uint32_t block = owen_shuffle(0, seed) >> k;
      for (std::uint32_t i = 0; i < (1u << k); ++i) {
        const std::uint32_t image = owen_shuffle(reverse_bits(i), seed);
        EXPECT_EQ(image >> k, block);
        images.insert(image);
      }
      EXPECT_EQ(images.size(), 1u << k);
    }
}

class Stratification : public ::testing::TestWithParam<int> {};

TEST_P(Stratification, EveryStratumOfEveryOneDimensionalSetIsHitOnce) {
  const int k = GetParam(), n = 1 << k;
  for (const std::uint32_t dimension : {0u, 1u, 2u, 17u, 1000u})
    for (const int pixel : {0, 3, 719}) {
      PixelSampler sampler(pixel, 2 * pixel, 5);
      std::vector<int> hits(static_cast<std::size_t>(n));
      for (int i = 0; i < n; ++i) {
        sampler.start_sample(static_cast<std::uint32_t>(i));
        ++hits[static_cast<std::size_t>(sampler.get_1d(dimension) * static_cast<float>(n))];
      }
      for (const int h : hits) ASSERT_EQ(h, 1) << "dimension " << dimension;
    }
}

TEST_P(Stratification, EveryElementaryIntervalOfEveryTwoDimensionalSetIsHitOnce) {
  const int k = GetParam(), n = 1 << k;
  for (const std::uint32_t dimension : {0u, 1u, 2u, 17u, 1000u}) {
    PixelSampler sampler(11, 7, 99);
    for (int x_bits = 0; x_bits <= k; ++x_bits) {
      std::vector<int> hits(static_cast<std::size_t>(n));
      for (int i = 0; i < n; ++i) {
        sampler.start_sample(static_cast<std::uint32_t>(i));
        const Imath::V2f u = sampler.get_2d(dimension);
        const auto column = static_cast<int>(u.x * static_cast<float>(1 << x_bits));
        const auto row = static_cast<int>(u.y * static_cast<float>(1 << (k - x_bits)));
        ++hits[static_cast<std::size_t>((row << x_bits) + column)];
      }
      for (const int h : hits) ASSERT_EQ(h, 1) << "dimension " << dimension << ", " << x_bits;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(PowersOfTwo, Stratification, ::testing::Values(0, 1, 4, 6, 10));

TEST(Sampler, IsAFunctionOfSeedPixelSampleAndDimension) {
  PixelSampler a(12, 34, 5), b(12, 34, 5);
  a.start_sample(3);
  for (std::uint32_t i = 0; i < 3; ++i) b.start_sample(i), b.get_2d(i);  // another history
  b.start_sample(3);
  EXPECT_EQ(a.get_2d(8), b.get_2d(8));
  EXPECT_EQ(a.get_1d(9), b.get_1d(9));

  PixelSampler others[] = {{13, 34, 5}, {12, 35, 5}, {12, 34, 6}, {34, 12, 5}};
  for (PixelSampler& other : others) {
    other.start_sample(3);
    EXPECT_NE(a.get_2d(8), other.get_2d(8));
  }
  EXPECT_NE(a.get_2d(8), a.get_2d(9));
}

// Different pixels and dimensions must not be correlated: their joint histogram is flat.
TEST(Sampler, PixelsAndDimensionsAreIndependent) {
  constexpr int kCells = 16, kPixels = 400, kSamples = 16;
  std::vector<double> dimensions(kCells * kCells), neighbours(kCells * kCells);
  for (int p = 0; p < kPixels; ++p) {
    PixelSampler here(p, 1, 1), right(p + 1, 1, 1);
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      here.start_sample(i);
      right.start_sample(i);
      const auto cell = [](float x) { return static_cast<int>(x * kCells); };
      dimensions[static_cast<std::size_t>(cell(here.get_1d(4)) * kCells + cell(here.get_1d(5)))]++;
      neighbours[static_cast<std::size_t>(cell(here.get_1d(4)) * kCells + cell(right.get_1d(4)))]++;
    }
  }
  for (const auto& table : {dimensions, neighbours}) {
    const double expected = 1.0 * kPixels * kSamples / (kCells * kCells);
    double statistic = 0.0;
    for (const double n : table) statistic += (n - expected) * (n - expected) / expected;
    // 255 degrees of freedom: mean 255, standard deviation 22.6; stratification only lowers it.
    EXPECT_LT(statistic, 255 + 5 * 22.6);
  }
}

TEST(Sampler, MeansOverPixelsAreUniform) {
  double sum = 0.0, sum2 = 0.0;
  constexpr int kPixels = 100000;
  for (int p = 0; p < kPixels; ++p) {
    PixelSampler s(p % 1000, p / 1000, 1);
    const double x = s.get_1d(3);
    sum += x;
    sum2 += x * x;
  }
  EXPECT_NEAR(sum / kPixels, 1.0 / 2.0, 5.0 * std::sqrt(1.0 / 12.0 / kPixels));
  EXPECT_NEAR(sum2 / kPixels, 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0 / kPixels));
}

TEST(Distribution1D, SamplesInProportionAndNeverWhereWeightIsZero) {
  const double weights[] = {0, 1, 3, 0, 0, 6, 0};
  const Distribution1D d(weights);
  std::vector<int> counts(d.size());
  constexpr int kSamples = 100000;
  for (int i = 0; i < kSamples; ++i) {
    const auto cell = d.sample((static_cast<float>(i) + 0.5f) / kSamples);
    ++counts[cell.index];
    ASSERT_GE(cell.offset, 0.0f);
    ASSERT_LT(cell.offset, 1.0f);
    ASSERT_EQ(cell.probability, d.probability(cell.index));
  }
  for (std::size_t i = 0; i < d.size(); ++i) {
    EXPECT_NEAR(d.probability(i), weights[i] / 10.0, 1e-6) << i;
    EXPECT_NEAR(counts[i], kSamples * weights[i] / 10.0, 2.0) << i;
  }
  EXPECT_EQ(d.sample(kOneMinusEpsilon).index, 5u);
  EXPECT_EQ(d.sample(0.0f).index, 1u);
}

// The cell that a search from the start finds, for sizes about those of the guide's buckets and
// weights of which most of u falls into few.
TEST(Distribution1D, FindsTheCellThatASearchFromTheStartFinds) {
  for (const std::size_t size : {1u, 2u, 7u, 8u, 9u, 63u, 64u, 65u, 1000u}) {
    std::vector<double> weights;
    for (std::size_t i = 0; i < size; ++i)
      weights.push_back(i % 5 == 3 ? 0.0 : std::pow(0.5, static_cast<double>(i * 37 % 23)));
    const Distribution1D d(weights);
    for (int i = 0; i <= 5000; ++i) {
      const float u = std::min(static_cast<float>(i) / 5000.0f, kOneMinusEpsilon);
      std::size_t expected = 0;
      float below = 0.0f;  // differences of the sums are exact enough to add up to them again
      while (expected + 1 < size && below + d.probability(expected) <= u)
        below += d.probability(expected++);
      const auto cell = d.sample(u);
      EXPECT_GT(cell.probability, 0.0f);
      // Adding up rounds: next to a border either side of it may be right.
      if (cell.index != expected) {
        EXPECT_TRUE(cell.offset < 1e-2f || cell.offset > 0.99f) << size << " " << u;
      }
    }
  }
}

TEST(Distribution1D, WithoutAnyWeightIsUniformAndBadWeightsAreRefused) {
  const double zeros[] = {0, 0, 0, 0};
  EXPECT_NEAR(Distribution1D(zeros).probability(2), 0.25, 1e-6);
  const double negative[] = {1, -1}, infinite[] = {1, INFINITY}, nan[] = {NAN};
  EXPECT_THROW(Distribution1D{negative}, std::invalid_argument);
  EXPECT_THROW(Distribution1D{infinite}, std::invalid_argument);
  EXPECT_THROW(Distribution1D{nan}, std::invalid_argument);
  EXPECT_THROW(Distribution1D{std::span<const double>()}, std::invalid_argument);
}

}  // namespace
}  // namespace morsel::render
