// SPDX-License-Identifier: Apache-2.0
// The C API as programs use it, and as they misuse it.
#include <gtest/gtest.h>
#include <morsel/hypertexture_geom.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "hypertexture_geom/embree/compat.h"
#include "tests/temporary_folder.h"

extern "C" MorselResult c99_evaluate(const char* json, const double* points, size_t count,
                                     double* values);

namespace {

constexpr char kBall[] = R"({"density": {"type": "sphere", "radius": 1}})";
// A ball with two smaller ones apart from it.
constexpr char kThree[] = R"({"field": {"density": {"type": "union", "width": 0.01, "densities": [
  {"type": "sphere", "radius": 0.5},
  {"type": "sphere", "radius": 0.2, "center": [1, 0, 0]},
  {"type": "sphere", "radius": 0.1, "center": [0, 0, 1]}]}}, "keep": "largest:2"})";

MorselField field_of(const char* json) {
  MorselField field = nullptr;
  EXPECT_EQ(morsel_create_field(json, "test", &field), MORSEL_OK) << morsel_last_error_text();
  return field;
}
MorselTopology topology_of(MorselField field) {
  MorselTopology topology = nullptr;
  EXPECT_EQ(morsel_build_topology(field, nullptr, &topology), MORSEL_OK)
      << morsel_last_error_text();
  return topology;
}
MorselGeometry geometry_of(MorselField field, MorselTopology topology, const char* keep) {
  MorselGeometryOptions options{};
  options.struct_size = sizeof options;
  options.keep = keep;
  MorselGeometry geometry = nullptr;
  EXPECT_EQ(morsel_create_geometry(field, topology, &options, &geometry), MORSEL_OK)
      << morsel_last_error_text();
  return geometry;
}
template <class T>
T sized() {
  T t{};
  t.struct_size = sizeof t;
  return t;
}

// Three balls, all kept, with a device.
class CApi : public ::testing::Test {
 protected:
  CApi()
      : device(rtcNewDevice(nullptr)),
        field(field_of(kThree)),
        topology(topology_of(field)),
        geometry(geometry_of(field, topology, "all")) {
    EXPECT_EQ(morsel_create_query(geometry, device, &query), MORSEL_OK);
  }
  ~CApi() override {
    EXPECT_EQ(morsel_release_query(query), MORSEL_OK);
    EXPECT_EQ(morsel_release_geometry(geometry), MORSEL_OK);
    EXPECT_EQ(morsel_release_topology(topology), MORSEL_OK);
    EXPECT_EQ(morsel_release_field(field), MORSEL_OK);
    rtcReleaseDevice(device);
  }
  RTCDevice device;
  MorselField field;
  MorselTopology topology;
  MorselGeometry geometry;
  MorselQuery query = nullptr;
};

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
  const morsel::test::TemporaryFolder folder;
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

TEST_F(CApi, FilesAndCancellation) {
  const morsel::test::TemporaryFolder folder;
  const std::string path = (folder.path() / "three.topo").string();
  MorselTopology loaded = nullptr;
  EXPECT_EQ(morsel_load_topology(field, path.c_str(), &loaded), MORSEL_ERROR_FILE);
  ASSERT_EQ(morsel_save_topology(topology, path.c_str()), MORSEL_OK) << morsel_last_error_text();
  ASSERT_EQ(morsel_load_topology(field, path.c_str(), &loaded), MORSEL_OK);
  auto info = sized<MorselTopologyInfo>();
  ASSERT_EQ(morsel_topology_info(loaded, &info), MORSEL_OK);
  EXPECT_EQ(info.components, 3u);
  EXPECT_EQ(info.bytes, std::filesystem::file_size(path));
  EXPECT_EQ(morsel_release_topology(loaded), MORSEL_OK);

  // Of another field: refused, and never replaced.
  MorselField ball = field_of(kBall);
  EXPECT_EQ(morsel_load_topology(ball, path.c_str(), &loaded), MORSEL_ERROR_FILE);
  EXPECT_EQ(morsel_open_topology(ball, path.c_str(), nullptr, &loaded), MORSEL_ERROR_FILE);
  MorselGeometry g = nullptr;
  EXPECT_EQ(morsel_create_geometry(ball, topology, nullptr, &g), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(std::filesystem::file_size(path), info.bytes);

  auto options = sized<MorselBuildOptions>();
  struct Watch {
    std::atomic<int> progress{0}, asked{0};
    double last = -1;
    int stop_after = 1 << 30;
  } watch;
  options.user = &watch;
  options.progress = [](void* user, double fraction, const char* phase) {
    auto& w = *static_cast<Watch*>(user);
    EXPECT_GE(fraction, w.last);
    EXPECT_LE(fraction, 1.0 + 1e-12);
    EXPECT_NE(phase, nullptr);
    w.last = fraction;
    ++w.progress;
  };
  options.cancel = [](void* user) -> std::int32_t {
    auto& w = *static_cast<Watch*>(user);
    return ++w.asked > w.stop_after;
  };
  const std::string opened = (folder.path() / "ball.topo").string();
  watch.stop_after = 1;
  EXPECT_EQ(morsel_open_topology(ball, opened.c_str(), &options, &loaded), MORSEL_ERROR_CANCELLED);
  EXPECT_FALSE(std::filesystem::exists(opened));
  EXPECT_TRUE(std::filesystem::is_regular_file(path));
  watch.stop_after = 1 << 30;
  watch.last = -1;
  watch.progress = 0;
  options.threads = 2;
  ASSERT_EQ(morsel_open_topology(ball, opened.c_str(), &options, &loaded), MORSEL_OK)
      << morsel_last_error_text();
  EXPECT_GT(watch.progress, 0);
  EXPECT_TRUE(std::filesystem::exists(opened));
  EXPECT_EQ(morsel_release_topology(loaded), MORSEL_OK);
  watch.progress = 0;
  ASSERT_EQ(morsel_open_topology(ball, opened.c_str(), &options, &loaded), MORSEL_OK);
  EXPECT_EQ(watch.progress, 0);  // read, not built
  EXPECT_EQ(morsel_release_topology(loaded), MORSEL_OK);
  EXPECT_EQ(morsel_open_topology(ball, "/nowhere/at/all.topo", &options, &loaded),
            MORSEL_ERROR_FILE);
  EXPECT_EQ(morsel_save_topology(topology, folder.path().c_str()), MORSEL_ERROR_FILE);
  std::ofstream(opened) << "nonsense";
  EXPECT_EQ(morsel_open_topology(ball, opened.c_str(), &options, &loaded), MORSEL_ERROR_FILE);
  EXPECT_EQ(morsel_release_field(ball), MORSEL_OK);
}

TEST_F(CApi, StructsMayGrow) {
  // A caller from the future: what is beyond our struct stays as it was.
  struct {
    MorselShading shading;
    char beyond[64];
  } future;
  std::memset(&future, 0x5a, sizeof future);
  future.shading.struct_size = sizeof future;
  const float p[3] = {0, -0.5f, 0};
  ASSERT_EQ(morsel_shade(geometry, 0, p, 0, &future.shading), MORSEL_OK);
  EXPECT_EQ(future.shading.struct_size, sizeof future);
  for (const char c : future.beyond) EXPECT_EQ(c, 0x5a);
  // One that forgot, or set less than the first version had.
  auto s = sized<MorselShading>();
  for (const std::size_t size : {std::size_t{0}, sizeof s - 1}) {
    s.struct_size = size;
    EXPECT_EQ(morsel_shade(geometry, 0, p, 0, &s), MORSEL_ERROR_INVALID_ARGUMENT);
  }
  MorselBuildOptions options{};
  MorselTopology t = nullptr;
  EXPECT_EQ(morsel_build_topology(field, &options, &t), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(morsel_last_error_text()).find("struct_size"), std::string::npos);
  options.struct_size = sizeof options;
  options.threads = 1000000;
  EXPECT_EQ(morsel_build_topology(field, &options, &t), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(t, nullptr);
}

TEST_F(CApi, NullPointersAreErrors) {
  double d[6];
  const char* text;
  std::int32_t i;
  std::uint32_t u;
  std::size_t n;
  float f[3] = {0, 0, 0};
  MorselHit hit;
  MorselComponent component;
  MorselCriticalPoint point;
  MorselField fo;
  MorselTopology to;
  MorselGeometry go;
  MorselQuery qo;
  RTCGeometry rtc;
  auto ti = sized<MorselTopologyInfo>();
  auto gi = sized<MorselGeometryInfo>();
  auto sh = sized<MorselShading>();
  auto de = sized<MorselDetail>();
  const MorselRay ray{{0, 0, 0}, {1, 0, 0}, 0, 1};

  for (const MorselResult r : {
           morsel_retain_field(nullptr),
           morsel_release_field(nullptr),
           morsel_field_json(nullptr, &text),
           morsel_field_hash(nullptr, &text),
           morsel_field_bounds(nullptr, d, d + 3),
           morsel_evaluate_field(nullptr, d, 1, d, nullptr),
           morsel_build_topology(nullptr, nullptr, &to),
           morsel_load_topology(nullptr, "x", &to),
           morsel_open_topology(nullptr, "x", nullptr, &to),
           morsel_save_topology(nullptr, "x"),
           morsel_retain_topology(nullptr),
           morsel_release_topology(nullptr),
           morsel_topology_info(nullptr, &ti),
           morsel_topology_components(nullptr, 0, 1, sizeof component, &component),
           morsel_topology_critical_points(nullptr, 0, 0, sizeof point, &point),
           morsel_create_geometry(nullptr, topology, nullptr, &go),
           morsel_create_geometry(field, nullptr, nullptr, &go),
           morsel_retain_geometry(nullptr),
           morsel_release_geometry(nullptr),
           morsel_geometry_info(nullptr, &gi),
           morsel_geometry_keeps(nullptr, 0, &i),
           morsel_geometry_component(nullptr, 0, &u),
           morsel_create_rtc_geometry(nullptr, device, 0, &rtc),
           morsel_shade(nullptr, 0, f, 0, &sh),
           morsel_shade_detail(nullptr, 0, d, &de),
           morsel_create_query(nullptr, device, &qo),
           morsel_retain_query(nullptr),
           morsel_release_query(nullptr),
           morsel_query_all_hits(nullptr, &ray, sizeof hit, &hit, 1, &n),
           morsel_query_first_hit(nullptr, &ray, sizeof hit, &hit, &i),
           morsel_query_any_hit(nullptr, &ray, &i),
       })
    EXPECT_EQ(r, MORSEL_ERROR_INVALID_HANDLE);

  for (const MorselResult r : {
           morsel_create_field(nullptr, nullptr, &fo),
           morsel_create_field(kBall, nullptr, nullptr),
           morsel_field_json(field, nullptr),
           morsel_field_hash(field, nullptr),
           morsel_field_bounds(field, nullptr, d),
           morsel_field_bounds(field, d, nullptr),
           morsel_evaluate_field(field, nullptr, 1, d, nullptr),
           morsel_evaluate_field(field, d, 1, nullptr, nullptr),
           morsel_build_topology(field, nullptr, nullptr),
           morsel_load_topology(field, nullptr, &to),
           morsel_load_topology(field, "x", nullptr),
           morsel_open_topology(field, nullptr, nullptr, &to),
           morsel_open_topology(field, "x", nullptr, nullptr),
           morsel_save_topology(topology, nullptr),
           morsel_topology_info(topology, nullptr),
           morsel_topology_components(topology, 0, 1, sizeof component, nullptr),
           morsel_create_geometry(field, topology, nullptr, nullptr),
           morsel_geometry_info(geometry, nullptr),
           morsel_geometry_keeps(geometry, 0, nullptr),
           morsel_geometry_component(geometry, 0, nullptr),
           morsel_create_rtc_geometry(geometry, nullptr, 0, &rtc),
           morsel_create_rtc_geometry(geometry, device, 0, nullptr),
           morsel_shade(geometry, 0, nullptr, 0, &sh),
           morsel_shade(geometry, 0, f, 0, nullptr),
           morsel_shade_detail(geometry, 0, nullptr, &de),
           morsel_shade_detail(geometry, 0, d, nullptr),
           morsel_create_query(geometry, nullptr, &qo),
           morsel_create_query(geometry, device, nullptr),
           morsel_query_all_hits(query, nullptr, sizeof hit, &hit, 1, &n),
           morsel_query_all_hits(query, &ray, sizeof hit, nullptr, 1, &n),
           morsel_query_all_hits(query, &ray, sizeof hit, &hit, 1, nullptr),
           morsel_query_first_hit(query, nullptr, sizeof hit, &hit, &i),
           morsel_query_first_hit(query, &ray, sizeof hit, nullptr, &i),
           morsel_query_first_hit(query, &ray, sizeof hit, &hit, nullptr),
           morsel_query_any_hit(query, nullptr, &i),
           morsel_query_any_hit(query, &ray, nullptr),
       })
    EXPECT_EQ(r, MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_STREQ(morsel_object_error_text(nullptr), "");
}

TEST(CApiHandles, DoubleReleaseAndWrongKind) {
  MorselField field = field_of(kBall);
  EXPECT_EQ(morsel_retain_field(field), MORSEL_OK);
  EXPECT_EQ(morsel_release_field(field), MORSEL_OK);
  const char* hash;
  EXPECT_EQ(morsel_field_hash(field, &hash), MORSEL_OK);
  EXPECT_EQ(morsel_release_topology(reinterpret_cast<MorselTopology>(field)),
            MORSEL_ERROR_INVALID_HANDLE);
  EXPECT_NE(std::string(morsel_last_error_text()).find("it is a field"), std::string::npos);
  EXPECT_EQ(morsel_release_field(field), MORSEL_OK);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(morsel_release_field(field), MORSEL_ERROR_INVALID_HANDLE);
    EXPECT_EQ(morsel_retain_field(field), MORSEL_ERROR_INVALID_HANDLE);
    EXPECT_EQ(morsel_field_hash(field, &hash), MORSEL_ERROR_INVALID_HANDLE);
  }
  EXPECT_NE(std::string(morsel_last_error_text()).find("released already"), std::string::npos);
  // A new object never gets an old handle.
  MorselField other = field_of(kBall);
  EXPECT_NE(other, field);
  EXPECT_EQ(morsel_release_field(other), MORSEL_OK);
}

TEST(CApiHandles, AnyOrderOfRelease) {
  RTCDevice device = rtcNewDevice(nullptr);
  MorselField field = field_of(kBall);
  MorselTopology topology = topology_of(field);
  MorselGeometry geometry = geometry_of(field, topology, nullptr);
  MorselQuery query = nullptr;
  ASSERT_EQ(morsel_create_query(geometry, device, &query), MORSEL_OK);
  EXPECT_EQ(morsel_release_field(field), MORSEL_OK);
  EXPECT_EQ(morsel_release_topology(topology), MORSEL_OK);
  const float p[3] = {1, 0, 0};
  auto s = sized<MorselShading>();
  EXPECT_EQ(morsel_shade(geometry, 0, p, 0, &s), MORSEL_OK);
  EXPECT_EQ(morsel_release_geometry(geometry), MORSEL_OK);
  const MorselRay ray{{-3, 0, 0}, {1, 0, 0}, 0, 100};
  std::int32_t found = 0;
  EXPECT_EQ(morsel_query_any_hit(query, &ray, &found), MORSEL_OK);
  EXPECT_EQ(found, 1);
  rtcReleaseDevice(device);  // the query's scene holds it
  EXPECT_EQ(morsel_query_any_hit(query, &ray, &found), MORSEL_OK);
  EXPECT_EQ(morsel_release_query(query), MORSEL_OK);
}

TEST(CApiErrors, BelongToTheirThread) {
  MorselField field = nullptr;
  EXPECT_EQ(morsel_create_field("{", nullptr, &field), MORSEL_ERROR_INVALID_INPUT);
  const std::string mine = morsel_last_error_text();
  std::thread([] {
    EXPECT_EQ(morsel_last_error(), MORSEL_OK);
    EXPECT_STREQ(morsel_last_error_text(), "");
    EXPECT_EQ(morsel_release_field(nullptr), MORSEL_ERROR_INVALID_HANDLE);
    EXPECT_EQ(morsel_last_error(), MORSEL_ERROR_INVALID_HANDLE);
  }).join();
  EXPECT_EQ(mine, morsel_last_error_text());
}

TEST_F(CApi, ManyThreads) {
  std::vector<std::thread> threads;
  for (int k = 0; k < 8; ++k)
    threads.emplace_back([&, k] {
      std::mt19937 random(static_cast<unsigned>(k));
      std::uniform_real_distribution<float> u(-1.0f, 1.0f);
      for (int i = 0; i < 300; ++i) {
        EXPECT_EQ(morsel_retain_geometry(geometry), MORSEL_OK);
        const float x = u(random), z = u(random);
        const MorselRay ray{{x, -5, z}, {0, 1, 0}, 0, 100};
        MorselHit hit;
        std::int32_t found = -1, any = -1;
        EXPECT_EQ(morsel_query_first_hit(query, &ray, sizeof hit, &hit, &found), MORSEL_OK);
        EXPECT_EQ(morsel_query_any_hit(query, &ray, &any), MORSEL_OK);
        EXPECT_EQ(found, any);
        if (found) {
          const float p[3] = {x, static_cast<float>(-5 + hit.t), z};
          auto s = sized<MorselShading>();
          EXPECT_EQ(morsel_shade(geometry, hit.prim_id, p, 0, &s), MORSEL_OK);
          EXPECT_EQ(s.component, hit.component);
        }
        // Errors of all threads meet at the same handle.
        std::uint32_t component;
        EXPECT_EQ(morsel_geometry_component(geometry, 0xffffffffu, &component),
                  MORSEL_ERROR_INVALID_ARGUMENT);
        EXPECT_NE(std::string(morsel_object_error_text(geometry)).find("prim_id"),
                  std::string::npos);
        EXPECT_EQ(morsel_release_geometry(geometry), MORSEL_OK);
      }
    });
  for (std::thread& t : threads) t.join();
}

// Random calls with random handles, dead, of the wrong kind and null among them: every call answers
// with a known result, and what is alive goes on working.
TEST(CApiHandles, RandomSequences) {
  RTCDevice device = rtcNewDevice(nullptr);
  std::mt19937 random(7);
  std::vector<void*> handles{nullptr};
  const auto pick = [&] { return handles[random() % handles.size()]; };
  int ok = 0, refused = 0;
  const auto note = [&](MorselResult r) {
    ASSERT_TRUE(r == MORSEL_OK || r == MORSEL_ERROR_INVALID_HANDLE ||
                r == MORSEL_ERROR_INVALID_ARGUMENT)
        << r << " " << morsel_last_error_text();
    ++(r == MORSEL_OK ? ok : refused);
  };
  for (int step = 0; step < 4000; ++step) {
    void* h = pick();
    auto* f = static_cast<MorselField>(h);
    auto* t = static_cast<MorselTopology>(h);
    auto* g = static_cast<MorselGeometry>(h);
    auto* q = static_cast<MorselQuery>(h);
    void* made = nullptr;
    switch (random() % 16) {
      case 0:
        if (step % 8 == 0)
          note(morsel_create_field(random() % 2 ? kBall : kThree, nullptr,
                                   reinterpret_cast<MorselField*>(&made)));
        break;
      case 1:
        if (step % 4 == 0)
          note(morsel_build_topology(f, nullptr, reinterpret_cast<MorselTopology*>(&made)));
        break;
      case 2:
        note(morsel_create_geometry(static_cast<MorselField>(pick()), t, nullptr,
                                    reinterpret_cast<MorselGeometry*>(&made)));
        break;
      case 3:
        note(morsel_create_query(g, device, reinterpret_cast<MorselQuery*>(&made)));
        break;
      case 4:
        note(morsel_retain_field(f));
        break;
      case 5:
        note(morsel_release_field(f));
        break;
      case 6:
        note(morsel_retain_topology(t));
        break;
      case 7:
        note(morsel_release_topology(t));
        break;
      case 8:
        note(morsel_retain_geometry(g));
        break;
      case 9:
        note(morsel_release_geometry(g));
        break;
      case 10:
        note(morsel_release_query(q));
        break;
      case 11: {
        const MorselRay ray{{-3, 0, 0}, {1, 0, 0}, 0, 100};
        std::int32_t found = 0;
        note(morsel_query_any_hit(q, &ray, &found));
        break;
      }
      case 12: {
        const float p[3] = {0.5f, 0, 0};
        auto s = sized<MorselShading>();
        note(morsel_shade(g, 0, p, 0, &s));
        break;
      }
      case 13: {
        auto info = sized<MorselTopologyInfo>();
        note(morsel_topology_info(t, &info));
        break;
      }
      case 14: {
        double lower[3], upper[3];
        note(morsel_field_bounds(f, lower, upper));
        break;
      }
      default:
        morsel_object_error_text(h);
        break;
    }
    if (HasFatalFailure()) return;
    if (made) handles.push_back(made);
  }
  EXPECT_GT(ok, 50);
  EXPECT_GT(refused, 500);
  // Let go of everything, whatever its kind and count.
  for (void* h : handles) {
    while (morsel_release_query(static_cast<MorselQuery>(h)) == MORSEL_OK) continue;
    while (morsel_release_geometry(static_cast<MorselGeometry>(h)) == MORSEL_OK) continue;
    while (morsel_release_topology(static_cast<MorselTopology>(h)) == MORSEL_OK) continue;
    while (morsel_release_field(static_cast<MorselField>(h)) == MORSEL_OK) continue;
  }
  rtcReleaseDevice(device);
}

}  // namespace
