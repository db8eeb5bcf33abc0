// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/mask.h"

#include <fmt/format.h>

#include "hypertexture_geom/field/model_algebra.h"
#include "hypertexture_geom/field/product.h"
#include "hypertexture_geom/field/registry.h"
#include "hypertexture_geom/field/tape_builder.h"
#include "hypertexture_geom/field/univariate_function.h"

namespace morsel::geom {
namespace {

using params::Declaration;
using params::JsonReader;
using params::Type;
using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;

// The coordinate along an axis.
class Height final : public Expression {
 public:
  explicit Height(int axis) : axis_(axis) {}

  double value(const Imath::V3d& x) const override { return x[axis_]; }
  Jet jet(const Imath::V3d& x) const override {
    Jet jet;
    jet.value = x[axis_];
    jet.gradient[axis_] = 1.0;
    return jet;
  }
  LocalModel model(const Box& box) const override { return coordinate_model(box, axis_); }
  std::unique_ptr<ScalarField> restricted_to(const Box&) const override {
    return std::make_unique<Height>(*this);
  }
  TapeValue emit(TapeBuilder& tape) const override {
    Imath::V3d row(0.0);
    row[axis_] = 1.0;
    return tape.linear(row, Imath::V3d(0.0));
  }
  Interval expected_range() const override { return Interval::whole(); }
  std::optional<Box> superlevel_box(double) const override { return std::nullopt; }

 private:
  int axis_;
};

const Declaration& height_declaration() {
  static const Declaration declaration{
      "height",
      "Fades along a coordinate axis.",
      {{"type", Type::kString, "height", "Kind of mask."},
       {.name = "axis",
        .type = Type::kChoice,
        .default_value = "y",
        .help = "The axis.",
        .choices = {"x", "y", "z"}},
       {"from", Type::kNumber, 0.0, "Coordinate up to which the factor is 0.", "length",
        -params::kFarthest, params::kFarthest},
       {"to", Type::kNumber, 1.0, "Coordinate from which the factor is 1.", "length",
        -params::kFarthest, params::kFarthest}}};
  return declaration;
}

const Declaration& density_declaration() {
  static const Declaration declaration{
      "density",
      "Fades by the value of a second density.",
      {{"type", Type::kString, "density", "Kind of mask."},
       {.name = "density",
        .type = Type::kObject,
        .help = "The density, positive inside.",
        .kind = "density"},
       {"from", Type::kNumber, 0.0, "Value up to which the factor is 0.", "length",
        -params::kFarthest, params::kFarthest},
       {"to", Type::kNumber, 0.1, "Value from which the factor is 1.", "length", -params::kFarthest,
        params::kFarthest}}};
  return declaration;
}

}  // namespace

const std::vector<const Declaration*>& mask_declarations() {
  static const std::vector<const Declaration*> all{&height_declaration(), &density_declaration()};
  return all;
}

const Declaration& mask_declaration(const nlohmann::json& object, const params::Place& place) {
  const std::string type = params::type_of(object, {"height", "density"}, place);
  return type == "height" ? height_declaration() : density_declaration();
}

std::unique_ptr<Expression> mask_from_json(const nlohmann::json& object,
                                           const params::Place& place) {
  const Declaration& declaration = mask_declaration(object, place);
  const JsonReader r(object, declaration, place);
  const double from = r.number("from"), to = r.number("to"), width = to - from;
  if (!(std::abs(width) >= 1e-9 * (std::abs(from) + std::abs(to)) && std::abs(width) >= 1e-9))
    r.place("to").fail(fmt::format("{} and \"from\", {}, must differ", to, from));
  std::shared_ptr<const Expression> f;
  if (declaration.name == "height")
    f = std::make_shared<Height>(r.string("axis")[0] - 'x');
  else
    f = density_from_json(r.object("density"), place / "density");
  return make_univariate(smooth_step_function(),
                         make_univariate(affine_function(1.0 / width, -from / width), f));
}

params::Parameter mask_parameter() {
  return {.name = "mask",
          .type = Type::kObject,
          .help = "Factor of the amplitude that depends on the position; 1 everywhere when absent.",
          .optional = true,
          .kind = "mask"};
}

std::shared_ptr<const Expression> masked(std::shared_ptr<const Expression> f, const JsonReader& r) {
  if (!r.has("mask")) return f;
  return make_masked(mask_from_json(r.object("mask"), r.place("mask")), std::move(f));
}

}  // namespace morsel::geom
