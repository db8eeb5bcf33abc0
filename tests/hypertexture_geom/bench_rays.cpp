// SPDX-License-Identifier: Apache-2.0
// Rays per second and their cost on equation (13): bench_rays LAYERS [CACHE FILE]. A cache that is
// not there, or of another field, is built and written. Not a test; figures are in
// hypertexture_geom/embree/README.md.
#include <Imath/ImathVec.h>
#include <fmt/format.h>
#include <malloc.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <time.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <vector>

#include "hypertexture_geom/embree/ray_surface.h"
#include "tests/hypertexture_geom/embree_scene.h"
#include "tests/hypertexture_geom/eq13.h"

namespace morsel::geom {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

std::atomic<long long> embree_bytes{0};
bool count_bytes(void*, ssize_t bytes, bool) {
  embree_bytes += bytes;
  return true;
}

// Processor time of all threads: what other processes do on the machine matters less.
double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Cost {
  std::size_t rays = 0, hits = 0;
  RayStatistics work;
  Cost operator+(const Cost& o) const {
    Cost c = *this;
    c.rays += o.rays;
    c.hits += o.hits;
    c.work.bricks += o.work.bricks;
    c.work.evaluations += o.work.evaluations;
    c.work.limits += o.work.limits;
    return c;
  }
};

// trace(i) returns whether ray i hits.
template <class Trace>
void measure(const char* name, std::size_t rays, const Trace& trace) {
  const double start = cpu_seconds();
  const Cost cost = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, rays, 4096), Cost{},
      [&](const tbb::blocked_range<std::size_t>& range, Cost c) {
        const RayStatistics before = ray_statistics();
        for (std::size_t i = range.begin(); i < range.end(); ++i) c.hits += trace(i) ? 1 : 0;
        c.rays += range.size();
        c.work.bricks += ray_statistics().bricks - before.bricks;
        c.work.evaluations += ray_statistics().evaluations - before.evaluations;
        c.work.limits += ray_statistics().limits - before.limits;
        return c;
      },
      std::plus<>());
  const double seconds = cpu_seconds() - start;
  const auto n = static_cast<double>(cost.rays);
  fmt::print(
      "{:<11} {:6.3f} Mrays/s a core  hits {:5.1f} %  per ray: {:5.2f} bricks, {:5.2f} "
      "evaluations; "
      "limits {}\n",
      name, n / seconds * 1e-6, 100.0 * static_cast<double>(cost.hits) / n,
      static_cast<double>(cost.work.bricks) / n, static_cast<double>(cost.work.evaluations) / n,
      cost.work.limits);
}

void run(int layers, const std::filesystem::path& cache_path) {
  double start = now();
  const Hypertexture rock = test::eq13(layers);
  auto cache = std::make_shared<topology::TopologyCache>();
  try {
    *cache = topology::read_cache_of(cache_path, rock.hash);
  } catch (const topology::CacheError&) {
    *cache = build_cache(rock);
    if (!cache_path.empty()) topology::write_cache(*cache, cache_path);
  }
  fmt::print("layers {}: topology {:.2f} s, {} leaves, {} components\n", layers, now() - start,
             cache->topology.leaves, cache->topology.components.size());

  const double heap = heap_bytes();
  start = now();
  const HypertextureGeometry geometry(rock.field, cache, {});
  const double bricks_seconds = now() - start, geometry_bytes = heap_bytes() - heap;
  const GeometryStatistics s = geometry.statistics();
  fmt::print("bricks: {:.2f} s, {} bricks, {} blocks, {:.1f} MB, {:.0f} bytes a brick\n",
             bricks_seconds, s.bricks, s.blocks, geometry_bytes * 1e-6,
             geometry_bytes / static_cast<double>(s.bricks));

  test::EmbreeScene scene;
  rtcSetDeviceMemoryMonitorFunction(scene.device(), count_bytes, nullptr);
  start = now();
  scene.attach(geometry.create(scene.device()));
  scene.commit();
  fmt::print("embree: {:.2f} s, {:.1f} MB\n", now() - start,
             static_cast<double>(embree_bytes.load()) * 1e-6);

  // A pinhole camera that frames the object, 1 ray a pixel, in tiles of 64 x 64.
  constexpr int kSide = 1024, kTile = 64;
  const topology::Box box = geometry.bounds();
  const Imath::V3f centre(topology::centre(box));
  const float size = static_cast<float>((box.max - box.min).length());
  const Imath::V3f eye = centre + Imath::V3f(0.3f, 0.4f, 1.0f).normalized() * (1.6f * size);
  const Imath::V3f forward = (centre - eye).normalized();
  const Imath::V3f right = forward.cross(Imath::V3f(0, 1, 0)).normalized();
  const Imath::V3f up = right.cross(forward);
  std::vector<RTCRayHit> hits(kSide * kSide);
  const auto primary = [&](std::size_t i) {
    const auto tile = static_cast<int>(i) / (kTile * kTile);
    const auto within = static_cast<int>(i) % (kTile * kTile);
    const int x = tile % (kSide / kTile) * kTile + within % kTile;
    const int y = tile / (kSide / kTile) * kTile + within / kTile;
    const float u = (static_cast<float>(x) + 0.5f) / kSide - 0.5f;
    const float v = (static_cast<float>(y) + 0.5f) / kSide - 0.5f;
    const Imath::V3f d = (forward + right * (0.45f * u) + up * (0.45f * v)).normalized();
    hits[i] = make_ray_hit(test::ray_of(eye, d));
    intersect1(scene.scene(), hits[i], Coherence::kCoherent);
    return test::is_hit(hits[i]);
  };
  measure("primary", hits.size(), primary);

  // From the surface, cosine distributed, in random order.
  struct Start {
    Imath::V3f origin, direction;
  };
  std::vector<Start> starts;
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  start = now();
  for (const RTCRayHit& h : hits) {
    if (!test::is_hit(h)) continue;
    const Imath::V3f d(h.ray.dir_x, h.ray.dir_y, h.ray.dir_z);
    const ShadingPoint p = geometry.shade(h.hit.primID, eye + d * h.ray.tfar);
    const Imath::V3f w(normal(random), normal(random), normal(random));
    starts.push_back({p.spawn_front, (w.normalized() + p.normal).normalized()});
  }
  fmt::print("shading: {:.2f} us a point\n",
             (now() - start) / static_cast<double>(starts.size()) * 1e6);
  std::shuffle(starts.begin(), starts.end(), random);
  measure("incoherent", starts.size(), [&](std::size_t i) {
    return test::is_hit(scene.intersect(test::ray_of(starts[i].origin, starts[i].direction)));
  });
  measure("shadow", starts.size(), [&](std::size_t i) {
    return scene.occluded(test::ray_of(starts[i].origin, starts[i].direction));
  });
}

}  // namespace
}  // namespace morsel::geom

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: bench_rays LAYERS [CACHE FILE]\n");
    return 2;
  }
  morsel::geom::run(std::atoi(argv[1]), argc > 2 ? argv[2] : "");
  return 0;
}
