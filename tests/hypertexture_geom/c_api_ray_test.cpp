// SPDX-License-Identifier: Apache-2.0
// The C API: rays, shading data, queries.
#include <cmath>
#include <limits>
#include <vector>

#include "tests/hypertexture_geom/c_api_fixture.h"

namespace morsel::test {
namespace {

TEST_F(CApi, RaysAndShading) {
  RTCGeometry rtc = nullptr;
  ASSERT_EQ(morsel_create_rtc_geometry(geometry, device, 0, &rtc), MORSEL_OK);
  RTCScene scene = rtcNewScene(device);
  rtcAttachGeometry(scene, rtc);
  rtcReleaseGeometry(rtc);
  rtcCommitScene(scene);
  const auto trace = [&](float x, float z) {
    RTCRayHit h = morsel::geom::make_ray_hit(morsel::geom::make_ray(x, -5, z, 0, 1, 0));
    morsel::geom::intersect1(scene, h);
    return h;
  };
  const float centres[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  const float radii[3] = {0.5f, 0.2f, 0.1f};
  for (std::uint32_t i = 0; i < 3; ++i) {
    const RTCRayHit h = trace(centres[i][0], centres[i][1]);
    ASSERT_NE(h.hit.geomID, RTC_INVALID_GEOMETRY_ID) << i;
    EXPECT_NEAR(h.ray.tfar, 5.0f - radii[i], 1e-2f);
    const float p[3] = {centres[i][0], -5 + h.ray.tfar, centres[i][1]};
    auto s = sized<MorselShading>();
    ASSERT_EQ(morsel_shade(geometry, h.hit.primID, p, 1e-6f, &s), MORSEL_OK);
    EXPECT_NEAR(s.normal[1], -1.0f, 1e-3f);
    EXPECT_EQ(s.component, i);
    EXPECT_EQ(s.spawn_verified, 1u);
    EXPECT_LT(s.spawn_front[1], s.position[1]);
    EXPECT_GT(s.spawn_behind[1], s.position[1]);
    EXPECT_LT(s.position_error, 1e-4);
    double value, at[3] = {s.spawn_front[0], s.spawn_front[1], s.spawn_front[2]};
    ASSERT_EQ(morsel_evaluate_field(field, at, 1, &value, nullptr), MORSEL_OK);
    EXPECT_LT(value, 0.0);
    auto d = sized<MorselDetail>();
    ASSERT_EQ(morsel_shade_detail(geometry, h.hit.primID, s.position, &d), MORSEL_OK);
    EXPECT_NEAR(d.mean_curvature * static_cast<double>(radii[i]), 1.0, 0.02);
    EXPECT_NEAR(d.density, 0.0, 1e-6);
    EXPECT_EQ(d.noise, 0.0);
    std::uint32_t component = 99;
    ASSERT_EQ(morsel_geometry_component(geometry, h.hit.primID, &component), MORSEL_OK);
    EXPECT_EQ(component, i);
  }
  EXPECT_EQ(trace(0, -1).hit.geomID, RTC_INVALID_GEOMETRY_ID);

  const float origin[3] = {0, 0, 0};
  auto s = sized<MorselShading>();
  EXPECT_EQ(morsel_shade(geometry, 0xfffffffeu, origin, 0, &s), MORSEL_ERROR_INVALID_ARGUMENT);
  const float nan[3] = {0, std::numeric_limits<float>::quiet_NaN(), 0};
  EXPECT_EQ(morsel_shade(geometry, 0, nan, 0, &s), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(morsel_shade(geometry, 0, origin, -1, &s), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(morsel_create_rtc_geometry(geometry, device, 2, &rtc), MORSEL_ERROR_INVALID_ARGUMENT);
  rtcReleaseScene(scene);
}

TEST_F(CApi, Queries) {
  const MorselRay through{{-2, 0, 0}, {1, 0, 0}, 0, std::numeric_limits<float>::infinity()};
  const MorselRay past{{-2, 0, -1}, {1, 0, 0}, 0, 100};
  MorselHit hits[8];
  std::size_t count = 99;
  ASSERT_EQ(morsel_query_all_hits(query, &through, sizeof(MorselHit), hits, 8, &count), MORSEL_OK);
  ASSERT_EQ(count, 4u);
  const double expected[] = {1.5, 2.5, 2.8, 3.2};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(hits[i].t, expected[i], 1e-2);
    EXPECT_EQ(hits[i].entering, i % 2 == 0);
    EXPECT_EQ(hits[i].component, i / 2);
    EXPECT_EQ(hits[i].gradient[0] > 0, i % 2 == 0);
  }
  hits[1].t = -7;
  ASSERT_EQ(morsel_query_all_hits(query, &through, sizeof(MorselHit), hits, 1, &count), MORSEL_OK);
  EXPECT_EQ(count, 4u);
  EXPECT_EQ(hits[1].t, -7);
  EXPECT_EQ(morsel_query_all_hits(query, &through, sizeof(MorselHit), nullptr, 0, &count),
            MORSEL_OK);
  std::int32_t found = -1;
  ASSERT_EQ(morsel_query_first_hit(query, &through, sizeof(MorselHit), hits, &found), MORSEL_OK);
  EXPECT_EQ(found, 1);
  EXPECT_NEAR(hits[0].t, 1.5, 1e-2);
  ASSERT_EQ(morsel_query_first_hit(query, &past, sizeof(MorselHit), hits, &found), MORSEL_OK);
  EXPECT_EQ(found, 0);
  ASSERT_EQ(morsel_query_any_hit(query, &through, &found), MORSEL_OK);
  EXPECT_EQ(found, 1);
  ASSERT_EQ(morsel_query_any_hit(query, &past, &found), MORSEL_OK);
  EXPECT_EQ(found, 0);
  EXPECT_EQ(morsel_query_all_hits(query, &through, 40, hits, 8, &count),
            MORSEL_ERROR_INVALID_ARGUMENT);
}

// A ray along a face, a millionth above it: sphere tracing gives up, and says so.
TEST(CApiStepLimits, AreCounted) {
  RTCDevice device = rtcNewDevice(nullptr);
  MorselField field = field_of(
      R"({"field": {"density": {"type": "slab", "axis": [0, 0, 1], "half_thickness": 0.5}},
          "bounds": {"min": [-1, -1, -1], "max": [1, 1, 1]}, "max_depth": 5})");
  MorselTopology topology = topology_of(field);
  auto options = sized<MorselGeometryOptions>();
  options.solver = MORSEL_SOLVER_SPHERE;
  options.keep = "all";
  MorselGeometry geometry = nullptr;
  ASSERT_EQ(morsel_create_geometry(field, topology, &options, &geometry), MORSEL_OK);
  MorselQuery query = nullptr;
  ASSERT_EQ(morsel_create_query(geometry, device, &query), MORSEL_OK);
  const auto limits = [&] {
    auto info = sized<MorselGeometryInfo>();
    EXPECT_EQ(morsel_geometry_info(geometry, &info), MORSEL_OK);
    return info.step_limits;
  };
  std::int32_t found = -1;
  const MorselRay across{{0.1f, 0.2f, 3}, {0, 0, -1}, 0, 100};
  ASSERT_EQ(morsel_query_any_hit(query, &across, &found), MORSEL_OK);
  EXPECT_EQ(found, 1);
  EXPECT_EQ(limits(), 0u);
  // Where the face is along this line, to within float.
  MorselHit hit;
  ASSERT_EQ(morsel_query_first_hit(query, &across, sizeof hit, &hit, &found), MORSEL_OK);
  const MorselRay along{{-3, 0.2f, static_cast<float>(3.0 - hit.t + 1e-6)}, {1, 0, 0}, 0, 100};
  ASSERT_EQ(morsel_query_any_hit(query, &along, &found), MORSEL_OK);
  EXPECT_GT(limits(), 0u);
  EXPECT_EQ(morsel_release_query(query), MORSEL_OK);
  EXPECT_EQ(morsel_release_geometry(geometry), MORSEL_OK);
  EXPECT_EQ(morsel_release_topology(topology), MORSEL_OK);
  EXPECT_EQ(morsel_release_field(field), MORSEL_OK);
  rtcReleaseDevice(device);
}

}  // namespace
}  // namespace morsel::test
