// SPDX-License-Identifier: Apache-2.0
// The densities that a scene may name: declarations, and what makes them.
#include <fmt/format.h>

#include <algorithm>

#include "hypertexture_geom/field/density_boolean.h"
#include "hypertexture_geom/field/density_capsule.h"
#include "hypertexture_geom/field/density_ellipsoid.h"
#include "hypertexture_geom/field/density_metaballs.h"
#include "hypertexture_geom/field/density_rounded_box.h"
#include "hypertexture_geom/field/density_slab.h"
#include "hypertexture_geom/field/density_sphere.h"
#include "hypertexture_geom/field/density_torus.h"
#include "hypertexture_geom/field/registry.h"

namespace morsel::geom {
namespace {

using params::JsonReader;
using params::Parameter;
using params::Type;

Parameter type(const char* name) { return {"type", Type::kString, name, "Kind of density."}; }

Parameter coordinates(const char* name, nlohmann::json default_value, const char* help,
                      const char* unit) {
  return {name, Type::kVector3,     std::move(default_value), help,
          unit, -params::kFarthest, params::kFarthest};
}

Parameter centre() { return coordinates("center", {0.0, 0.0, 0.0}, "Centre.", "length"); }

Parameter smoothing(const char* help) {
  return {"smoothing", Type::kNumber, 0.01, help, "length", 1e-6, 1e6};
}

Parameter axis(const char* help) { return coordinates("axis", {0.0, 1.0, 0.0}, help, ""); }

Parameter crown(const char* help) { return {"crown", Type::kNumber, 0.1, help, "", 0.0, 1.0}; }

Imath::V3d direction(const JsonReader& r, const char* name) {
  const Imath::V3d d = r.vector3(name);
  if (!(d.length() > 1e-12)) r.place(name).fail("must not be the zero vector");
  return d;
}

// The smoothing, which must be small enough to leave an inside.
double smoothing_below(const JsonReader& r, double limit, const char* what) {
  const double s = r.number("smoothing");
  if (!(s < limit))
    r.place("smoothing").fail(fmt::format("{} must be below {}, {}", s, what, limit));
  return s;
}

DensityEntry sphere() {
  return {{"sphere",
           "Sphere: radius - sqrt(|x - center|^2 + smoothing^2).",
           {type("sphere"),
            centre(),
            {"radius", Type::kNumber, 1.0, "Radius.", "length", 0.0, 1e6, true},
            smoothing("Rounds the apex at the centre.")}},
          [](const JsonReader& r) {
            return make_sphere(r.vector3("center"), r.number("radius"), r.number("smoothing"));
          }};
}

DensityEntry ellipsoid() {
  return {{"ellipsoid",
           "Ellipsoid along the coordinate axes, scaled so that its steepest slope is 1.",
           {type("ellipsoid"),
            centre(),
            {"radii", Type::kNumberOrVector3, {1.0, 1.0, 1.0}, "Radii.", "length", 0.0, 1e6, true},
            smoothing("Rounds the apex at the centre; below the smallest radius.")}},
          [](const JsonReader& r) {
            const Imath::V3d radii = r.vector3("radii");
            const double smallest = std::min({radii.x, radii.y, radii.z});
            return make_ellipsoid(r.vector3("center"), radii,
                                  smoothing_below(r, smallest, "the smallest radius"));
          }};
}

DensityEntry rounded_box() {
  return {{"rounded_box",
           "Box along the coordinate axes with rounded edges and corners.",
           {type("rounded_box"),
            centre(),
            {"half_size",
             Type::kNumberOrVector3,
             {1.0, 1.0, 1.0},
             "Half the edges' lengths.",
             "length",
             0.0,
             1e6,
             true},
            {"rounding", Type::kNumber, 0.1, "Radius of the edges; at most the smallest half size.",
             "length", 0.0, 1e6, true},
            smoothing("Width over which faces pass into edges; below half the rounding."),
            crown("Convexity of the faces, which sink by up to 3/2 crown^2 rounding; 0: flat, and "
                  "the inside almost so.")}},
          [](const JsonReader& r) {
            const Imath::V3d half = r.vector3("half_size");
            const double smallest = std::min({half.x, half.y, half.z});
            const double rounding = r.number("rounding");
            if (rounding > smallest)
              r.place("rounding")
                  .fail(fmt::format("{} exceeds the smallest half size, {}", rounding, smallest));
            return make_rounded_box(r.vector3("center"), half, rounding,
                                    smoothing_below(r, 0.5 * rounding, "half the rounding"),
                                    r.number("crown"));
          }};
}

DensityEntry torus() {
  return {{"torus",
           "Torus about an axis.",
           {type("torus"),
            centre(),
            axis("Direction of the axis of rotation; its length does not matter."),
            {"major_radius", Type::kNumber, 1.0, "Radius of the core circle.", "length", 0.0, 1e6,
             true},
            {"minor_radius", Type::kNumber, 0.3, "Radius of the tube.", "length", 0.0, 1e6, true},
            smoothing("Rounds the core circle and the axis; below the minor radius.")}},
          [](const JsonReader& r) {
            const double minor = r.number("minor_radius");
            return make_torus(r.vector3("center"), direction(r, "axis"), r.number("major_radius"),
                              minor, smoothing_below(r, minor, "the minor radius"));
          }};
}

DensityEntry capsule() {
  return {{"capsule",
           "Segment with a radius.",
           {type("capsule"),
            coordinates("start", {-1.0, 0.0, 0.0}, "One end of the segment.", "length"),
            coordinates("end", {1.0, 0.0, 0.0}, "The other end.", "length"),
            {"radius", Type::kNumber, 0.5, "Distance of the surface from the segment.", "length",
             0.0, 1e6, true},
            smoothing("Rounds the core and the passage into the caps; below half the radius."),
            crown("Bulge of the middle: the ends are thinner by up to crown^2 radius / 2.")}},
          [](const JsonReader& r) {
            const Imath::V3d a = r.vector3("start"), b = r.vector3("end");
            if (!((b - a).length() > 1e-12))
              r.place("end").fail("coincides with \"start\"; use a sphere");
            const double radius = r.number("radius");
            return make_capsule(a, b, radius, smoothing_below(r, 0.5 * radius, "half the radius"),
                                r.number("crown"));
          }};
}

DensityEntry slab() {
  return {{"slab",
           "All that is near a plane. Unbounded: the geometry needs \"bounds\", or an intersection "
           "with something bounded.",
           {type("slab"),
            centre(),
            axis("Direction at right angles to the plane; its length does not matter."),
            {"half_thickness", Type::kNumber, 0.5, "Distance of the faces from the plane.",
             "length", 0.0, 1e6, true},
            smoothing("Rounds the ridge in the middle; below the half thickness.")}},
          [](const JsonReader& r) {
            const double half = r.number("half_thickness");
            return make_slab(r.vector3("center"), direction(r, "axis"), half,
                             smoothing_below(r, half, "the half thickness"));
          }};
}

const params::Declaration& metaball() {
  static const params::Declaration declaration{
      "metaball",
      "weight (1 - (distance / radius)^2)^3 within its radius.",
      {centre(),
       {"radius", Type::kNumber, 1.0, "Radius outside of which it is 0.", "length", 1e-6, 1e6},
       {"weight", Type::kNumber, 1.0, "Value at its centre; negative: carves.", "", -1e6, 1e6}}};
  return declaration;
}

DensityEntry metaballs() {
  return {{"metaballs",
           "Sum of smooth blobs, less a level.",
           {type("metaballs"),
            {.name = "balls",
             .type = Type::kArray,
             .help = "The blobs.",
             .min = 1,
             .max = 1e5,
             .record = &metaball()},
            {"level", Type::kNumber, 0.3, "Sum of the blobs on the surface.", "", 0.0, 1e6, true}}},
          [](const JsonReader& r) {
            const nlohmann::json& list = r.object("balls");
            std::vector<Metaball> balls;
            for (std::size_t i = 0; i < list.size(); ++i) {
              const JsonReader b(list[i], metaball(), r.place("balls") / i);
              balls.push_back({b.vector3("center"), b.number("radius"), b.number("weight")});
            }
            return make_metaballs(balls, r.number("level"));
          }};
}

Parameter parts(const char* help) {
  return {.name = "densities",
          .type = Type::kArray,
          .help = help,
          .min = 2,
          .max = 1024,
          .kind = "density"};
}

Parameter width() {
  return {"width",
          Type::kNumber,
          0.1,
          "Width of the smooth transition: the surface moves by up to half of it where two parts "
          "meet.",
          "length",
          1e-6,
          1e6};
}

std::vector<std::shared_ptr<const Expression>> read_parts(const JsonReader& r) {
  const nlohmann::json& list = r.object("densities");
  std::vector<std::shared_ptr<const Expression>> result;
  for (std::size_t i = 0; i < list.size(); ++i)
    result.push_back(density_from_json(list[i], r.place("densities") / i));
  return result;
}

DensityEntry smooth_union() {
  return {{"union",
           "Smooth union of densities, joined in pairs.",
           {type("union"), parts("What to join."), width()}},
          [](const JsonReader& r) { return make_smooth_union(read_parts(r), r.number("width")); }};
}

DensityEntry smooth_intersection() {
  return {{"intersection",
           "Smooth intersection of densities, joined in pairs.",
           {type("intersection"), parts("What to intersect."), width()}},
          [](const JsonReader& r) {
            return make_smooth_intersection(read_parts(r), r.number("width"));
          }};
}

DensityEntry smooth_difference() {
  return {{"difference",
           "The first density without the others, smoothly.",
           {type("difference"), parts("The first is what the others are taken from."), width()}},
          [](const JsonReader& r) {
            std::vector<std::shared_ptr<const Expression>> all = read_parts(r);
            const double k = r.number("width");
            std::shared_ptr<const Expression> first = all.front();
            all.erase(all.begin());
            std::shared_ptr<const Expression> rest = all.front();
            if (all.size() > 1) rest = make_smooth_union(all, k);
            return make_smooth_difference(std::move(first), std::move(rest), k);
          }};
}

}  // namespace

const std::vector<DensityEntry>& densities() {
  static const std::vector<DensityEntry> all{sphere(),
                                             ellipsoid(),
                                             rounded_box(),
                                             torus(),
                                             capsule(),
                                             slab(),
                                             metaballs(),
                                             smooth_union(),
                                             smooth_intersection(),
                                             smooth_difference()};
  return all;
}

}  // namespace morsel::geom
