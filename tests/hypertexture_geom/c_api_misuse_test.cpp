// SPDX-License-Identifier: Apache-2.0
// The C API as programs misuse it, and from many threads.
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/hypertexture_geom/c_api_fixture.h"

namespace morsel::test {
namespace {

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
           morsel_load_topology_with(nullptr, "x", nullptr, &to),
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
           morsel_load_topology_with(field, nullptr, nullptr, &to),
           morsel_load_topology_with(field, "x", nullptr, nullptr),
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
}  // namespace morsel::test
