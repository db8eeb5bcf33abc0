// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>

namespace morsel::render {

enum class RayUse { kCamera, kBounce, kShadow };
inline constexpr std::size_t kRayUses = 3;

// What rays of one use cost in hypertextures: how many took 0, 1, 2-3, 4-7, ... evaluations of a
// field, and how many roots were put to a membership filter.
struct RayCost {
  static constexpr std::size_t kBins = 16;
  std::array<std::uint64_t, kBins> rays{};
  std::uint64_t evaluations = 0, filtered = 0;

  void add_ray(std::uint64_t count, std::uint64_t filter_calls) {
    ++rays[std::min<std::size_t>(static_cast<std::size_t>(std::bit_width(count)), kBins - 1)];
    evaluations += count;
    filtered += filter_calls;
  }
  void add(const RayCost& other) {
    for (std::size_t i = 0; i < kBins; ++i) rays[i] += other.rays[i];
    evaluations += other.evaluations;
    filtered += other.filtered;
  }
};

struct RayCounts {
  std::uint64_t camera = 0, bounce = 0, shadow = 0;
  std::array<RayCost, kRayUses> costs;  // by RayUse

  std::uint64_t total() const { return camera + bounce + shadow; }
  void add(const RayCounts& other) {
    camera += other.camera;
    bounce += other.bounce;
    shadow += other.shadow;
    for (std::size_t i = 0; i < kRayUses; ++i) costs[i].add(other.costs[i]);
  }
};

// Instances and components that samples met, for the mattes' manifest.
using SeenComponents = std::set<std::pair<std::uint32_t, std::uint32_t>>;

// What the samples of a part of an image were and took.
struct SampleCounts {
  RayCounts rays;
  std::uint64_t samples = 0;     // paths
  std::uint64_t non_finite = 0;  // whose radiance was NaN or infinite and was taken as 0
  SeenComponents components;

  void add(const SampleCounts& other) {
    rays.add(other.rays);
    samples += other.samples;
    non_finite += other.non_finite;
    components.insert(other.components.begin(), other.components.end());
  }
};

}  // namespace morsel::render
