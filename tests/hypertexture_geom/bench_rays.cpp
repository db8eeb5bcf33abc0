// SPDX-License-Identifier: Apache-2.0
// What one solver's rays cost on equation (13), for profilers:
//   bench_rays LAYERS CACHE [model|segment|sphere] [primary|incoherent|shadow|all] [REPETITIONS]
// The rays are those of `morsel bench` (1024 x 1024 primary ones); the triangles that they are to
// be compared with are its business. A cache that is not there, or of another field, is built and
// written. Not a test.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "renderer/accel/embree_handles.h"
#include "tests/hypertexture_geom/eq13.h"
#include "tools/bench_rays.h"
#include "tools/bench_surfaces.h"

namespace morsel {
namespace {

void run(int layers, const std::filesystem::path& cache_path, geom::Solver solver,
         const std::string& kind, int repetitions) {
  const geom::Hypertexture rock = geom::test::eq13(layers);
  auto cache = std::make_shared<topology::TopologyCache>();
  try {
    *cache = topology::read_cache_of(cache_path, rock.hash);
  } catch (const topology::CacheError&) {
    *cache = geom::build_cache(rock);
    topology::write_cache(*cache, cache_path);
  }
  geom::GeometryOptions options;
  options.keep = rock.keep;
  options.solver = solver;
  const tools::BenchSurface surface = tools::trace_hypertexture(rock.field, cache, options);
  const geom::GeometryStatistics s = surface.hypertexture->statistics();
  fmt::print(
      "{} bricks in {} blocks: {:.1f} MB of geometry in {:.2f} s, {:.1f} MB of hierarchy in {:.2f} "
      "s\n",
      s.bricks, s.blocks, 1e-6 * static_cast<double>(surface.geometry_bytes),
      surface.geometry_seconds, 1e-6 * static_cast<double>(surface.bvh_bytes), surface.bvh_seconds);

  const topology::Box box = surface.hypertexture->bounds();
  const double offset = 2e-4 * (box.max - box.min).length();
  const tools::RaySet primary = tools::primary_rays(box, 1024);
  const auto measure = [&](const tools::RaySet& set) {
    if (kind != "all" && kind != set.name) return;
    for (int i = 0; i < repetitions; ++i) {
      const tools::RayCost c = tools::trace(surface.scene.get(), set);
      const auto n = static_cast<double>(c.rays);
      fmt::print(
          "{:<11} {:6.3f} Mrays/s a core  hits {:5.1f} %  per ray: {:5.2f} bricks, {:5.2f} "
          "evaluations\n",
          set.name, 1e-6 * c.rays_per_second(), 100.0 * static_cast<double>(c.hits) / n,
          static_cast<double>(c.bricks) / n, c.evaluations_per_ray());
    }
  };
  measure(primary);
  for (const bool shadow : {false, true})
    if (kind == "all" || kind == (shadow ? "shadow" : "incoherent"))
      measure(tools::secondary_rays(*surface.hypertexture, surface.scene.get(), primary, offset,
                                    shadow));
}

}  // namespace
}  // namespace morsel

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr,
               "usage: bench_rays LAYERS CACHE [model|segment|sphere] "
               "[primary|incoherent|shadow|all] [REPETITIONS]\n");
    return 2;
  }
  using morsel::geom::Solver;
  const std::string solver = argc > 3 ? argv[3] : "model";
  morsel::run(std::atoi(argv[1]), argv[2],
              solver == "sphere"    ? Solver::kSphere
              : solver == "segment" ? Solver::kSegment
                                    : Solver::kModel,
              argc > 4 ? argv[4] : "all", argc > 5 ? std::atoi(argv[5]) : 1);
  return 0;
}
