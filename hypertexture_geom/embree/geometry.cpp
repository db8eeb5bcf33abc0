// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "hypertexture_geom/embree/brick_file.h"
#include "hypertexture_geom/embree/brick_surface.h"
#include "hypertexture_geom/embree/callbacks.h"
#include "hypertexture_geom/embree/lipschitz.h"
#include "hypertexture_geom/embree/spawn.h"
#include "hypertexture_geom/embree/sphere_surface.h"
#include "topology/coarsen.h"
#include "topology/components.h"

namespace morsel::geom {
namespace {

// Of a hit along the ray, in diameters of the object: below half an ulp of its float coordinates.
constexpr double kTolerance = 2e-8;
// Distance from a brick at which its block's field still holds, in diameters: shading points leave
// their brick by rounding and by their offset.
constexpr double kMargin = 2e-5;

std::vector<bool> kept(const topology::TopologyCache& cache, const GeometryOptions& options) {
  if (options.membership == Membership::kOff)
    return std::vector<bool>(cache.topology.components.size(), true);
  return topology::kept_components(options.keep, cache.topology.components,
                                   cache.topology.octree());
}

topology::Box bounds_of(const topology::TopologyCache& cache, const std::vector<bool>& keep) {
  topology::Box box;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) box.extendBy(cache.topology.components[i].bounds);
  return box;
}

// Diameter of the box that holds the kept components, the unit of every tolerance.
double diameter_of(const topology::Box& box) {
  return box.isEmpty() ? 0.0 : (box.max - box.min).length();
}

// Cells that one brick may serve, see BrickSet::Options, need not be told apart.
constexpr int kMergeLevels = 2;

// The more cells the kept components have, the more memory counts beside the time of evaluations:
// bricks may then err by more before they are divided, and more of them share a block's field.
struct BrickSizing {
  std::uint64_t cells;  // from this many on
  double error_ratio;
  int block_levels;
};
constexpr BrickSizing kSizings[] = {{500'000, 0.06, 4}, {2'000'000, 0.1, 6}};

// What rays need of the octree.
std::vector<topology::OctreeNode> octree_for_rays(const topology::TopologyCache& cache,
                                                  const std::vector<bool>& keep,
                                                  const GeometryOptions& options) {
  // The paper's filter is to tell components apart by itself.
  const std::vector<bool> all(keep.size(), true);
  return topology::coarsened(cache.topology.nodes,
                             options.membership == Membership::kStreamline ? all : keep,
                             options.solver == Solver::kSegment ? 0 : kMergeLevels);
}

// From the file that keeps them, or made and written to it.
BrickSet make_bricks(const Field& field, const BrickFile::Source& source,
                     const BrickKeeping& keeping, const topology::Execution& execution,
                     bool& were_read) {
  const auto make = [&] {
    return BrickSet(field, source.octree, source.kept, source.options, execution);
  };
  if (keeping.stem.empty() || source.field_hash.empty()) return make();
  const BrickFile file(keeping.stem, source);
  const auto warn = [&](const std::string& text) {
    if (keeping.warn) keeping.warn(text);
  };
  try {
    if (std::optional<BrickSet> read = file.read(field, execution)) {
      were_read = true;
      return std::move(*read);
    }
  } catch (const topology::CacheError& e) {
    warn(fmt::format("{}; bricks are made anew, as they will be until it is removed", e.what()));
    return make();
  }
  BrickSet made = make();
  try {
    if (keeping.may_write && made.bytes() <= keeping.max_bytes) file.write(made);
  } catch (const topology::CacheError& e) {
    warn(fmt::format("{}; bricks are not kept for the next run", e.what()));
  }
  return made;
}

struct MadeSurface {
  std::unique_ptr<RaySurface> surface;
  bool bricks_were_read = false;
};

MadeSurface make_surface(const Field& field, const std::string& field_hash,
                         const topology::Box& box, const topology::OctreeView& octree,
                         const std::vector<bool>& keep, std::uint64_t cells,
                         const GeometryOptions& options, const topology::Execution& execution) {
  MadeSurface made;
  std::unique_ptr<RaySurface>& surface = made.surface;
  const double diameter = diameter_of(box);
  const bool streamline = options.membership == Membership::kStreamline;
  if (box.isEmpty()) {  // nothing is kept
    surface = std::make_unique<SphereSurface>(field, box, 0.0, 0.0);
    return made;
  }
  if (options.solver == Solver::kSphere) {
    topology::Box all = box;  // undecided leaves belong to no component, but may hold their surface
    octree.for_each_leaf([&](const topology::OctreeView::Leaf& leaf) {
      if (octree.nodes[leaf.node].cell_content() == topology::Content::kUndecided)
        all.extendBy(leaf.box);
    });
    const double lipschitz = lipschitz_bound(field, all, execution);
    surface = std::make_unique<SphereSurface>(field, all, lipschitz, kTolerance * diameter);
  } else {
    const std::vector<bool> all(keep.size(), true);  // see octree_for_rays
    BrickSet::Options bricks{.margin = kMargin * diameter,
                             .slope_ranges = options.solver == Solver::kSegment,
                             .merge_levels = kMergeLevels};
    for (const BrickSizing& sizing : kSizings) {
      if (cells < sizing.cells) break;
      bricks.error_ratio = sizing.error_ratio;
      bricks.block_levels = sizing.block_levels;
    }
    surface = std::make_unique<BrickSurface>(
        make_bricks(field, {field_hash, octree, streamline ? all : keep, bricks}, options.bricks,
                    execution, made.bricks_were_read),
        field, kTolerance * diameter);
  }
  if (streamline)
    surface->set_filter(make_streamline_filter(field, octree, keep, execution),
                        RaySurface::Filtered::kAll);
  else
    surface->set_filter(make_label_filter(field, octree, keep, kTolerance * diameter),
                        options.membership == Membership::kOff ? RaySurface::Filtered::kNone
                                                               : RaySurface::Filtered::kMixed);
  if (options.check_bounds) surface->check_bounds();
  return made;
}

// Whether F is proved to fall along `direction` everywhere in the box that x and p span.
bool falls(const Field& field, const Imath::V3d& x, const Imath::V3d& p,
           const Imath::V3d& direction) {
  topology::Box box(x);
  box.extendBy(p);
  const double slack = float_error(x);
  box.min -= Imath::V3d(slack);
  box.max += Imath::V3d(slack);
  const topology::LocalModel model = field.restricted_to(box)->model(box);
  double greatest = 0.0;
  for (int i = 0; i < 3; ++i) {
    const topology::Interval slope = model.gradient_range(i);
    greatest += std::max(direction[i] * slope.lo, direction[i] * slope.hi);
  }
  return greatest < 0.0;
}

}  // namespace

struct HypertextureGeometry::Impl {
  std::shared_ptr<const Field> field;
  std::vector<topology::Component> components;
  std::vector<bool> keep;
  std::vector<topology::OctreeNode> octree;  // the cache's, coarsened
  double diameter;
  std::unique_ptr<const RaySurface> surface;
  bool bricks_were_read = false;
  topology::Box bounds;
  CallbackData callback_data;

  Impl(std::shared_ptr<const Field> f, std::shared_ptr<const topology::TopologyCache> cache,
       const GeometryOptions& options, const topology::Execution& execution)
      : field(std::move(f)),
        components(cache->topology.components),
        keep(kept(*cache, options)),
        octree(octree_for_rays(*cache, keep, options)) {
    const topology::Box kept_bounds = bounds_of(*cache, keep), root = cache->topology.box;
    const std::string field_hash = cache->field_hash;
    cache.reset();  // perhaps the last to hold it, and large: bricks need the memory
    diameter = diameter_of(kept_bounds);
    std::uint64_t cells = 0;
    for (std::size_t i = 0; i < keep.size(); ++i)
      if (keep[i]) cells += components[i].cells;
    MadeSurface made = make_surface(*field, field_hash, kept_bounds, {root, octree}, keep, cells,
                                    options, execution);
    surface = std::move(made.surface);
    bricks_were_read = made.bricks_were_read;
    for (std::uint32_t i = 0; i < surface->size(); ++i) bounds.extendBy(surface->bounds(i));
    callback_data = {surface.get(), padding(options.far_distance)};
  }

  // Embree's slab test works in float: with t up to (far_distance + 1) diameters, an entry or exit
  // may be off by a few ulp of that. The boxes themselves are rounded to float: 8 ulp of the
  // largest coordinate.
  double padding(double far_distance) const {
    if (bounds.isEmpty()) return 0.0;
    constexpr double kUlp = 0x1p-23;
    double largest = 0.0;
    for (int i = 0; i < 3; ++i)
      largest = std::max({largest, std::abs(bounds.min[i]), std::abs(bounds.max[i])});
    return 8.0 * kUlp * largest + 2.0 * kUlp * (far_distance + 1.0) * diameter;
  }
};

HypertextureGeometry::HypertextureGeometry(std::shared_ptr<const Field> field,
                                           std::shared_ptr<const topology::TopologyCache> cache,
                                           const GeometryOptions& options,
                                           const topology::Execution& execution)
    : impl_(std::make_unique<Impl>(std::move(field), std::move(cache), options, execution)) {}

HypertextureGeometry::~HypertextureGeometry() = default;

RTCGeometry HypertextureGeometry::create(RTCDevice device, const CreateOptions& options) const {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  if (!geometry) throw std::runtime_error("Embree could not create a user geometry");
  set_callbacks(geometry, &impl_->callback_data, options.occlusion_filter);
  accept_all_rays(geometry);
  rtcCommitGeometry(geometry);
  return geometry;
}

std::optional<HypertextureGeometry::Hit> HypertextureGeometry::intersect_brick(
    std::uint32_t brick, const Imath::V3d& origin, const Imath::V3d& direction, double tnear,
    double tfar) const {
  const RaySegment segment{origin, direction, tnear, tfar};
  RaySurface::Root root;
  if (!impl_->surface->first_root(brick, segment, root)) return std::nullopt;
  return Hit{root.t, impl_->surface->gradient(brick, segment, root), root.evaluations, root.beyond};
}

ShadingPoint HypertextureGeometry::shade(std::uint32_t brick, const Imath::V3f& point,
                                         float extra_error) const {
  const Imath::V3d x(point);
  Imath::V3d gradient;
  const double value = impl_->surface->value_and_gradient_at(brick, x, gradient);

  // F's gradient vanishes on the surface only at degenerate points (F = 0 at a saddle): outward
  // from the object's centre is then as good as any direction.
  Imath::V3d normal = -gradient;
  const double slope = normal.length();
  if (!(slope > 0.0)) normal = x - topology::centre(impl_->bounds);
  if (!(normal.length2() > 0.0)) normal = {0.0, 0.0, 1.0};
  normal.normalize();

  const double error =
      float_error(x) + impl_->surface->tolerance() + static_cast<double>(extra_error);
  const auto value_at = [&](const Imath::V3d& p) { return impl_->surface->value_at(brick, p); };
  // F falls along the normal all the way from x to p.
  const auto single = [&](const Imath::V3d& p) { return falls(*impl_->field, x, p, normal); };
  const SpawnPoint front = spawn_point(x, normal, 2.0 * error, -1.0, value_at, single);
  const SpawnPoint behind = spawn_point(x, -normal, 2.0 * error, 1.0, value_at, single);

  ShadingPoint s;
  s.normal = Imath::V3f(normal);
  s.spawn_front = front.point;
  s.spawn_behind = behind.point;
  s.spawn_verified = front.verified && behind.verified;
  s.component = impl_->surface->component_at(brick, x);
  const double step = slope > 0.0 ? std::clamp(value / slope, -error, error) : 0.0;
  s.position = x + normal * step;
  s.position_error = std::max((Imath::V3d(front.point) - s.position).length(),
                              (Imath::V3d(behind.point) - s.position).length());
  return s;
}

SurfaceDetail HypertextureGeometry::detail(std::uint32_t brick, const Imath::V3d& point) const {
  const topology::Jet jet = impl_->field->jet(point);
  const FieldParts parts = impl_->field->parts(point);
  SurfaceDetail d;
  d.component = impl_->surface->component_at(brick, point);
  d.density = parts.density;
  d.noise = parts.noise;
  d.reference = parts.reference;
  d.gradient = jet.gradient;
  d.curvature = curvature(jet);
  return d;
}

std::uint32_t HypertextureGeometry::component(std::uint32_t brick) const {
  return impl_->surface->component(brick);
}

std::uint32_t HypertextureGeometry::component_at(std::uint32_t brick,
                                                 const Imath::V3d& point) const {
  return impl_->surface->component_at(brick, point);
}

std::uint32_t HypertextureGeometry::main_component() const {
  return topology::main_component(impl_->components);
}

topology::Box HypertextureGeometry::bounds() const { return impl_->bounds; }

topology::Box HypertextureGeometry::brick_bounds(std::uint32_t brick) const {
  return impl_->surface->cell(brick);
}

topology::Box HypertextureGeometry::primitive_bounds(std::uint32_t brick) const {
  return impl_->surface->bounds(brick);
}

double HypertextureGeometry::bounds_padding() const { return impl_->callback_data.padding; }

double HypertextureGeometry::tolerance() const { return impl_->surface->tolerance(); }

GeometryStatistics HypertextureGeometry::statistics() const {
  const RaySurface& s = *impl_->surface;
  const std::uint64_t bytes = sizeof(Impl) + s.bytes() + s.filter_bytes() +
                              impl_->octree.capacity() * sizeof(topology::OctreeNode) +
                              impl_->components.capacity() * sizeof(topology::Component) +
                              impl_->keep.capacity() / 8;
  return {s.size(), impl_->bricks_were_read, s.blocks(), bytes, s.limits(), s.violations()};
}

const Field& HypertextureGeometry::field() const { return *impl_->field; }

const std::vector<topology::Component>& HypertextureGeometry::components() const {
  return impl_->components;
}

}  // namespace morsel::geom
