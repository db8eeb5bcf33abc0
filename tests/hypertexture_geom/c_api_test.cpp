// SPDX-License-Identifier: Apache-2.0
// The C API as programs use it: fields, tables, geometries.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "tests/hypertexture_geom/c_api_fixture.h"
#include "tests/temporary_folder.h"

extern "C" MorselResult c99_evaluate(const char* json, const double* points, size_t count,
                                     double* values);

namespace morsel::test {
namespace {

TEST(CApiVersion, IsThatOfTheHeader) {
  EXPECT_EQ(morsel_api_version(), MORSEL_API_VERSION_MAJOR << 16 | MORSEL_API_VERSION_MINOR);
  EXPECT_EQ(morsel_embree_version(), static_cast<std::uint32_t>(RTC_VERSION));
  EXPECT_NE(std::string(morsel_version_text()).find("Morsel 0."), std::string::npos);
  for (int result = 0; result >= -8; --result)
    EXPECT_EQ(std::string(morsel_result_name(result)).rfind("MORSEL_", 0), 0u) << result;
  EXPECT_STREQ(morsel_result_name(-9), "unknown result");
  EXPECT_STREQ(morsel_result_name(1), "unknown result");
}

TEST(CApiField, FromC99) {
  const double points[] = {0, 0, 0, 2, 0, 0, 0, 0.5, 0};
  double values[3];
  ASSERT_EQ(c99_evaluate(kBall, points, 3, values), MORSEL_OK) << morsel_last_error_text();
  EXPECT_NEAR(values[0], 1.0, 0.1);  // the apex is smoothed
  EXPECT_NEAR(values[1], -1.0, 1e-2);
  EXPECT_NEAR(values[2], 0.5, 1e-2);
}

TEST(CApiField, JsonErrorsNameThePlace) {
  MorselField field = reinterpret_cast<MorselField>(8);
  EXPECT_EQ(
      morsel_create_field(R"({"density": {"type": "sphere", "radios": 1}})", "rock.json", &field),
      MORSEL_ERROR_INVALID_INPUT);
  EXPECT_EQ(field, reinterpret_cast<MorselField>(8));  // untouched
  const std::string text = morsel_last_error_text();
  EXPECT_NE(text.find("rock.json"), std::string::npos) << text;
  EXPECT_NE(text.find("/field/density"), std::string::npos) << text;
  EXPECT_NE(text.find("radius"), std::string::npos) << text;
  EXPECT_EQ(morsel_last_error(), MORSEL_ERROR_INVALID_INPUT);
  for (const char* bad : {"", "{", "[]", "null", "3", "{\"field\": 3}", "{\"density\": []}",
                          "{\"density\": {\"type\": \"sphere\", \"radius\": -1}}", "\xff\xfe"})
    EXPECT_EQ(morsel_create_field(bad, nullptr, &field), MORSEL_ERROR_INVALID_INPUT) << bad;
}

TEST(CApiField, GradientsAndBadPoints) {
  MorselField field = field_of(kBall);
  const double points[] = {0.9, 0, 0, 0, -3, 0};
  double values[2], gradients[6];
  ASSERT_EQ(morsel_evaluate_field(field, points, 2, values, gradients), MORSEL_OK);
  EXPECT_NEAR(gradients[0], -1.0, 1e-2);
  EXPECT_NEAR(gradients[4], 1.0, 1e-2);
  EXPECT_EQ(morsel_evaluate_field(field, nullptr, 0, nullptr, nullptr), MORSEL_OK);
  const double bad[] = {0, 0, 0, 0, std::numeric_limits<double>::quiet_NaN(), 0};
  EXPECT_EQ(morsel_evaluate_field(field, bad, 2, values, nullptr), MORSEL_ERROR_INVALID_ARGUMENT);
  const double far[] = {1e300, 0, 0};
  EXPECT_EQ(morsel_evaluate_field(field, far, 1, values, nullptr), MORSEL_ERROR_INVALID_ARGUMENT);
  double lower[3], upper[3];
  ASSERT_EQ(morsel_field_bounds(field, lower, upper), MORSEL_OK);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(lower[i], -1.0);
    EXPECT_GT(upper[i], 1.0);
  }
  const char *json = nullptr, *hash = nullptr;
  ASSERT_EQ(morsel_field_json(field, &json), MORSEL_OK);
  ASSERT_EQ(morsel_field_hash(field, &hash), MORSEL_OK);
  EXPECT_EQ(std::strlen(hash), 32u);
  EXPECT_NE(std::string(json).find("\"sphere\""), std::string::npos);
  EXPECT_EQ(morsel_release_field(field), MORSEL_OK);
}

TEST_F(CApi, ComponentTable) {
  auto info = sized<MorselTopologyInfo>();
  ASSERT_EQ(morsel_topology_info(topology, &info), MORSEL_OK);
  EXPECT_EQ(info.components, 3u);
  EXPECT_EQ(info.components_lo, 3u);
  EXPECT_EQ(info.components_hi, 3u);
  EXPECT_EQ(info.certified, 1u);
  EXPECT_EQ(info.main_component, 0u);
  std::vector<MorselComponent> c(3);
  ASSERT_EQ(morsel_topology_components(topology, 0, 3, sizeof c[0], c.data()), MORSEL_OK);
  const double radii[] = {0.5, 0.2, 0.1};
  for (int i = 0; i < 3; ++i) {
    const double volume = 4.0 / 3.0 * 3.14159265 * std::pow(radii[i], 3);
    EXPECT_LE(c[static_cast<std::size_t>(i)].volume_lo, 1.1 * volume) << i;
    EXPECT_GE(c[static_cast<std::size_t>(i)].volume_hi, 0.9 * volume) << i;
  }
  for (const MorselComponent& component : c) EXPECT_EQ(component.maxima, 0u);  // not looked for
  EXPECT_NEAR(c[1].seed[0], 1.0, 0.2);
  EXPECT_NEAR(c[2].seed[2], 1.0, 0.1);
  MorselComponent last;
  ASSERT_EQ(morsel_topology_components(topology, 2, 1, sizeof last, &last), MORSEL_OK);
  EXPECT_EQ(last.cells, c[2].cells);
  EXPECT_EQ(morsel_topology_components(topology, 3, 0, sizeof last, nullptr), MORSEL_OK);
  EXPECT_EQ(morsel_topology_components(topology, 2, 2, sizeof last, &last),
            MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(morsel_topology_components(topology, 4, SIZE_MAX, sizeof last, &last),
            MORSEL_ERROR_INVALID_ARGUMENT);
}

TEST_F(CApi, CriticalPoints) {
  auto info = sized<MorselTopologyInfo>();
  ASSERT_EQ(morsel_topology_info(topology, &info), MORSEL_OK);
  EXPECT_EQ(info.critical_points, 0u);  // labels alone
  EXPECT_EQ(morsel_topology_critical_points(topology, 0, 0, sizeof(MorselCriticalPoint), nullptr),
            MORSEL_OK);
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "both.topo").string();
  auto options = sized<MorselBuildOptions>();
  options.engine = MORSEL_ENGINE_BOTH;
  MorselTopology both = nullptr;
  for (const bool from_file : {false, true}) {  // built and written, then read
    ASSERT_EQ(morsel_open_topology(field, path.c_str(), from_file ? nullptr : &options, &both),
              MORSEL_OK)
        << morsel_last_error_text();
    ASSERT_EQ(morsel_topology_info(both, &info), MORSEL_OK);
    ASSERT_GE(info.critical_points, 3u);
    std::vector<MorselCriticalPoint> points(info.critical_points);
    ASSERT_EQ(
        morsel_topology_critical_points(both, 0, points.size(), sizeof points[0], points.data()),
        MORSEL_OK);
    const double centres[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
    bool seen[3] = {false, false, false};
    for (const MorselCriticalPoint& p : points) {
      if (p.type != MORSEL_CRITICAL_MAXIMUM) continue;
      ASSERT_LT(p.component, 3u);
      seen[p.component] = true;
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(p.position[i], centres[p.component][i], 0.02);
      EXPECT_GT(p.value, 0.0);
      EXPECT_LT(p.radius, 1e-6);
      EXPECT_LT(p.eigenvalues[2], 0.0);
      EXPECT_LE(p.eigenvalues[0], p.eigenvalues[1]);
    }
    EXPECT_TRUE(seen[0] && seen[1] && seen[2]);
    MorselComponent table[3];
    ASSERT_EQ(morsel_topology_components(both, 0, 3, sizeof table[0], table), MORSEL_OK);
    for (const MorselComponent& component : table) EXPECT_EQ(component.maxima, 1u);
    MorselCriticalPoint last;
    EXPECT_EQ(morsel_topology_critical_points(both, points.size(), 1, sizeof last, &last),
              MORSEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(morsel_topology_critical_points(both, 0, 1, sizeof last - 1, &last),
              MORSEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(morsel_topology_critical_points(both, 0, 1, sizeof last, nullptr),
              MORSEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(morsel_release_topology(both), MORSEL_OK);
  }
  options.engine = 3;
  EXPECT_EQ(morsel_build_topology(field, &options, &both), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(morsel_last_error_text()).find("MORSEL_ENGINE_BOTH"), std::string::npos);
}

TEST_F(CApi, SolversAndMembership) {
  const MorselRay at_main{{-2, 0.1f, 0.1f}, {1, 0, 0}, 0, 100};
  const MorselRay at_debris{{1, -2, 0.05f}, {0, 1, 0}, 0, 100};
  for (std::uint32_t solver = MORSEL_SOLVER_MODEL; solver <= MORSEL_SOLVER_SPHERE; ++solver)
    for (std::uint32_t membership = MORSEL_MEMBERSHIP_LABELS; membership <= MORSEL_MEMBERSHIP_OFF;
         ++membership) {
      if (solver != MORSEL_SOLVER_MODEL && membership != MORSEL_MEMBERSHIP_LABELS) continue;
      auto options = sized<MorselGeometryOptions>();
      options.keep = "main";
      options.solver = solver;
      options.membership = membership;
      MorselGeometry g = nullptr;
      ASSERT_EQ(morsel_create_geometry(field, topology, &options, &g), MORSEL_OK)
          << morsel_last_error_text();
      auto info = sized<MorselGeometryInfo>();
      ASSERT_EQ(morsel_geometry_info(g, &info), MORSEL_OK);
      EXPECT_EQ(info.primitives == 1, solver == MORSEL_SOLVER_SPHERE);
      // The coarse octree and the table are held by every one of them; bricks take 128 bytes each.
      EXPECT_GT(info.bytes, 3 * sizeof(MorselComponent));
      if (solver != MORSEL_SOLVER_SPHERE) {
        EXPECT_GT(info.bytes, 128 * info.primitives);
      }
      EXPECT_EQ(info.kept_components, membership == MORSEL_MEMBERSHIP_OFF ? 3u : 1u);
      MorselQuery q = nullptr;
      // An error of the caller's that nobody has asked for yet is not one of the query.
      RTCGeometry other = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
      rtcSetGeometryBuildQuality(other, static_cast<RTCBuildQuality>(77));
      rtcReleaseGeometry(other);
      ASSERT_EQ(morsel_create_query(g, device, &q), MORSEL_OK);
      MorselHit hit;
      std::int32_t found = 0;
      ASSERT_EQ(morsel_query_first_hit(q, &at_main, sizeof hit, &hit, &found), MORSEL_OK);
      ASSERT_EQ(found, 1) << solver << ' ' << membership;
      EXPECT_NEAR(hit.t, 2.0 - std::sqrt(0.25 - 0.02), 1e-3) << solver << ' ' << membership;
      // One primitive of all components names the hit's own, too.
      EXPECT_LT(hit.component, 3u) << solver << ' ' << membership;
      ASSERT_EQ(morsel_query_any_hit(q, &at_debris, &found), MORSEL_OK);
      EXPECT_EQ(found, membership == MORSEL_MEMBERSHIP_OFF ? 1 : 0) << solver << ' ' << membership;
      EXPECT_EQ(morsel_release_query(q), MORSEL_OK);
      EXPECT_EQ(morsel_release_geometry(g), MORSEL_OK);
    }
  // A program of version 0.1, whose struct ends before both.
  auto options = sized<MorselGeometryOptions>();
  options.struct_size = offsetof(MorselGeometryOptions, solver);
  options.solver = options.membership = 77;
  MorselGeometry g = nullptr;
  ASSERT_EQ(morsel_create_geometry(field, topology, &options, &g), MORSEL_OK);
  EXPECT_EQ(morsel_release_geometry(g), MORSEL_OK);
  options.struct_size = sizeof options;
  EXPECT_EQ(morsel_create_geometry(field, topology, &options, &g), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(morsel_last_error_text()).find("MORSEL_SOLVER_SPHERE"), std::string::npos);
  options.solver = 0;
  EXPECT_EQ(morsel_create_geometry(field, topology, &options, &g), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(morsel_last_error_text()).find("MORSEL_MEMBERSHIP_OFF"), std::string::npos);
}

TEST_F(CApi, KeepRules) {
  const auto kept = [&](const char* rule) {
    MorselGeometry g = geometry_of(field, topology, rule);
    std::string found;
    for (std::uint32_t i = 0; i < 3; ++i) {
      std::int32_t keeps = -1;
      EXPECT_EQ(morsel_geometry_keeps(g, i, &keeps), MORSEL_OK);
      found += static_cast<char>('0' + keeps);
    }
    auto info = sized<MorselGeometryInfo>();
    EXPECT_EQ(morsel_geometry_info(g, &info), MORSEL_OK);
    EXPECT_EQ(info.kept_components,
              static_cast<std::uint64_t>(std::count(found.begin(), found.end(), '1')));
    EXPECT_EQ(info.primitives > 0, info.kept_components > 0);
    EXPECT_EQ(morsel_release_geometry(g), MORSEL_OK);
    return found;
  };
  EXPECT_EQ(kept(nullptr), "110");  // the field's own
  EXPECT_EQ(kept("main"), "100");
  EXPECT_EQ(kept("all"), "111");
  EXPECT_EQ(kept("detached"), "011");
  EXPECT_EQ(kept("touching:1,0,0"), "010");
  EXPECT_EQ(kept("ids:2"), "001");
  EXPECT_EQ(kept("volume:1000"), "000");
  MorselGeometryOptions options{};
  options.struct_size = sizeof options;
  options.keep = "biggest";
  MorselGeometry g = nullptr;
  EXPECT_EQ(morsel_create_geometry(field, topology, &options, &g), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(morsel_last_error_text()).find("largest:K"), std::string::npos);
  EXPECT_STREQ(morsel_object_error_text(field), morsel_last_error_text());
}

}  // namespace
}  // namespace morsel::test
