// SPDX-License-Identifier: Apache-2.0
// instID, geomID and primID name the instance, the geometry and the brick on every path: single
// rays, packets, filters of both kinds of query, point queries; at the top and in instances.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <set>
#include <vector>

#include "hypertexture_geom/embree/surface_query.h"
#include "tests/hypertexture_geom/ball_geometry.h"

namespace morsel::geom {
namespace {

using test::random_direction;
using test::random_point;
using test::ray_of;

constexpr unsigned kNone = RTC_INVALID_GEOMETRY_ID;

struct Seen {
  unsigned primitive, geometry, instance;
  float t;
};
thread_local std::vector<Seen> seen;
void note(const RTCFilterFunctionNArguments* a) {
  for (unsigned i = 0; i < a->N; ++i)
    if (a->valid[i] != 0)
      seen.push_back({RTCHitN_primID(a->hit, a->N, i), RTCHitN_geomID(a->hit, a->N, i),
                      RTCHitN_instID(a->hit, a->N, i, 0), RTCRayN_tfar(a->ray, a->N, i)});
}

// The ball twice in one scene: geometry 5 at the top, geometry 7 in instance 3, four to the right.
class HitIds : public test::BallGeometryTest {
 protected:
  static constexpr float kApart = 4.0f;
  HitIds() : object_(rtcNewScene(world_.device())) {
    attach(object_, 7);
    rtcCommitScene(object_);
    attach(world_.scene(), 5);
    RTCGeometry g = rtcNewGeometry(world_.device(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(g, object_);
    Imath::M44f m;
    m.setTranslation(Imath::V3f(kApart, 0.0f, 0.0f));
    rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, m.x);
    accept_all_rays(g);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(world_.scene(), g, 3);
    rtcReleaseGeometry(g);
    world_.commit();
  }
  ~HitIds() override { rtcReleaseScene(object_); }
  void attach(RTCScene scene, unsigned id) {
    RTCGeometry g = geometry_->create(world_.device(), {.occlusion_filter = true});
    rtcSetGeometryIntersectFilterFunction(g, note);
    rtcSetGeometryOccludedFilterFunction(g, note);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(scene, g, id);
    rtcReleaseGeometry(g);
  }

  // `p` in the world must lie in the brick that is named, in the ball that is named.
  void expect_names(const Imath::V3f& p, const Seen& s, const char* path) {
    const bool right = p.x > 0.5f * kApart;
    EXPECT_EQ(s.instance, right ? 3u : kNone) << path;
    EXPECT_EQ(s.geometry, right ? 7u : 5u) << path;
    ASSERT_LT(s.primitive, geometry_->statistics().bricks) << path;
    const topology::Box box = geometry_->brick_bounds(s.primitive);
    const Imath::V3d x = Imath::V3d(p) - Imath::V3d(right ? kApart : 0.0f, 0.0, 0.0);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(x[k], box.min[k] - 1e-5) << path;
      EXPECT_LE(x[k], box.max[k] + 1e-5) << path;
    }
    primitives_.insert(s.primitive);
  }

  struct Line {
    Imath::V3f o, d;
    Imath::V3f at(float t) const { return o + d * t; }
  };
  Line random_line(std::mt19937& random) const {
    const Imath::V3f target =
        random_point(random, 0.7f) + Imath::V3f(random() % 2 ? kApart : 0.0f, 0.0f, 0.0f);
    const Imath::V3f o = target + random_direction(random) * 1.9f;
    return {o, target - o};
  }

  template <class RayHitN, class RayN, int N>
  void expect_packets_name() {
    std::mt19937 random(N + 100);
    int hits = 0;
    for (int trial = 0; trial < 200; ++trial) {
      alignas(64) RayHitN packet;
      std::memset(&packet, 0, sizeof packet);
      alignas(64) int valid[N];
      Line lines[N];
      for (int i = 0; i < N; ++i) {
        valid[i] = random() % 4 ? -1 : 0;
        lines[i] = random_line(random);
        packet.ray.org_x[i] = lines[i].o.x;
        packet.ray.org_y[i] = lines[i].o.y;
        packet.ray.org_z[i] = lines[i].o.z;
        packet.ray.dir_x[i] = lines[i].d.x;
        packet.ray.dir_y[i] = lines[i].d.y;
        packet.ray.dir_z[i] = lines[i].d.z;
        packet.ray.tfar[i] = std::numeric_limits<float>::infinity();
        packet.ray.mask[i] = 0xffffffffu;
        packet.hit.geomID[i] = packet.hit.primID[i] = packet.hit.instID[0][i] = kNone;
      }
      alignas(64) RayN shadow = packet.ray;
      seen.clear();
      intersect_packet(valid, world_.scene(), packet);
      occluded_packet(valid, world_.scene(), shadow);
      for (const Seen& s : seen) {
        EXPECT_EQ(s.geometry, s.instance == 3u ? 7u : 5u);
        EXPECT_TRUE(s.instance == 3u || s.instance == kNone);
        EXPECT_LT(s.primitive, geometry_->statistics().bricks);
      }
      for (int i = 0; i < N; ++i) {
        if (packet.hit.geomID[i] == kNone) continue;
        ASSERT_NE(valid[i], 0);
        ++hits;
        expect_names(lines[i].at(packet.ray.tfar[i]),
                     {packet.hit.primID[i], packet.hit.geomID[i], packet.hit.instID[0][i], 0.0f},
                     "packet");
      }
    }
    EXPECT_GT(hits, 50 * N);
  }

  test::EmbreeScene world_;
  RTCScene object_;
  std::set<unsigned> primitives_;
};

TEST_F(HitIds, SingleRaysAndFilters) {
  std::mt19937 random(71);
  int hits = 0, left = 0;
  for (int i = 0; i < 4000; ++i) {
    const Line line = random_line(random);
    seen.clear();
    const RTCRayHit h = world_.intersect(ray_of(line.o, line.d));
    for (const Seen& s : seen) expect_names(line.at(s.t), s, "filter");
    EXPECT_EQ(seen.empty(), !test::is_hit(h));
    seen.clear();
    EXPECT_EQ(world_.occluded(ray_of(line.o, line.d)), test::is_hit(h));
    for (const Seen& s : seen) expect_names(line.at(s.t), s, "occlusion filter");
    if (!test::is_hit(h)) continue;
    EXPECT_FALSE(seen.empty());
    expect_names(line.at(h.ray.tfar), {h.hit.primID, h.hit.geomID, h.hit.instID[0], 0.0f}, "ray");
    ++hits;
    left += h.hit.geomID == 5u;
  }
  EXPECT_GT(hits, 2500);
  EXPECT_GT(left, 800);
  EXPECT_GT(hits - left, 800);
  EXPECT_GT(primitives_.size(), geometry_->statistics().bricks / 2);
}

TEST_F(HitIds, PacketsOf4) { expect_packets_name<RTCRayHit4, RTCRay4, 4>(); }
TEST_F(HitIds, PacketsOf8) { expect_packets_name<RTCRayHit8, RTCRay8, 8>(); }
TEST_F(HitIds, PacketsOf16) { expect_packets_name<RTCRayHit16, RTCRay16, 16>(); }

TEST_F(HitIds, PointQueries) {
  std::mt19937 random(72);
  for (int i = 0; i < 100; ++i) {
    const bool right = i % 2;
    const Imath::V3f p = Imath::V3f(ball_->centre()) + random_direction(random) * 0.8f +
                         Imath::V3f(right ? kApart : 0.0f, 0.0f, 0.0f);
    RTCPointQuery query;
    query.x = p.x;
    query.y = p.y;
    query.z = p.z;
    query.radius = 0.01f;
    query.time = 0.0f;
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    std::vector<Seen> found;
    rtcPointQuery(
        world_.scene(), &query, &context,
        [](RTCPointQueryFunctionArguments* a) {
          static_cast<std::vector<Seen>*>(a->userPtr)
              ->push_back({a->primID, a->geomID,
                           a->context->instStackSize > 0 ? a->context->instID[0] : kNone, 0.0f});
          return false;
        },
        &found);
    ASSERT_FALSE(found.empty()) << i;
    for (const Seen& s : found) {
      EXPECT_EQ(s.geometry, right ? 7u : 5u);
      EXPECT_EQ(s.instance, right ? 3u : kNone);
      EXPECT_LT(s.primitive, geometry_->statistics().bricks);
    }
  }
}

TEST_F(HitIds, AllHits) {
  const SurfaceQuery query(*geometry_, world_.device());
  std::mt19937 random(73);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Imath::V3f o = random_point(random, 1.5f), d = random_direction(random);
    for (const auto& h : query.all_hits(o, d)) {
      expect_names(o + d * static_cast<float>(h.t), {h.brick, 5u, kNone, 0.0f}, "all hits");
      ++hits;
    }
  }
  EXPECT_GT(hits, 500);
}

}  // namespace
}  // namespace morsel::geom
