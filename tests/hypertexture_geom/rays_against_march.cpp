// SPDX-License-Identifier: Apache-2.0
#include "tests/hypertexture_geom/rays_against_march.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <random>
#include <vector>

#include "tests/hypertexture_geom/embree_scene.h"
#include "tests/hypertexture_geom/ray_oracle.h"

namespace morsel::geom::test {
namespace {

// Ray `i`: its kind goes round, its numbers depend on `i` alone.
RTCRay random_ray(int i, const topology::Box& box) {
  std::mt19937 random(static_cast<unsigned>(i) * 2654435761u + 17u);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::normal_distribution<float> normal;
  const Imath::V3f lo(box.min), size(box.max - box.min);
  const auto point = [&] {
    const float x = unit(random), y = unit(random), z = unit(random);
    return Imath::V3f(lo.x + size.x * x, lo.y + size.y * y, lo.z + size.z * z);
  };
  const auto direction = [&] {
    Imath::V3f d;
    do {
      d.x = normal(random);
      d.y = normal(random);
      d.z = normal(random);
    } while (d.length2() < 1e-4f);
    return d.normalized();
  };
  Imath::V3f o, d;
  switch (i % 4) {
    case 0:  // from outside towards a point in the box
      d = direction();
      o = point() - d * (size.length() * (1.0f + 2.0f * unit(random)));
      break;
    case 1:  // from anywhere in the box, inside the solid and outside
      o = point();
      d = direction();
      break;
    case 2: {  // along an axis, from within or without
      const int axis = i / 4 % 3;
      o = point();
      d = Imath::V3f(0.0f);
      d[axis] = i / 12 % 2 ? 1.0f : -1.0f;
      if (i / 24 % 2) o[axis] -= d[axis] * 2.0f * size[axis];
      // Some of them run in the planes between octree cells.
      if (i / 48 % 4 == 0) {
        const int other = (axis + 1) % 3;
        o[other] = lo[other] + size[other] * std::round(64.0f * unit(random)) / 64.0f;
      }
      break;
    }
    default:  // two zero-ish components and a far origin
      d = direction();
      d[i / 4 % 3] *= 1e-6f;
      o = point() - d * (10.0f * size.length());
  }
  if (i % 3 == 0) d *= std::exp2(16.0f * unit(random) - 8.0f);
  return ray_of(o, d);
}

struct Counts {
  int hits = 0, misses = 0;
  int missed = 0, spurious = 0, wrong_distance = 0, wrong_occlusion = 0, wrong_component = 0;
  int grazing = 0;     // the march stepped over two roots that finer steps show
  int ambiguous = 0;   // |F| stays below kAmbiguous at the place in question
  double worst = 0.0;  // distance between the two hits, beyond the rounding of t to float

  void add(const Counts& c) {
    hits += c.hits;
    misses += c.misses;
    missed += c.missed;
    spurious += c.spurious;
    wrong_distance += c.wrong_distance;
    wrong_occlusion += c.wrong_occlusion;
    wrong_component += c.wrong_component;
    grazing += c.grazing;
    ambiguous += c.ambiguous;
    worst = std::max(worst, c.worst);
  }
};

constexpr double kAmbiguous = 1e-10;

void compare(const RTCRay& ray, const EmbreeScene& scene, const HypertextureGeometry& geometry,
             const RayOracle& oracle, double object_size, Counts& c) {
  const Imath::V3d o(ray.org_x, ray.org_y, ray.org_z), d(ray.dir_x, ray.dir_y, ray.dir_z);
  const double speed = d.length();
  const RTCRayHit found = scene.intersect(ray);
  const std::optional<RayOracle::Crossing> expected = oracle.first_hit(o, d);
  const bool hit = is_hit(found);
  if (scene.occluded(ray) != hit) ++c.wrong_occlusion;
  ++(hit ? c.hits : c.misses);
  if (!hit && !expected) return;
  const double t = found.ray.tfar;
  const double rounding = hit ? 0x1p-23 * std::abs(t) * speed : 0.0;
  const double difference = hit && expected ? std::abs(t - expected->t) * speed : 0.0;
  if (hit && expected && difference <= 1e-4 * object_size + rounding) {
    c.worst = std::max(c.worst, difference - rounding);
    if (geometry.component_at(found.hit.primID, o + d * t) != expected->component)
      ++c.wrong_component;
    return;
  }
  if (hit && (!expected || t < expected->t)) {
    // Is there a root of a kept component that the march stepped over?
    const double radius = oracle.step() + rounding;
    if (oracle.changes_sign_near(o, d, t, radius) && oracle.label(o + d * t).kept) {
      ++c.grazing;
    } else if (oracle.least_value_near(o, d, t, radius) < kAmbiguous) {
      ++c.ambiguous;
    } else {
      ++(expected ? c.wrong_distance : c.spurious);
    }
    return;
  }
  if (oracle.least_value_near(o, d, expected->t, 1e-9) > kAmbiguous ||
      oracle.changes_sign_near(o, d, expected->t, 1e-7)) {
    ++(hit ? c.wrong_distance : c.missed);
  } else {
    ++c.ambiguous;
  }
}

}  // namespace

void compare_with_march(const Hypertexture& rock, double kernel_radius, int rays,
                        const MarchOptions& options) {
  auto cache = std::make_shared<topology::TopologyCache>(build_cache(rock));
  const HypertextureGeometry geometry(rock.field, cache, {.keep = rock.keep});
  ASSERT_GT(geometry.statistics().bricks, 100u);
  // The debris is what the filter is about.
  ASSERT_GE(cache->topology.components.size(), options.least_components);
  EmbreeScene scene;
  scene.attach(geometry.create(scene.device()));
  scene.commit();
  const RayOracle oracle(
      *rock.field, cache->topology,
      topology::kept_components(rock.keep, cache->topology.components, cache->topology.octree()),
      1e-3 * kernel_radius);
  const double object_size = (geometry.bounds().max - geometry.bounds().min).length();

  // The same surface by other means, and how many rays apart they are traced.
  struct Other {
    Other(const Hypertexture& h, std::shared_ptr<const topology::TopologyCache> c, Solver solver,
          Membership membership, int ray_step)
        : geometry(h.field, std::move(c), options_of(h, solver, membership)), step(ray_step) {
      scene.attach(geometry.create(scene.device()));
      scene.commit();
    }
    static GeometryOptions options_of(const Hypertexture& h, Solver solver, Membership membership) {
      GeometryOptions o;
      o.keep = h.keep;
      o.solver = solver;
      o.membership = membership;
      o.check_bounds = true;
      return o;
    }
    HypertextureGeometry geometry;
    EmbreeScene scene;
    int step;
    std::atomic<int> traced{0}, different{0};

    void report(const RTCRay& ray, const RTCRayHit& model, const RTCRayHit& own) {
      if (++different > 20) return;
      const auto text = [](const RTCRayHit& h) {
        return is_hit(h) ? fmt::format("a hit at {:.9g}", h.ray.tfar) : std::string("no hit");
      };
      fmt::print(
          "  differs: from {:.9g} {:.9g} {:.9g} towards {:.9g} {:.9g} {:.9g}, {:.9g} to {:.9g}: "
          "{}, not {}\n",
          ray.org_x, ray.org_y, ray.org_z, ray.dir_x, ray.dir_y, ray.dir_z, ray.tnear, ray.tfar,
          text(own), text(model));
    }
  };
  std::vector<std::unique_ptr<Other>> others;
  if (options.solvers) {
    others.push_back(
        std::make_unique<Other>(rock, cache, Solver::kSegment, Membership::kLabels, 10));
    others.push_back(
        std::make_unique<Other>(rock, cache, Solver::kSphere, Membership::kLabels, 50));
  }
  if (options.streamline)
    others.push_back(
        std::make_unique<Other>(rock, cache, Solver::kModel, Membership::kStreamline, 100));

  Counts total;
  std::mutex mutex;
  constexpr int kChunk = 256;
  tbb::parallel_for(0, (rays + kChunk - 1) / kChunk, [&](int chunk) {
    Counts c;
    for (int i = chunk * kChunk; i < std::min(rays, (chunk + 1) * kChunk); ++i) {
      const RTCRay ray = random_ray(i, cache->topology.box);
      compare(ray, scene, geometry, oracle, object_size, c);
      for (const auto& other : others) {
        if (i % other->step) continue;
        ++other->traced;
        const RTCRayHit a = scene.intersect(ray), b = other->scene.intersect(ray);
        const double speed = Imath::V3d(ray.dir_x, ray.dir_y, ray.dir_z).length();
        const double reach = 1e-6 * (object_size + static_cast<double>(a.ray.tfar) * speed);
        if (is_hit(a) != is_hit(b) ||
            (is_hit(a) && std::abs(static_cast<double>(a.ray.tfar - b.ray.tfar)) * speed > reach))
          other->report(ray, a, b);
      }
    }
    const std::scoped_lock lock(mutex);
    total.add(c);
  });

  fmt::print(
      "{} rays: {} hits, {} misses; missed {}, false {}, wrong distance {}, wrong occlusion {}, "
      "wrong component {}, grazing {}, ambiguous {}; worst distance {:.2e} of an object of size "
      "{:.3f}\n",
      rays, total.hits, total.misses, total.missed, total.spurious, total.wrong_distance,
      total.wrong_occlusion, total.wrong_component, total.grazing, total.ambiguous, total.worst,
      object_size);
  for (const auto& other : others) {
    const bool paper = other->geometry.statistics().bricks != 1 && other->step == 100;
    fmt::print("  {}: {} of {} rays differ\n",
               paper               ? "streamline filter"
               : other->step == 10 ? "segment"
                                   : "sphere",
               other->different.load(), other->traced.load());
    EXPECT_LE(other->different, paper ? other->traced / 1000 + 1 : 0);
    EXPECT_EQ(other->geometry.statistics().violations, 0u);
    EXPECT_EQ(other->geometry.statistics().limits, 0u);
  }
  EXPECT_GT(total.hits, rays / 50);
  EXPECT_GT(total.misses, rays / 50);
  EXPECT_EQ(total.missed, 0);
  EXPECT_EQ(total.spurious, 0);
  EXPECT_EQ(total.wrong_distance, 0);
  EXPECT_EQ(total.wrong_occlusion, 0);
  EXPECT_EQ(total.wrong_component, 0);
  EXPECT_LT(total.worst, 1e-6 * object_size);
  EXPECT_LE(total.ambiguous, rays / 100000);
  EXPECT_EQ(geometry.statistics().limits, 0u);
}

}  // namespace morsel::geom::test
