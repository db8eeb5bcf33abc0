// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hypertexture_geom/embree/compat.h"  // the only place that includes Embree's headers
#include "hypertexture_geom/embree/shading.h"
#include "hypertexture_geom/field/field.h"
#include "hypertexture_geom/field/ray_options.h"
#include "topology/cache_file.h"

namespace morsel::geom {

// Bricks of one run for the next: making them takes longer than labels do (brick_file.h).
struct BrickKeeping {
  // Files' names begin with this, usually the topology cache's without its extension; empty: no
  // files. Needs a cache that knows its field_hash; Solver::kSphere has no bricks.
  std::filesystem::path stem;
  bool may_write = true;  // rather than read only
  std::uint64_t max_bytes = std::uint64_t{1}
                            << 30;  // of bricks in memory, which files are not above
  // A file that cannot be read, which stays as it is, or written: bricks are made all the same.
  std::function<void(const std::string&)> warn;
};

struct GeometryOptions {
  topology::KeepRule keep;
  // How far from the object ray origins may lie, in its diameters, for the surface to stay
  // watertight: Embree culls boxes in single precision, so bricks are padded in proportion.
  double far_distance = 100.0;
  Solver solver = Solver::kModel;
  // With kStreamline the constructor runs the Morse engine and may throw what that throws.
  Membership membership = Membership::kLabels;
  // Debug mode: every evaluation is compared with the bound that the solver relies on there; see
  // GeometryStatistics::violations.
  bool check_bounds = false;
  BrickKeeping bricks = {};
};

struct GeometryStatistics {
  std::uint64_t bricks = 0;
  bool bricks_were_read = false;  // from a file
  std::uint64_t blocks = 0;       // restricted fields that the bricks share
  // Bricks, these fields, the coarsened octree, the table of components and what filters know:
  // everything but the geometry's own field.
  std::uint64_t bytes = 0;
  // Ray tests that ended at the evaluation limit, so that a hit may be missing or not the first.
  std::uint64_t limits = 0;
  std::uint64_t violations = 0;  // of bounds, found with check_bounds: the field or its models err
};

// What create() does on request.
struct CreateOptions {
  // Occlusion queries normally stop at the first sign of a hit, without its place, and run no
  // filter. Set this for geometry that gets an occlusion filter function.
  bool occlusion_filter = false;
};

// Hypertexture surface as Embree user geometry: one primitive a brick, a brick being a cell of the
// labelled octree, or a part or a group of cells, that holds surface of a kept component (with
// Solver::kSphere one for all).
// Immutable after construction and shared by all instances.
class HypertextureGeometry {
 public:
  // Takes from the cache what rays need (topology/coarsen.h), and does not keep it. Phases of its
  // progress: "bricks", or "slopes" with Solver::kSphere; then those of the Morse engine with
  // Membership::kStreamline. Throws Cancelled.
  HypertextureGeometry(std::shared_ptr<const Field> field,
                       std::shared_ptr<const topology::TopologyCache> cache,
                       const GeometryOptions& options, const topology::Execution& execution = {});
  ~HypertextureGeometry();
  HypertextureGeometry(const HypertextureGeometry&) = delete;
  HypertextureGeometry& operator=(const HypertextureGeometry&) = delete;

  // A new user geometry on `device`, committed, with one reference that the caller releases. This
  // object must outlive it. A hit has primID = brick, u = v = 0, Ng = -grad F (outward), as Embree
  // wants unnormalised. Filters are run for every root, in order, until one is accepted. A root on
  // a face that bricks share may be reported by each of them (by filters, that is: twice).
  RTCGeometry create(RTCDevice device, const CreateOptions& options = {}) const;

  // First hit of the ray with the kept surface inside one brick, t in (tnear, tfar); pure, no
  // Embree. A root at tnear itself (F = 0 there) is not a hit: spawn points avoid the question.
  struct Hit {
    double t;
    Imath::V3d gradient;  // of F at the hit
    int evaluations;
    double beyond;  // to find the brick's next root, pass this as tnear
  };
  std::optional<Hit> intersect_brick(std::uint32_t brick, const Imath::V3d& origin,
                                     const Imath::V3d& direction, double tnear, double tfar) const;

  // `point` is origin + t * direction of a hit on `brick`; `extra_error` is an absolute bound on
  // the distance of `point` from the true hit beyond its own rounding (e.g. from an instance's
  // transform).
  ShadingPoint shade(std::uint32_t brick, const Imath::V3f& point, float extra_error = 0.0f) const;

  // Density, noise, reference coordinates and curvature at `point`, a hit's on `brick` (or any near
  // it: all of these are defined off the surface as well).
  SurfaceDetail detail(std::uint32_t brick, const Imath::V3d& point) const;

  // Component of the brick's surface; kNoComponent where that depends on the place (a leaf that the
  // topology left undecided; all of the object with Solver::kSphere): then ask component_at.
  std::uint32_t component(std::uint32_t brick) const;
  std::uint32_t component_at(std::uint32_t brick, const Imath::V3d& point) const;
  std::uint32_t main_component() const;
  topology::Box bounds() const;                           // of the bricks; empty if there are none
  topology::Box brick_bounds(std::uint32_t brick) const;  // the octree's cell
  topology::Box primitive_bounds(std::uint32_t brick) const;  // of its part that may hold surface
  double bounds_padding() const;  // what Embree's bounds add to that, see far_distance
  // Greatest error of a hit's place along its ray, as a length.
  double tolerance() const;
  GeometryStatistics statistics() const;
  const Field& field() const;
  const std::vector<topology::Component>& components() const;  // the topology's table

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace morsel::geom
