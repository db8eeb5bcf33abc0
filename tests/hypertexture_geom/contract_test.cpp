// SPDX-License-Identifier: Apache-2.0
// What Embree promises of a geometry, beyond geometry_test.cpp: packets of every width, filters
// that see every hit, instances that mirror and move, point queries, monitors, changes while others
// trace. Named after the tests of Embree's own geometries.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include "tests/hypertexture_geom/ball_geometry.h"

namespace morsel::geom {
namespace {

using test::random_direction;
using test::random_point;
using test::ray_of;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

class ContractTest : public test::BallGeometryTest {
 protected:
  // Parameters of the hits of a ray, in closed form, that lie in (0, infinity).
  static std::vector<double> expected_hits(const Imath::V3f& o, const Imath::V3f& d) {
    std::vector<double> t;
    if (const auto c = ball_->crossings(Imath::V3d(o), Imath::V3d(d)))
      for (const double x : {c->first, c->second})
        if (x > 0.0) t.push_back(x);
    return t;
  }
};

// Ray `k` of a packet is the same as a ray by itself; inactive lanes stay as they are.
template <class RayHitN, class RayN, int N>
void expect_packets_like_single_rays(const test::EmbreeScene& scene, unsigned geometry) {
  std::mt19937 random(N);
  for (int trial = 0; trial < 400; ++trial) {
    alignas(64) RayHitN packet;
    std::memset(&packet, 0, sizeof packet);
    alignas(64) int valid[N];
    RTCRayHit single[N];
    for (int i = 0; i < N; ++i) {
      // All inactive, all active, or at random.
      valid[i] = trial == 0 ? 0 : trial == 1 || random() % 2 ? -1 : 0;
      const RTCRay ray = ray_of(random_point(random, 1.5f), random_direction(random) * 0.7f,
                                trial % 3 ? 0.0f : 0.4f, trial % 5 ? kInfinity : 2.0f);
      single[i] = make_ray_hit(ray);
      packet.ray.org_x[i] = ray.org_x;
      packet.ray.org_y[i] = ray.org_y;
      packet.ray.org_z[i] = ray.org_z;
      packet.ray.dir_x[i] = ray.dir_x;
      packet.ray.dir_y[i] = ray.dir_y;
      packet.ray.dir_z[i] = ray.dir_z;
      packet.ray.tnear[i] = ray.tnear;
      packet.ray.tfar[i] = ray.tfar;
      packet.ray.mask[i] = ray.mask;
      packet.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    alignas(64) RayN shadow = packet.ray;
    intersect_packet(valid, scene.scene(), packet);
    occluded_packet(valid, scene.scene(), shadow);
    for (int i = 0; i < N; ++i) {
      const float tfar = single[i].ray.tfar;
      if (valid[i] == 0) {
        EXPECT_EQ(packet.hit.geomID[i], RTC_INVALID_GEOMETRY_ID);
        EXPECT_EQ(packet.hit.primID[i], RTC_INVALID_GEOMETRY_ID);
        EXPECT_EQ(packet.ray.tfar[i], tfar);
        EXPECT_EQ(shadow.tfar[i], tfar);
        continue;
      }
      intersect1(scene.scene(), single[i]);
      ASSERT_EQ(packet.hit.geomID[i], single[i].hit.geomID) << trial << " " << i;
      EXPECT_EQ(shadow.tfar[i], test::is_hit(single[i]) ? -kInfinity : tfar);
      EXPECT_EQ(packet.ray.tfar[i], single[i].ray.tfar);
      if (!test::is_hit(single[i])) continue;
      EXPECT_EQ(packet.hit.geomID[i], geometry);
      EXPECT_EQ(packet.hit.instID[0][i], RTC_INVALID_GEOMETRY_ID);
      EXPECT_EQ(packet.hit.u[i], 0.0f);
      EXPECT_NEAR(packet.hit.Ng_x[i], single[i].hit.Ng_x, 1e-5f);
      EXPECT_NEAR(packet.hit.Ng_y[i], single[i].hit.Ng_y, 1e-5f);
      EXPECT_NEAR(packet.hit.Ng_z[i], single[i].hit.Ng_z, 1e-5f);
    }
  }
}

TEST_F(ContractTest, InactiveRaysInPacketsOf4) {
  expect_packets_like_single_rays<RTCRayHit4, RTCRay4, 4>(scene_, id_);
}
TEST_F(ContractTest, InactiveRaysInPacketsOf8) {
  expect_packets_like_single_rays<RTCRayHit8, RTCRay8, 8>(scene_, id_);
}
TEST_F(ContractTest, InactiveRaysInPacketsOf16) {
  expect_packets_like_single_rays<RTCRayHit16, RTCRay16, 16>(scene_, id_);
}

// A filter that rejects everything sees every hit.
struct Collected {
  float t;
  unsigned primitive, geometry, instance;
};
thread_local std::vector<Collected> collected;
void collect(const RTCFilterFunctionNArguments* a) {
  for (unsigned i = 0; i < a->N; ++i) {
    if (a->valid[i] == 0) continue;
    collected.push_back({RTCRayN_tfar(a->ray, a->N, i), RTCHitN_primID(a->hit, a->N, i),
                         RTCHitN_geomID(a->hit, a->N, i), RTCHitN_instID(a->hit, a->N, i, 0)});
    a->valid[i] = 0;
  }
}

// Distinct hits by increasing t: one on a shared face may be offered by each brick.
std::vector<Collected> distinct_hits() {
  std::sort(collected.begin(), collected.end(),
            [](const Collected& a, const Collected& b) { return a.t < b.t; });
  std::vector<Collected> hits;
  for (const Collected& c : collected)
    if (hits.empty() || c.t - hits.back().t > 1e-5f * (1.0f + c.t)) hits.push_back(c);
  return hits;
}

TEST_F(ContractTest, MultiHit) {
  test::EmbreeScene scene;
  RTCGeometry g = geometry_->create(scene.device(), {.occlusion_filter = true});
  rtcSetGeometryIntersectFilterFunction(g, collect);
  rtcSetGeometryOccludedFilterFunction(g, collect);
  rtcCommitGeometry(g);
  const unsigned id = scene.attach(g);
  scene.commit();
  std::mt19937 random(21);
  for (int i = 0; i < 5000; ++i) {
    const Imath::V3f o = random_point(random, 1.5f), d = random_direction(random);
    const std::vector<double> expected = expected_hits(o, d);
    for (const bool occlusion : {false, true}) {
      collected.clear();
      if (occlusion)
        EXPECT_FALSE(scene.occluded(ray_of(o, d)));
      else
        EXPECT_FALSE(test::is_hit(scene.intersect(ray_of(o, d))));
      const std::vector<Collected> hits = distinct_hits();
      ASSERT_EQ(hits.size(), expected.size()) << i;
      for (std::size_t k = 0; k < hits.size(); ++k) {
        EXPECT_NEAR(hits[k].t, expected[k], 1e-6) << i;
        EXPECT_EQ(hits[k].geometry, id);
        EXPECT_LT(hits[k].primitive, geometry_->statistics().bricks);
        EXPECT_EQ(hits[k].instance, RTC_INVALID_GEOMETRY_ID);
      }
    }
  }
}

#if RTC_VERSION_MAJOR < 4
// A filter that comes with the query. (Embree 4 does not run one on user geometry.)
TEST_F(ContractTest, QueryFilter) {
  const Imath::V3f o(-3.0f, 0.011f, 0.023f), d(1.0f, 0.0f, 0.0f);
  for (const bool occlusion_filter : {false, true}) {
    test::EmbreeScene scene;
    scene.attach(geometry_->create(scene.device(), {.occlusion_filter = occlusion_filter}));
    rtcSetSceneFlags(scene.scene(), RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    scene.commit();
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.filter = collect;
    collected.clear();
    RTCRayHit h = make_ray_hit(ray_of(o, d));
    rtcIntersect1(scene.scene(), &context, &h);
    EXPECT_FALSE(test::is_hit(h));
    EXPECT_EQ(distinct_hits().size(), 2u);
    collected.clear();
    RTCRay shadow = ray_of(o, d);
    rtcOccluded1(scene.scene(), &context, &shadow);
    EXPECT_EQ(shadow.tfar, kInfinity) << occlusion_filter;
    EXPECT_EQ(distinct_hits().size(), 2u) << occlusion_filter;
  }
}
#endif

// An object in instances: transforms with row vectors, p' = p * m.
class InstanceTest : public ContractTest {
 protected:
  InstanceTest() : object_(rtcNewScene(world_.device())) {
    RTCGeometry g = geometry_->create(world_.device(), {.occlusion_filter = true});
    rtcSetGeometryIntersectFilterFunction(g, note);
    rtcSetGeometryOccludedFilterFunction(g, note);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(object_, g, 7);
    rtcReleaseGeometry(g);
    rtcCommitScene(object_);
  }
  ~InstanceTest() override { rtcReleaseScene(object_); }

  // Accepts, and keeps what it saw.
  static void note(const RTCFilterFunctionNArguments* a) {
    seen_instance_ = RTCHitN_instID(a->hit, a->N, 0, 0);
    seen_context_ = a->context->instID[0];
  }

  // A ray that starts at `o` along `d` in the world, against the ball behind `m`.
  void expect_like_closed_form(const Imath::M44f& m, const Imath::V3f& o, const Imath::V3f& d,
                               float time, unsigned instance, int& hits) {
    Imath::V3d lo, ld;
    const Imath::M44d inverse = Imath::M44d(m).inverse();
    inverse.multVecMatrix(Imath::V3d(o), lo);
    inverse.multDirMatrix(Imath::V3d(d), ld);
    const auto c = ball_->crossings(lo, ld);
    double t = -1.0;
    if (c) t = c->first > 0.0 ? c->first : c->second;
    RTCRay ray = ray_of(o, d);
    ray.time = time;
    const RTCRayHit h = world_.intersect(ray);
    // Rays within float's reach of touching may go either way.
    if (c && c->second - c->first < 1e-2) return;
    ASSERT_EQ(test::is_hit(h), t > 0.0);
    seen_instance_ = RTC_INVALID_GEOMETRY_ID;
    ASSERT_EQ(world_.occluded(ray), t > 0.0);
    if (!(t > 0.0)) return;
    ++hits;
    EXPECT_EQ(seen_instance_, instance);
    EXPECT_EQ(seen_context_, instance);
    EXPECT_EQ(h.hit.instID[0], instance);
    EXPECT_EQ(h.hit.geomID, 7u);
    EXPECT_LT(h.hit.primID, geometry_->statistics().bricks);
    EXPECT_NEAR(h.ray.tfar, t, 1e-4 * (1.0 + t));
    // Ng is in object space: outward there.
    const Imath::V3d outward = (lo + ld * t - ball_->centre()).normalized();
    const Imath::V3d ng(h.hit.Ng_x, h.hit.Ng_y, h.hit.Ng_z);
    EXPECT_GT(ng.normalized().dot(outward), 0.9999);
  }

  test::EmbreeScene world_;
  RTCScene object_;
  static thread_local inline unsigned seen_instance_ = 0, seen_context_ = 0;
};

TEST_F(InstanceTest, NonUniformScaleMirrorAndShear) {
  Imath::M44f scale, mirror, shear;
  scale.setScale(Imath::V3f(3.0f, 0.2f, 1.0f));
  mirror.setScale(Imath::V3f(-1.0f, 1.0f, 1.5f));
  shear.setShear(Imath::V3f(0.5f, -0.3f, 0.2f));
  std::mt19937 random(31);
  for (const Imath::M44f& m : {scale, mirror, shear, mirror * shear}) {
    const unsigned id = world_.attach_instance(object_, m);
    world_.commit();
    int hits = 0;
    for (int i = 0; i < 3000; ++i) {
      Imath::V3f target;
      m.multVecMatrix(Imath::V3f(ball_->centre()) + random_point(random, 0.8f), target);
      const Imath::V3f o = target + random_direction(random) * 4.0f;
      expect_like_closed_form(m, o, (target - o) * 0.3f, 0.0f, id, hits);
    }
    EXPECT_GT(hits, 1500);
    rtcDetachGeometry(world_.scene(), id);
  }
}

TEST_F(InstanceTest, MotionBlur) {
  RTCGeometry g = rtcNewGeometry(world_.device(), RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(g, object_);
  rtcSetGeometryTimeStepCount(g, 2);
  Imath::M44f from, to;
  from.setScale(Imath::V3f(1.0f, 0.5f, 1.0f));
  to.setScale(Imath::V3f(1.0f, 1.5f, 2.0f));
  to[3][0] = 2.0f;
  rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, from.x);
  rtcSetGeometryTransform(g, 1, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, to.x);
  accept_all_rays(g);
  rtcCommitGeometry(g);
  const unsigned id = world_.attach(g);
  world_.commit();
  std::mt19937 random(32);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  int hits = 0;
  for (int i = 0; i < 6000; ++i) {
    const float time = i % 10 == 0 ? 0.0f : i % 10 == 1 ? 1.0f : unit(random);
    Imath::M44f m;  // Embree interpolates the matrices
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) m[r][c] = (1.0f - time) * from[r][c] + time * to[r][c];
    Imath::V3f target;
    m.multVecMatrix(Imath::V3f(ball_->centre()) + random_point(random, 0.8f), target);
    const Imath::V3f o = target + random_direction(random) * 4.0f;
    expect_like_closed_form(m, o, target - o, time, id, hits);
  }
  EXPECT_GT(hits, 3000);
}

// Point queries walk the bounds that the geometry gives; the callback is the application's.
struct Query {
  std::set<unsigned> primitives;
  unsigned geometry = RTC_INVALID_GEOMETRY_ID;
  static bool visit(RTCPointQueryFunctionArguments* a) {
    auto& q = *static_cast<Query*>(a->userPtr);
    q.primitives.insert(a->primID);
    q.geometry = a->geomID;
    return false;
  }
};

TEST_F(ContractTest, PointQuery) {
  std::mt19937 random(41);
  for (int i = 0; i < 300; ++i) {
    const Imath::V3f p = random_point(random, 1.3f);
    const float radius = 0.05f + 0.001f * static_cast<float>(i);
    RTCPointQuery query;
    query.x = p.x;
    query.y = p.y;
    query.z = p.z;
    query.radius = radius;
    query.time = 0.0f;
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    Query found;
    rtcPointQuery(scene_.scene(), &query, &context, Query::visit, &found);
    // Every brick that comes within the radius is visited, and none that is far beyond it.
    double nearest_unvisited = 1e9;
    for (std::uint32_t b = 0; b < geometry_->statistics().bricks; ++b) {
      const topology::Box box = geometry_->primitive_bounds(b);
      Imath::V3d gap;
      for (int k = 0; k < 3; ++k)
        gap[k] = std::max(
            {box.min[k] - static_cast<double>(p[k]), 0.0, static_cast<double>(p[k]) - box.max[k]});
      if (found.primitives.count(b)) {
        EXPECT_LE(gap.length(), static_cast<double>(radius) + 1e-3);
        EXPECT_EQ(found.geometry, id_);
      } else {
        nearest_unvisited = std::min(nearest_unvisited, gap.length());
      }
    }
    EXPECT_GE(nearest_unvisited, static_cast<double>(radius) - 1e-6);
  }
}

TEST_F(ContractTest, Update) {
  // Another ball in the place of the first, under the same id.
  const auto other = std::make_shared<test::BallField>(Imath::V3d(0.0), 0.3);
  topology::CertifyOptions options;
  options.box = topology::dyadic_box({Imath::V3d(-1.0), Imath::V3d(1.0)});
  const HypertextureGeometry small(other, test::certified_cache(*other, options), {});
  const RTCRay ray = ray_of({-3, 0, 0}, {1, 0, 0});
  EXPECT_NEAR(scene_.intersect(ray).ray.tfar, ball_->crossings({-3, 0, 0}, {1, 0, 0})->first, 1e-6);
  rtcDetachGeometry(scene_.scene(), id_);
  RTCGeometry g = small.create(scene_.device());
  rtcAttachGeometryByID(scene_.scene(), g, id_);
  scene_.commit();
  EXPECT_NEAR(scene_.intersect(ray).ray.tfar, 2.7, 1e-6);
  // Committed again without a change: the same.
  rtcCommitGeometry(g);
  scene_.commit();
  EXPECT_NEAR(scene_.intersect(ray).ray.tfar, 2.7, 1e-6);
  // A mask that comes later counts after the commit.
  rtcSetGeometryMask(g, 0b10);
  rtcCommitGeometry(g);
  scene_.commit();
  RTCRay masked = ray;
  masked.mask = 0b01;
  EXPECT_FALSE(test::is_hit(scene_.intersect(masked)));
  EXPECT_FALSE(scene_.occluded(masked));
  rtcReleaseGeometry(g);
}

TEST_F(ContractTest, Detach) {
  const RTCRay ray = ray_of({-3, 0, 0}, {1, 0, 0});
  EXPECT_TRUE(test::is_hit(scene_.intersect(ray)));
  rtcDetachGeometry(scene_.scene(), id_);
  scene_.commit();
  EXPECT_FALSE(test::is_hit(scene_.intersect(ray)));
  EXPECT_FALSE(scene_.occluded(ray));
  // And again, in two scenes of the device at once.
  RTCGeometry g = geometry_->create(scene_.device());
  RTCScene second = rtcNewScene(scene_.device());
  rtcAttachGeometry(scene_.scene(), g);
  rtcAttachGeometry(second, g);
  rtcReleaseGeometry(g);
  scene_.commit();
  rtcCommitScene(second);
  EXPECT_TRUE(test::is_hit(scene_.intersect(ray)));
  RTCRayHit h = make_ray_hit(ray);
  intersect1(second, h);
  EXPECT_TRUE(test::is_hit(h));
  rtcReleaseScene(second);
}

std::atomic<long long> device_bytes{0}, device_peak{0};
bool monitor_bytes(void*, ssize_t bytes, bool) {
  const long long now = device_bytes += bytes;
  long long peak = device_peak;
  while (now > peak && !device_peak.compare_exchange_weak(peak, now)) {
  }
  return true;
}

TEST_F(ContractTest, MemoryConsumption) {
  RTCDevice device = rtcNewDevice(nullptr);
  device_bytes = device_peak = 0;
  rtcSetDeviceMemoryMonitorFunction(device, monitor_bytes, nullptr);
  for (int round = 0; round < 3; ++round) {
    RTCScene scene = rtcNewScene(device);
    RTCGeometry g = geometry_->create(device);
    rtcAttachGeometry(scene, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(scene);
    EXPECT_GT(device_bytes, 0);
    // A few hundred bytes a primitive while it is built, at most; plus what a scene costs.
    EXPECT_LT(device_peak, 1000 * static_cast<long long>(geometry_->statistics().bricks) + 4000000);
    rtcReleaseScene(scene);
    EXPECT_EQ(device_bytes, 0) << round;
  }
  EXPECT_EQ(rtcGetDeviceError(device), RTC_ERROR_NONE);
  rtcReleaseDevice(device);
}

TEST_F(ContractTest, BuildProgressAndCancellation) {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  RTCGeometry g = geometry_->create(device);
  rtcAttachGeometry(scene, g);
  rtcReleaseGeometry(g);
  static std::atomic<int> calls;
  static std::atomic<bool> go_on, in_range;
  calls = 0;
  go_on = in_range = true;
  rtcSetSceneProgressMonitorFunction(
      scene,
      [](void*, double fraction) {
        ++calls;
        if (!(fraction >= 0.0 && fraction <= 1.0 + 1e-9)) in_range = false;
        return go_on.load();
      },
      nullptr);
  go_on = false;
  rtcCommitScene(scene);
  EXPECT_GT(calls, 0);
  EXPECT_EQ(rtcGetDeviceError(device), RTC_ERROR_CANCELLED);
  // A later commit builds after all.
  go_on = true;
  rtcCommitScene(scene);
  EXPECT_EQ(rtcGetDeviceError(device), RTC_ERROR_NONE);
  EXPECT_TRUE(in_range);
  RTCRayHit h = make_ray_hit(ray_of({-3, 0, 0}, {1, 0, 0}));
  intersect1(scene, h);
  EXPECT_TRUE(test::is_hit(h));
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
}

TEST_F(ContractTest, ManyThreads) {
  constexpr int kRays = 20000, kThreads = 8;
  std::vector<RTCRay> rays;
  std::mt19937 random(51);
  for (int i = 0; i < kRays; ++i)
    rays.push_back(ray_of(random_point(random, 1.5f), random_direction(random)));
  std::vector<RTCRayHit> expected(kRays);
  for (int i = 0; i < kRays; ++i) expected[i] = scene_.intersect(rays[i]);
  std::atomic<int> different{0};
  std::vector<std::thread> threads;
  for (int k = 0; k < kThreads; ++k)
    threads.emplace_back([&, k] {
      for (int i = 0; i < kRays; ++i) {
        const int j = (i + k * kRays / kThreads) % kRays;
        const RTCRayHit h = scene_.intersect(rays[j]);
        if (h.ray.tfar != expected[j].ray.tfar || h.hit.primID != expected[j].hit.primID ||
            h.hit.Ng_x != expected[j].hit.Ng_x ||
            scene_.occluded(rays[j]) != test::is_hit(expected[j]))
          ++different;
      }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(different, 0);
}

TEST_F(ContractTest, CommitsWhileOthersTraceAndBuild) {
  // One thread traces the first scene; others make, commit and drop scenes of the same device.
  std::atomic<bool> stop{false};
  std::atomic<int> wrong{0};
  std::thread tracer([&] {
    std::mt19937 random(61);
    while (!stop) {
      const Imath::V3f o = random_point(random, 1.5f), d = random_direction(random);
      const std::vector<double> expected = expected_hits(o, d);
      const RTCRayHit h = scene_.intersect(ray_of(o, d));
      if (test::is_hit(h) != !expected.empty()) ++wrong;
    }
  });
  tbb::parallel_for(0, 40, [&](int) {
    RTCScene scene = rtcNewScene(scene_.device());
    RTCGeometry g = geometry_->create(scene_.device());
    rtcAttachGeometry(scene, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(scene);
    RTCRayHit h = make_ray_hit(ray_of({-3, 0, 0}, {1, 0, 0}));
    intersect1(scene, h);
    if (!test::is_hit(h)) ++wrong;
    rtcReleaseScene(scene);
  });
  stop = true;
  tracer.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace morsel::geom
