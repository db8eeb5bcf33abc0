// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/geometry.h"

#include <algorithm>
#include <stdexcept>

#include "hypertexture_geom/embree/brick_surface.h"
#include "hypertexture_geom/embree/callbacks.h"
#include "hypertexture_geom/embree/spawn.h"
#include "topology/components.h"

namespace morsel::geom {
namespace {

// Of a hit along the ray, in diameters of the object: below half an ulp of its float coordinates.
constexpr double kTolerance = 2e-8;
// Distance from a brick at which its block's field still holds, in diameters: shading points leave
// their brick by rounding and by their offset.
constexpr double kMargin = 2e-5;

std::vector<bool> kept(const topology::TopologyCache& cache, const topology::KeepRule& rule) {
  return topology::kept_components(rule, cache.topology.components, cache.topology.octree());
}

// Diameter of the box that holds the kept components, the unit of every tolerance.
double diameter_of(const topology::TopologyCache& cache, const std::vector<bool>& keep) {
  topology::Box box;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) box.extendBy(cache.topology.components[i].bounds);
  return box.isEmpty() ? 0.0 : (box.max - box.min).length();
}

}  // namespace

struct HypertextureGeometry::Impl {
  std::shared_ptr<const Field> field;
  std::shared_ptr<const topology::TopologyCache> cache;
  std::vector<bool> keep;
  double diameter;
  BrickSurface surface;
  topology::Box bounds;
  CallbackData callback_data;

  Impl(std::shared_ptr<const Field> f, std::shared_ptr<const topology::TopologyCache> c,
       const GeometryOptions& options)
      : field(std::move(f)),
        cache(std::move(c)),
        keep(kept(*cache, options.keep)),
        diameter(diameter_of(*cache, keep)),
        surface(BrickSet(*field, cache->topology.octree(), keep,
                         {.margin = kMargin * diameter,
                          .slope_ranges = options.solver == Solver::kSegment}),
                kTolerance * diameter, options.solver) {
    const BrickSet& bricks = surface.bricks();
    for (std::uint32_t i = 0; i < bricks.size(); ++i)
      bounds.extendBy(bricks.surface_box(bricks[i]));
    callback_data = {&surface, padding(options.far_distance)};
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

  // F wherever asked; the block's field where that is valid.
  double value_near(std::uint32_t brick, const Imath::V3d& x) const {
    const BrickSet& bricks = surface.bricks();
    const Brick& b = bricks[brick];
    topology::Box box = bricks.box(b);
    box.min -= Imath::V3d(bricks.margin());
    box.max += Imath::V3d(bricks.margin());
    return box.intersects(x) ? bricks.field(b).value(x) : field->value(x);
  }
};

HypertextureGeometry::HypertextureGeometry(std::shared_ptr<const Field> field,
                                           std::shared_ptr<const topology::TopologyCache> cache,
                                           const GeometryOptions& options)
    : impl_(std::make_unique<Impl>(std::move(field), std::move(cache), options)) {}

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
  BrickSurface::Root root;
  if (!impl_->surface.first_root(brick, segment, root)) return std::nullopt;
  return Hit{root.t, impl_->surface.gradient(brick, segment, root), root.evaluations};
}

ShadingPoint HypertextureGeometry::shade(std::uint32_t brick, const Imath::V3f& point,
                                         float extra_error) const {
  const Imath::V3d x(point);
  const BrickSet& bricks = impl_->surface.bricks();
  const Brick& b = bricks[brick];
  topology::Box box = bricks.box(b);
  box.min -= Imath::V3d(bricks.margin());
  box.max += Imath::V3d(bricks.margin());
  const Imath::V3d gradient =
      box.intersects(x) ? bricks.field(b).jet(x).gradient : impl_->field->jet(x).gradient;

  // F's gradient vanishes on the surface only at degenerate points (F = 0 at a saddle): outward
  // from the object's centre is then as good as any direction.
  Imath::V3d normal = -gradient;
  if (!(normal.length2() > 0.0)) normal = x - topology::centre(impl_->bounds);
  if (!(normal.length2() > 0.0)) normal = {0.0, 0.0, 1.0};
  normal.normalize();

  const double offset =
      2.0 * (float_error(x) + impl_->surface.tolerance() + static_cast<double>(extra_error));
  const auto value = [&](const Imath::V3d& p) { return impl_->value_near(brick, p); };
  const SpawnPoint front = spawn_point(x, normal, offset, -1.0, value);
  const SpawnPoint behind = spawn_point(x, -normal, offset, 1.0, value);
  return {Imath::V3f(normal), front.point, behind.point, front.verified && behind.verified,
          b.component};
}

std::uint32_t HypertextureGeometry::component(std::uint32_t brick) const {
  return impl_->surface.bricks()[brick].component;
}

std::uint32_t HypertextureGeometry::main_component() const {
  return topology::main_component(impl_->cache->topology.components);
}

topology::Box HypertextureGeometry::bounds() const { return impl_->bounds; }

topology::Box HypertextureGeometry::brick_bounds(std::uint32_t brick) const {
  const BrickSet& bricks = impl_->surface.bricks();
  return bricks.box(bricks[brick]);
}

double HypertextureGeometry::bounds_padding() const { return impl_->callback_data.padding; }

GeometryStatistics HypertextureGeometry::statistics() const {
  const BrickSet& bricks = impl_->surface.bricks();
  return {bricks.size(), bricks.block_count(), bricks.bytes(), impl_->surface.limits()};
}

const Field& HypertextureGeometry::field() const { return *impl_->field; }

const topology::TopologyCache& HypertextureGeometry::cache() const { return *impl_->cache; }

}  // namespace morsel::geom
