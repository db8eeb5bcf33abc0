// SPDX-License-Identifier: Apache-2.0
// Labels and hits do not depend on the vector instructions that the machine has: every set that
// Highway can use here, one at a time.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <optional>
#include <random>
#include <vector>

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::geom {
namespace {

struct Outcome {
  topology::Topology labels;
  std::vector<double> hits;  // distances along random rays; -1: none
};

Outcome outcome_of(const char* field) {
  nlohmann::json json{{"type", "hypertexture"}, {"name", "rock"}, {"keep", "all"}};
  json["field"] = nlohmann::json::parse(field);
  const Hypertexture h = hypertexture_from_json(json, {"rock", ""});
  const auto cache = std::make_shared<const topology::TopologyCache>(build_cache(h));
  GeometryOptions options;
  options.keep = h.keep;
  const HypertextureGeometry geometry(h.field, cache, options);
  Outcome outcome{cache->topology, {}};
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    return Imath::V3d(normal(random), normal(random), normal(random)).normalized();
  };
  for (int i = 0; i < 40; ++i) {
    const Imath::V3d origin = 3.0 * direction(), d = 0.3 * direction() - origin;
    double t = 10.0;
    for (std::uint32_t b = 0; b < geometry.statistics().bricks; ++b)
      if (const auto hit = geometry.intersect_brick(b, origin, d, 0.0, t)) t = hit->t;
    outcome.hits.push_back(t < 10.0 ? t * d.length() : -1.0);
  }
  return outcome;
}

TEST(InstructionSets, ChangeNeitherLabelsNorHits) {
  std::vector<std::int64_t> targets;
  for (std::int64_t all = hwy::SupportedTargets(); all != 0; all &= all - 1)
    targets.push_back(all & -all);
  ASSERT_FALSE(targets.empty());
  for (const char* field :
       {R"({"density": {"type": "sphere", "radius": 0.4}, "modulations": [{"type": "fbm",
            "noise": "sparse_convolution", "amplitude": 0.55, "frequency": 2.5, "layers": 1}]})",
        R"({"density": {"type": "sphere", "radius": 0.4}, "modulations": [{"type": "fbm",
            "noise": "perlin", "amplitude": 0.55, "frequency": 2.5, "layers": 1}]})"}) {
    std::optional<Outcome> first;
    for (const std::int64_t target : targets) {
      SCOPED_TRACE(hwy::TargetName(target));
      hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      const Outcome now = outcome_of(field);
      if (!first) {
        first = now;
        EXPECT_GT(now.labels.components.size(), 1u);
        continue;
      }
      ASSERT_EQ(now.labels.components.size(), first->labels.components.size());
      EXPECT_EQ(now.labels.certified, first->labels.certified);
      for (std::size_t i = 0; i < now.labels.components.size(); ++i) {
        const topology::Component &a = now.labels.components[i], &b = first->labels.components[i];
        EXPECT_NEAR(a.volume_hi, b.volume_hi, 1e-3 * b.volume_hi) << i;
        EXPECT_LT((a.seed - b.seed).length(), 0.1) << i;
      }
      // The order of additions may decide a cell that is undecided by a rounding, and no more.
      EXPECT_NEAR(static_cast<double>(now.labels.leaves), static_cast<double>(first->labels.leaves),
                  1e-3 * static_cast<double>(first->labels.leaves));
      for (std::size_t i = 0; i < now.hits.size(); ++i)
        EXPECT_NEAR(now.hits[i], first->hits[i], 1e-6) << i;
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace morsel::geom
