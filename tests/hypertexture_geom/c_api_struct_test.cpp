// SPDX-License-Identifier: Apache-2.0
// The C API: structs of older and newer callers.
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include "tests/hypertexture_geom/c_api_fixture.h"

namespace morsel::test {
namespace {

TEST_F(CApi, StructsMayGrow) {
  // A caller from the future: what is beyond our struct is zero, and not beyond its own.
  struct {
    MorselShading shading;
    char unknown[64];
    char beyond[64];
  } future;
  std::memset(&future, 0x5a, sizeof future);
  future.shading.struct_size = offsetof(decltype(future), beyond);
  const float p[3] = {0, -0.5f, 0};
  ASSERT_EQ(morsel_shade(geometry, 0, p, 0, &future.shading), MORSEL_OK);
  EXPECT_EQ(future.shading.struct_size, offsetof(decltype(future), beyond));
  for (const char c : future.unknown) EXPECT_EQ(c, 0);
  for (const char c : future.beyond) EXPECT_EQ(c, 0x5a);
  // One that forgot, or set less than the first version had, or what no struct has.
  auto s = sized<MorselShading>();
  for (const std::size_t size : {std::size_t{0}, sizeof s - 8, sizeof s + 4, ~std::size_t{0}}) {
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

TEST_F(CApi, EntriesMayGrow) {
  // Tables and hits, likewise: entries of a newer caller, which are further apart.
  struct Component {
    MorselComponent known;
    double unknown[2];
  } components[3];
  std::memset(components, 0x5a, sizeof components);
  ASSERT_EQ(morsel_topology_components(topology, 0, 2, sizeof(Component), &components[0].known),
            MORSEL_OK);
  MorselComponent plain[2];
  ASSERT_EQ(morsel_topology_components(topology, 0, 2, sizeof plain[0], plain), MORSEL_OK);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(std::memcmp(&components[i].known, &plain[i], sizeof plain[i]), 0);
    EXPECT_EQ(components[i].unknown[1], 0.0);
  }
  EXPECT_NE(components[2].known.cells, plain[0].cells);  // untouched
  // An older one, whose struct ends before the maxima.
  unsigned char old[offsetof(MorselComponent, maxima) + 1];
  old[sizeof old - 1] = 0x5a;
  ASSERT_EQ(morsel_topology_components(topology, 1, 1, sizeof old - 1,
                                       reinterpret_cast<MorselComponent*>(old)),
            MORSEL_OK);
  EXPECT_EQ(std::memcmp(old, &plain[1], sizeof old - 1), 0);
  EXPECT_EQ(old[sizeof old - 1], 0x5a);
  struct Hit {
    MorselHit known;
    double unknown;
  } hit;
  std::memset(&hit, 0x5a, sizeof hit);
  const MorselRay ray{{-2, 0, 0}, {1, 0, 0}, 0, 100};
  std::int32_t found = 0;
  ASSERT_EQ(morsel_query_first_hit(query, &ray, sizeof hit, &hit.known, &found), MORSEL_OK);
  EXPECT_EQ(found, 1);
  EXPECT_EQ(hit.unknown, 0.0);
  EXPECT_EQ(morsel_query_first_hit(query, &ray, sizeof hit + 4, &hit.known, &found),
            MORSEL_ERROR_INVALID_ARGUMENT);
}

// Options of a newer caller: what it leaves at 0 is nothing that we would have to know.
TEST_F(CApi, UnknownOptionsAreRefused) {
  const auto says = [](const char* part) {
    return std::string(morsel_last_error_text()).find(part) != std::string::npos;
  };
  struct {
    MorselGeometryOptions known;
    std::uint32_t unknown[4];
  } geometry_options{};
  geometry_options.known.struct_size = sizeof geometry_options;
  MorselGeometry g = nullptr;
  ASSERT_EQ(morsel_create_geometry(field, topology, &geometry_options.known, &g), MORSEL_OK);
  EXPECT_EQ(morsel_release_geometry(g), MORSEL_OK);
  geometry_options.unknown[2] = 1;
  EXPECT_EQ(morsel_create_geometry(field, topology, &geometry_options.known, &g),
            MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_TRUE(says("MorselGeometryOptions")) << morsel_last_error_text();
  EXPECT_TRUE(says(std::to_string(sizeof(MorselGeometryOptions) + 8).c_str()))
      << morsel_last_error_text();
  struct {
    MorselBuildOptions known;
    std::uint64_t unknown;
  } build{};
  build.known.struct_size = sizeof build;
  build.unknown = 1;
  MorselTopology t = nullptr;
  EXPECT_EQ(morsel_build_topology(field, &build.known, &t), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_TRUE(says("MorselBuildOptions")) << morsel_last_error_text();

  auto options = sized<MorselGeometryOptions>();
  options.reserved = 7;
  EXPECT_EQ(morsel_create_geometry(field, topology, &options, &g), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_TRUE(says("MorselGeometryOptions: reserved is 7")) << morsel_last_error_text();
  for (const bool second : {false, true}) {
    auto reserved = sized<MorselBuildOptions>();
    (second ? reserved.reserved2 : reserved.reserved) = 7;
    EXPECT_EQ(morsel_build_topology(field, &reserved, &t), MORSEL_ERROR_INVALID_ARGUMENT);
    EXPECT_TRUE(says(second ? "reserved2 is 7" : "reserved is 7")) << morsel_last_error_text();
  }
}

}  // namespace
}  // namespace morsel::test
