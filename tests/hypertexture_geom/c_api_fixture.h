// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <morsel/hypertexture_geom.h>

#include "hypertexture_geom/embree/compat.h"

// What the tests of the C API share.
namespace morsel::test {

inline constexpr char kBall[] = R"({"density": {"type": "sphere", "radius": 1}})";
// A ball with two smaller ones apart from it.
inline constexpr char kThree[] =
    R"({"field": {"density": {"type": "union", "width": 0.01, "densities": [
  {"type": "sphere", "radius": 0.5},
  {"type": "sphere", "radius": 0.2, "center": [1, 0, 0]},
  {"type": "sphere", "radius": 0.1, "center": [0, 0, 1]}]}}, "keep": "largest:2"})";

inline MorselField field_of(const char* json) {
  MorselField field = nullptr;
  EXPECT_EQ(morsel_create_field(json, "test", &field), MORSEL_OK) << morsel_last_error_text();
  return field;
}
inline MorselTopology topology_of(MorselField field) {
  MorselTopology topology = nullptr;
  EXPECT_EQ(morsel_build_topology(field, nullptr, &topology), MORSEL_OK)
      << morsel_last_error_text();
  return topology;
}
inline MorselGeometry geometry_of(MorselField field, MorselTopology topology, const char* keep) {
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

}  // namespace morsel::test
