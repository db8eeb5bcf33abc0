// SPDX-License-Identifier: Apache-2.0
// The C API's promise that everything may be called from several threads at once, for what makes
// and keeps things; queries are in c_api_misuse_test.
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "tests/hypertexture_geom/c_api_fixture.h"
#include "tests/temporary_folder.h"

namespace morsel::test {
namespace {

constexpr int kThreads = 4;

template <class Work>
void on_each_thread(const Work& work) {
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) threads.emplace_back([&work, i] { work(i); });
  for (std::thread& t : threads) t.join();
}

std::uint64_t components_of(MorselTopology topology) {
  auto info = sized<MorselTopologyInfo>();
  EXPECT_EQ(morsel_topology_info(topology, &info), MORSEL_OK);
  return info.components;
}

// One field, one file: whoever comes first builds, the others build too or read what is whole.
TEST(CApiThreads, OpenAndSaveOneFile) {
  const TemporaryFolder folder;
  const std::string path = (folder / "three.topo").string();
  MorselField field = field_of(kThree);
  on_each_thread([&](int) {
    for (int round = 0; round < 3; ++round) {
      MorselTopology opened = nullptr, loaded = nullptr;
      ASSERT_EQ(morsel_open_topology(field, path.c_str(), nullptr, &opened), MORSEL_OK)
          << morsel_last_error_text();
      EXPECT_EQ(components_of(opened), 3u);
      EXPECT_EQ(morsel_save_topology(opened, path.c_str()), MORSEL_OK) << morsel_last_error_text();
      ASSERT_EQ(morsel_load_topology(field, path.c_str(), &loaded), MORSEL_OK)
          << morsel_last_error_text();
      EXPECT_EQ(components_of(loaded), 3u);
      EXPECT_EQ(morsel_release_topology(opened), MORSEL_OK);
      EXPECT_EQ(morsel_release_topology(loaded), MORSEL_OK);
    }
  });
  EXPECT_EQ(morsel_release_field(field), MORSEL_OK);
  EXPECT_EQ(folder.count_files(), 1u);
}

// Everything from the text to the hit, by each thread for itself, on one device.
TEST(CApiThreads, WholeLives) {
  RTCDevice device = rtcNewDevice(nullptr);
  on_each_thread([&](int i) {
    for (int round = 0; round < 2; ++round) {
      MorselField field = field_of(i % 2 != 0 ? kThree : kBall);
      MorselTopology topology = topology_of(field);
      MorselGeometry geometry = geometry_of(field, topology, "all");
      MorselQuery query = nullptr;
      ASSERT_EQ(morsel_create_query(geometry, device, &query), MORSEL_OK);
      const MorselRay ray{{0, -5, 0}, {0, 1, 0}, 0, 100};
      std::int32_t found = 0;
      EXPECT_EQ(morsel_query_any_hit(query, &ray, &found), MORSEL_OK);
      EXPECT_EQ(found, 1);
      EXPECT_EQ(morsel_release_field(field), MORSEL_OK);
      EXPECT_EQ(morsel_release_topology(topology), MORSEL_OK);
      EXPECT_EQ(morsel_release_geometry(geometry), MORSEL_OK);
      EXPECT_EQ(morsel_release_query(query), MORSEL_OK);
    }
  });
  rtcReleaseDevice(device);
}

// Geometries of one topology, and hits of one Embree scene, at once.
TEST_F(CApi, GeometriesAndRaysAtOnce) {
  RTCGeometry rtc = nullptr;
  ASSERT_EQ(morsel_create_rtc_geometry(geometry, device, 0, &rtc), MORSEL_OK);
  RTCScene scene = rtcNewScene(device);
  rtcCommitGeometry(rtc);
  rtcAttachGeometry(scene, rtc);
  rtcReleaseGeometry(rtc);
  rtcCommitScene(scene);
  std::atomic<int> hits{0};
  on_each_thread([&](int i) {
    if (i % 2 == 0) {
      for (int round = 0; round < 4; ++round) {
        MorselGeometry own = geometry_of(field, topology, round % 2 != 0 ? "main" : "all");
        auto info = sized<MorselGeometryInfo>();
        EXPECT_EQ(morsel_geometry_info(own, &info), MORSEL_OK);
        EXPECT_EQ(info.kept_components, round % 2 != 0 ? 1u : 3u);
        EXPECT_EQ(morsel_release_geometry(own), MORSEL_OK);
      }
      return;
    }
    for (int k = 0; k < 500; ++k) {
      const float x = static_cast<float>(k) / 250.0f - 1.0f;
      RTCRayHit ray = geom::make_ray_hit(geom::make_ray(x, -5, 0, 0, 1, 0));
      geom::intersect1(scene, ray);
      hits += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
      double at[3] = {x, 0, 0}, value = 0;
      EXPECT_EQ(morsel_evaluate_field(field, at, 1, &value, nullptr), MORSEL_OK);
    }
  });
  EXPECT_GT(hits, 100);
  rtcReleaseScene(scene);
}

}  // namespace
}  // namespace morsel::test
