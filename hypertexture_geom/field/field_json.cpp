// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "hypertexture_geom/field/canonical.h"
#include "hypertexture_geom/field/field.h"
#include "hypertexture_geom/field/registry.h"
#include "hypertexture_geom/field/tape_builder.h"
#include "topology/bound_solid.h"
#include "topology/fingerprint.h"

namespace morsel::geom {
namespace {

using nlohmann::json;
using params::Place;
using params::Type;
using topology::Box;

// A composition read from a scene.
class SceneField final : public Field {
 public:
  // `stages` are the density and what each modulation made of what came before it, the last being
  // the field.
  SceneField(std::vector<std::shared_ptr<const Expression>> stages, json canonical)
      : stages_(std::move(stages)), root_(stages_.back().get()), canonical_(std::move(canonical)) {}

  double value(const Imath::V3d& x) const override { return root_->value(x); }
  topology::Jet jet(const Imath::V3d& x) const override { return root_->jet(x); }
  topology::LocalModel model(const Box& box) const override { return root_->model(box); }
  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    return root_->restricted_to(box);
  }
  TapeValue emit(TapeBuilder& tape) const override { return root_->emit(tape); }
  json canonical_json() const override { return canonical_; }
  std::optional<Box> solid_bounds() const override { return root_->superlevel_box(0.0); }
  FieldParts parts(const Imath::V3d& x) const override {
    FieldParts p;
    p.reference = x;
    for (std::size_t i = stages_.size(); i-- > 1;) p.reference = stages_[i]->source_of(p.reference);
    p.density = stages_[0]->value(p.reference);
    p.noise = value(x) - p.density;
    return p;
  }

 private:
  std::vector<std::shared_ptr<const Expression>> stages_;
  const Expression* root_;
  json canonical_;
};

const params::Declaration& bounds_declaration() {
  static const params::Declaration declaration{
      "bounds",
      "Box in object space that the topology is computed in.",
      {{"min", Type::kVector3, nullptr, "Lower corner.", "length", -params::kFarthest,
        params::kFarthest},
       {"max", Type::kVector3, nullptr, "Upper corner.", "length", -params::kFarthest,
        params::kFarthest}}};
  return declaration;
}

Box read_bounds(const json& value, const Place& place) {
  const params::JsonReader reader(value, bounds_declaration(), place);
  const Box box(reader.vector3("min"), reader.vector3("max"));
  for (int axis = 0; axis < 3; ++axis)
    if (!(box.min[axis] < box.max[axis]))
      place.fail(
          fmt::format("min must be below max on every axis, but on axis {} they are {} and {}",
                      "xyz"[axis], box.min[axis], box.max[axis]));
  return box;
}

// Parameters within their ranges can still multiply up to more than a double holds: said here,
// once, rather than by each who evaluates the field.
void check_finite(const topology::ScalarField& field, const Box& box, const Place& place) {
  for (int i = -1; i < 8; ++i) {
    Imath::V3d x = topology::centre(box);
    for (int axis = 0; axis < 3 && i >= 0; ++axis)
      x[axis] = (i >> axis & 1) != 0 ? box.max[axis] : box.min[axis];
    if (const double value = field.value(x); !std::isfinite(value))
      place.fail(
          fmt::format("the field is not finite but {} at ({:.6g}, {:.6g}, {:.6g}): its parameters "
                      "are too large",
                      value, x.x, x.y, x.z));
  }
}

}  // namespace

const params::Declaration& field_declaration() {
  static const params::Declaration declaration{
      "field",
      "A density and the modulations applied to it in turn: H = f_n(... f_1(f_0(D(x)))). The solid "
      "is H >= 0.",
      {{.name = "density",
        .type = Type::kObject,
        .help = "The smooth object D.",
        .kind = "density"},
       {.name = "modulations",
        .type = Type::kArray,
        .default_value = json::array(),
        .help = "Applied to the density in this order.",
        .kind = "modulation"}}};
  return declaration;
}

std::shared_ptr<const Field> field_from_json(const json& value, const Place& place) {
  // First, since it checks all of the description, nested objects and their depth included.
  json canonical = canonical_object(value, field_declaration(), place);
  std::vector<std::shared_ptr<const Expression>> stages{
      density_from_json(canonical["density"], place / "density")};
  const json& sequence = canonical["modulations"];
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const Place here = place / "modulations" / i;
    const ModulationEntry& m = modulation_entry(sequence[i], here);
    stages.push_back(m.make(stages.back(), params::JsonReader(sequence[i], m.declaration, here)));
  }
  return std::make_shared<SceneField>(std::move(stages), std::move(canonical));
}

const params::Declaration& hypertexture_declaration() {
  static const params::Declaration declaration{
      "hypertexture",
      "A hypertextured implicit surface, rendered without its detached pieces.",
      {{.name = "name", .type = Type::kString, .help = "Instances refer to it by this name."},
       {"type", Type::kString, "hypertexture", "Kind of geometry."},
       {.name = "field",
        .type = Type::kObject,
        .help = "The field whose surface F = 0 is rendered.",
        .record = &field_declaration()},
       {.name = "bounds",
        .type = Type::kObject,
        .help =
            "Box {min, max} that the topology is computed in; derived from the field when absent.",
        .optional = true,
        .record = &bounds_declaration()},
       {"min_depth", Type::kInteger, 3, "Octree cells that hold surface are at least this deep.",
        "", 0, 12},
       {"max_depth", Type::kInteger, 24,
        "Octree cells at this depth are not subdivided further but reported as unresolved.", "", 1,
        topology::kMaxDepth},
       {"keep", Type::kString, "main",
        "Components to render: main, largest:K, volume:V, touching:X,Y,Z, all, detached, "
        "ids:I,J,..."},
       {.name = "solver",
        .type = Type::kChoice,
        .default_value = "model",
        .help = "How rays find the surface: model (fastest), segment, or sphere (the paper's).",
        .choices = {"sphere", "segment", "model"}},
       {.name = "membership",
        .type = Type::kChoice,
        .default_value = "labels",
        .help =
            "How detached pieces are told: labels, streamline (the paper's ascent to a maximum), "
            "or off (every piece is kept).",
        .choices = {"labels", "streamline", "off"}},
       {.name = "cache",
        .type = Type::kString,
        .help =
            "Topology cache file, relative to the scene file; chosen by fingerprint when absent.",
        .optional = true}}};
  return declaration;
}

Hypertexture hypertexture_from_json(const json& value, const Place& place,
                                    const topology::Execution& execution) {
  const params::JsonReader reader(value, hypertexture_declaration(), place);
  Hypertexture h;
  h.name = reader.string("name");
  h.field = field_from_json(reader.object("field"), place / "field");
  h.certify.min_depth = static_cast<int>(reader.integer("min_depth"));
  h.certify.max_depth = static_cast<int>(reader.integer("max_depth"));
  if (h.certify.min_depth > h.certify.max_depth)
    reader.place("min_depth")
        .fail(fmt::format("{} exceeds max_depth, {}", h.certify.min_depth, h.certify.max_depth));
  try {
    h.keep = topology::KeepRule::parse(reader.string("keep"));
  } catch (const std::invalid_argument& e) {
    reader.place("keep").fail(e.what());
  }
  const std::string solver = reader.string("solver"), membership = reader.string("membership");
  h.solver = solver == "sphere"    ? Solver::kSphere
             : solver == "segment" ? Solver::kSegment
                                   : Solver::kModel;
  h.membership = membership == "streamline" ? Membership::kStreamline
                 : membership == "off"      ? Membership::kOff
                                            : Membership::kLabels;
  if (reader.has("cache")) h.cache = reader.string("cache");
  if (reader.has("bounds")) {
    h.certify.box = read_bounds(reader.object("bounds"), place / "bounds");
  } else {
    const std::optional<Box> outer = h.field->solid_bounds();
    if (!outer) place.fail("the field's solid is unbounded: give \"bounds\" {min, max}");
    if (!outer->isEmpty()) check_finite(*h.field, *outer, place / "field");
    if (!outer->isEmpty()) h.certify.box = topology::find_solid(*h.field, *outer, execution);
    if (h.certify.box.isEmpty())
      (place / "field")
          .fail(
              "no point with F >= 0 was found: the field has no solid to render (or give "
              "\"bounds\")");
  }
  h.certify.box = topology::dyadic_box(h.certify.box);
  check_finite(*h.field, h.certify.box, place / "field");
  const Box& b = h.certify.box;
  h.canonical = {{"field", h.field->canonical_json()},
                 {"box", {b.min.x, b.min.y, b.min.z, b.max.x, b.max.y, b.max.z}},
                 {"min_depth", h.certify.min_depth},
                 {"max_depth", h.certify.max_depth}};
  const std::string text = h.canonical.dump();
  h.hash = topology::fingerprint(std::as_bytes(std::span(text)));
  return h;
}

topology::TopologyCache build_cache(const Hypertexture& hypertexture,
                                    const topology::Execution& execution,
                                    const topology::EngineOptions& engine) {
  const auto start = std::chrono::steady_clock::now();
  topology::TopologyCache cache;
  cache.topology = topology::run_engine(engine, *hypertexture.field, hypertexture.certify,
                                        cache.sections, execution);
  cache.field = hypertexture.canonical;
  cache.field_hash = hypertexture.hash;
  cache.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return cache;
}

}  // namespace morsel::geom
