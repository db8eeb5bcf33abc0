// SPDX-License-Identifier: Apache-2.0
// Rays per second and their cost on equation (13): bench_rays LAYERS [CACHE FILE] [SOLVER] [mesh].
// A cache that is not there, or of another field, is built and written. SOLVER is model, segment or
// sphere. With `mesh` the same rays are traced against triangles of the same surface, whose error
// is at most 1e-4 of the object's size. Not a test; figures are in
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
#include <string>
#include <vector>

#include "hypertexture_geom/embree/ray_surface.h"
#include "tests/hypertexture_geom/embree_scene.h"
#include "tests/hypertexture_geom/eq13.h"
#include "topology/components.h"
#include "topology/mesh/mesh.h"

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

// trace(i) returns whether ray i hits. Returns millions of rays a second and core.
template <class Trace>
double measure(const char* name, std::size_t rays, const Trace& trace) {
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
  return n / seconds * 1e-6;
}

// Triangles of the kept surface, in a scene.
struct TriangleScene {
  test::EmbreeScene scene;
  double seconds = 0.0;
  long long bytes = 0;

  TriangleScene(const HypertextureGeometry& geometry, const topology::Topology& t,
                const topology::KeepRule& keep) {
    const double start = now();
    topology::MeshOptions options;
    options.error = 1e-4 * (geometry.bounds().max - geometry.bounds().min).length();
    const topology::Mesh mesh =
        topology::extract_mesh(geometry.field(), t.octree(),
                               topology::kept_components(keep, t.components, t.octree()), options);
    embree_bytes = 0;
    rtcSetDeviceMemoryMonitorFunction(scene.device(), count_bytes, nullptr);
    RTCGeometry g = rtcNewGeometry(scene.device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* p = static_cast<float*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    for (const Imath::V3d& x : mesh.positions)
      for (int i = 0; i < 3; ++i) *p++ = static_cast<float>(x[i]);
    auto* k = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t i : triangle) *k++ = i;
    accept_all_rays(g);
    rtcCommitGeometry(g);
    scene.attach(g);
    scene.commit();
    seconds = now() - start;
    bytes = embree_bytes;
    fmt::print("mesh: {} triangles, error {:.2g}, {:.2f} s, {:.1f} MB in Embree\n",
               mesh.triangles.size(), mesh.error_bound, seconds, static_cast<double>(bytes) * 1e-6);
  }
};

void run(int layers, const std::filesystem::path& cache_path, Solver solver, bool with_mesh) {
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
  GeometryOptions options;
  options.keep = rock.keep;
  options.solver = solver;
  const HypertextureGeometry geometry(rock.field, cache, options);
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
  const double ready_seconds = bricks_seconds + now() - start;
  const double all_bytes = geometry_bytes + static_cast<double>(embree_bytes.load());
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
  const double primary_rate = measure("primary", hits.size(), primary);

  // From just above the surface (farther than the mesh errs), cosine distributed, in random order.
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
    starts.push_back(
        {p.spawn_front + p.normal * (2e-4f * size), (w.normalized() + p.normal).normalized()});
  }
  fmt::print("shading: {:.2f} us a point\n",
             (now() - start) / static_cast<double>(starts.size()) * 1e6);
  std::shuffle(starts.begin(), starts.end(), random);
  const auto incoherent = [&](const test::EmbreeScene& where) {
    return [&starts, &where](std::size_t i) {
      return test::is_hit(where.intersect(test::ray_of(starts[i].origin, starts[i].direction)));
    };
  };
  const auto shadow = [&](const test::EmbreeScene& where) {
    return [&starts, &where](std::size_t i) {
      return where.occluded(test::ray_of(starts[i].origin, starts[i].direction));
    };
  };
  const double incoherent_rate = measure("incoherent", starts.size(), incoherent(scene));
  const double shadow_rate = measure("shadow", starts.size(), shadow(scene));
  if (!with_mesh) return;

  const TriangleScene triangles(geometry, cache->topology, rock.keep);
  const double primary_mesh = measure("  primary", hits.size(), [&](std::size_t i) {
    RTCRayHit h = make_ray_hit(hits[i].ray);
    h.ray.tfar = std::numeric_limits<float>::infinity();
    intersect1(triangles.scene.scene(), h, Coherence::kCoherent);
    return test::is_hit(h);
  });
  const double incoherent_mesh =
      measure("  incoherent", starts.size(), incoherent(triangles.scene));
  const double shadow_mesh = measure("  shadow", starts.size(), shadow(triangles.scene));
  fmt::print(
      "hypertexture / mesh: primary {:.2f}, incoherent {:.2f}, shadow {:.2f}, memory 1/{:.1f}, "
      "ready "
      "after labelling 1/{:.1f}\n",
      primary_rate / primary_mesh, incoherent_rate / incoherent_mesh, shadow_rate / shadow_mesh,
      static_cast<double>(triangles.bytes) / all_bytes, triangles.seconds / ready_seconds);
}

}  // namespace
}  // namespace morsel::geom

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: bench_rays LAYERS [CACHE FILE] [model|segment|sphere] [mesh]\n");
    return 2;
  }
  using morsel::geom::Solver;
  const std::string solver = argc > 3 ? argv[3] : "model";
  morsel::geom::run(std::atoi(argv[1]), argc > 2 ? argv[2] : "",
                    solver == "sphere"    ? Solver::kSphere
                    : solver == "segment" ? Solver::kSegment
                                          : Solver::kModel,
                    argc > 4 && std::string(argv[4]) == "mesh");
  return 0;
}
