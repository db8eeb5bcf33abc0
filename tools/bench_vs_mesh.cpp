// SPDX-License-Identifier: Apache-2.0
#include "tools/bench_vs_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/bench_numbers.h"
#include "tools/bench_rays.h"
#include "tools/bench_surfaces.h"
#include "topology/mesh/mesh.h"

namespace morsel::tools {
namespace {

constexpr struct {
  const char* name;
  geom::Solver solver;
} kSolvers[] = {{"sphere", geom::Solver::kSphere},
                {"segment", geom::Solver::kSegment},
                {"model", geom::Solver::kModel}};

// Rays whose evaluations are counted: the sphere solver takes a hundred times as long as others.
constexpr std::size_t kEvaluationRays = 1 << 14;

RaySet sample_of(const RaySet& set, std::size_t count) {
  RaySet some{set.name, {}, set.coherent, set.shadow};
  const std::size_t stride = std::max<std::size_t>(1, set.rays.size() / count);
  for (std::size_t i = stride / 2; i < set.rays.size(); i += stride)
    some.rays.push_back(set.rays[i]);
  return some;
}

// Share of the rays that only one of the two surfaces stops, and of those that both stop at
// distances that differ by more than `tolerance`.
nlohmann::json disagreement(const std::vector<float>& a, const std::vector<float>& b,
                            double tolerance) {
  std::size_t hits = 0, distances = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isinf(a[i]) != std::isinf(b[i]))
      ++hits;
    else if (!std::isinf(a[i]) && std::abs(double{a[i]} - double{b[i]}) > tolerance)
      ++distances;
  }
  const auto n = static_cast<double>(a.size());
  return {{"one_hits", static_cast<double>(hits) / n},
          {"far_apart", static_cast<double>(distances) / n}};
}

nlohmann::json describe(const BenchSurface& s) {
  return {{"geometry_bytes", s.geometry_bytes},
          {"bvh_bytes", s.bvh_bytes},
          {"geometry_seconds", s.geometry_seconds},
          {"bvh_seconds", s.bvh_seconds}};
}

}  // namespace

nlohmann::json bench_vs_mesh(const geom::Hypertexture& hypertexture, const VsMeshOptions& options,
                             const topology::Execution& execution, Reporter& reporter) {
  const auto say = [&](const std::string& what) { reporter.info(hypertexture.name + ": " + what); };

  say("labelling");
  double start = processor_seconds();
  const auto cache =
      std::make_shared<const topology::TopologyCache>(geom::build_cache(hypertexture, execution));
  const double cache_seconds = processor_seconds() - start;
  const topology::Topology& t = cache->topology;
  const std::vector<bool> kept =
      topology::kept_components(hypertexture.keep, t.components, t.octree());
  const topology::Box box = kept_bounds(t, kept);
  const double size = (box.max - box.min).length();

  say("meshing");
  const double mesh_error = options.error * size;
  start = processor_seconds();
  const topology::Mesh mesh = mesh_kept(hypertexture, t, options.error, execution);
  const double mesh_seconds = processor_seconds() - start;

  say("building");
  const BenchSurface triangles = trace_mesh(mesh);
  std::vector<BenchSurface> solvers;
  for (const auto& s : kSolvers) {
    geom::GeometryOptions geometry;
    geometry.keep = hypertexture.keep;
    geometry.solver = s.solver;
    solvers.push_back(trace_hypertexture(hypertexture.field, cache, geometry));
  }
  const BenchSurface& ours = solvers.back();

  const RaySet primary = primary_rays(box, options.side);
  const double offset = 2.0 * mesh_error;  // above both surfaces
  const RaySet sets[] = {
      primary, secondary_rays(*ours.hypertexture, ours.scene.get(), primary, offset, false),
      secondary_rays(*ours.hypertexture, ours.scene.get(), primary, offset, true)};

  nlohmann::json vs_mesh, evaluations, per_kind;
  for (const RaySet& set : sets) {
    say("tracing " + set.name);
    std::vector<double> ratios, our_rate, mesh_rate;
    std::vector<float> our_t, mesh_t;
    trace(ours.scene.get(), set, &our_t);  // also warms up
    trace(triangles.scene.get(), set, &mesh_t);
    RayCost cost;
    for (int i = 0; i < options.repetitions; ++i) {
      if (execution.cancel != nullptr && execution.cancel->load()) throw topology::Cancelled();
      cost = trace(ours.scene.get(), set);
      const RayCost other = trace(triangles.scene.get(), set);
      our_rate.push_back(cost.rays_per_second());
      mesh_rate.push_back(other.rays_per_second());
      ratios.push_back(cost.rays_per_second() / other.rays_per_second());
    }
    vs_mesh[set.name] = median(ratios);
    vs_mesh["spread"][set.name] = spread(ratios);
    vs_mesh["rays"][set.name] = set.rays.size();
    vs_mesh["hits"][set.name] = static_cast<double>(cost.hits) / static_cast<double>(cost.rays);
    vs_mesh["rays_per_second"][set.name] = {{"hypertexture", median(our_rate)},
                                            {"mesh", median(mesh_rate)}};
    if (!set.shadow) vs_mesh["differs"][set.name] = disagreement(our_t, mesh_t, 4.0 * mesh_error);
    const RaySet some = sample_of(set, kEvaluationRays);
    for (std::size_t k = 0; k < solvers.size(); ++k) {
      const RayCost c = trace(solvers[k].scene.get(), some);
      per_kind[set.name][kSolvers[k].name] = c.evaluations_per_ray();
      if (set.name == "primary") evaluations[kSolvers[k].name] = c.evaluations_per_ray();
    }
  }
  const double our_ready = cache_seconds + ours.geometry_seconds + ours.bvh_seconds;
  const double mesh_ready = mesh_seconds + triangles.bvh_seconds;
  vs_mesh["memory"] = static_cast<double>(ours.bytes()) / static_cast<double>(triangles.bytes());
  vs_mesh["ready_time"] = our_ready / mesh_ready;
  vs_mesh["error"] = mesh_error;
  vs_mesh["relative_error"] = options.error;
  vs_mesh["size"] = size;
  vs_mesh["hypertexture"] = describe(ours);
  vs_mesh["hypertexture"]["cache_seconds"] = cache_seconds;
  vs_mesh["hypertexture"]["bricks"] = ours.hypertexture->statistics().bricks;
  vs_mesh["hypertexture"]["limits"] = ours.hypertexture->statistics().limits;
  vs_mesh["mesh"] = describe(triangles);
  vs_mesh["mesh"]["mesh_seconds"] = mesh_seconds;
  vs_mesh["mesh"]["triangles"] = mesh.triangles.size();
  vs_mesh["mesh"]["error_bound"] = mesh.error_bound;
  return {{"geometry", hypertexture.name},
          {"vs_mesh", vs_mesh},
          {"evaluations_per_ray", evaluations},
          {"evaluations_per_ray_of", per_kind}};
}

}  // namespace morsel::tools
