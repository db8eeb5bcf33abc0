// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/c_api/call.h"
#include "hypertexture_geom/c_api/objects.h"

namespace morsel::c_api {
namespace {

// A geometry as in a scene, or only what stands under its key "field".
nlohmann::json as_geometry(nlohmann::json json) {
  if (!json.is_object()) return json;
  if (json.contains("density")) json = nlohmann::json{{"field", std::move(json)}};
  if (!json.contains("type")) json["type"] = "hypertexture";
  if (!json.contains("name")) json["name"] = "hypertexture";
  return json;
}

}  // namespace
}  // namespace morsel::c_api

using namespace morsel::c_api;

MorselResult morsel_create_field(const char* json, const char* name, MorselField* field) {
  return call(nullptr, [&] {
    require(json, "json");
    require(field, "field");
    const std::string file = name ? name : "json";
    auto object = std::make_shared<FieldObject>();
    object->hypertexture = morsel::geom::hypertexture_from_json(
        as_geometry(morsel::params::parse_text(json, file)), {file, ""});
    object->json = object->hypertexture.canonical.dump();
    give(std::move(object), field);
  });
}

MorselResult morsel_retain_field(MorselField field) {
  return call(field, [&] { retain(field, Kind::kField); });
}

MorselResult morsel_release_field(MorselField field) {
  return call(field, [&] { release(field, Kind::kField); });
}

MorselResult morsel_field_json(MorselField field, const char** json) {
  return call(field, [&] {
    const auto& object = object_of<FieldObject>(field);
    require(json, "json");
    *json = object.json.c_str();
  });
}

MorselResult morsel_field_hash(MorselField field, const char** hash) {
  return call(field, [&] {
    const auto& object = object_of<FieldObject>(field);
    require(hash, "hash");
    *hash = object.hypertexture.hash.c_str();
  });
}

MorselResult morsel_field_bounds(MorselField field, double lower[3], double upper[3]) {
  return call(field, [&] {
    const morsel::topology::Box& box = object_of<FieldObject>(field).hypertexture.certify.box;
    require(lower, "lower");
    require(upper, "upper");
    for (int i = 0; i < 3; ++i) lower[i] = box.min[i], upper[i] = box.max[i];
  });
}

MorselResult morsel_evaluate_field(MorselField field, const double* points, size_t count,
                                   double* values, double* gradients) {
  return call(field, [&] {
    const morsel::geom::Field& f = *object_of<FieldObject>(field).hypertexture.field;
    if (count == 0) return;
    require(points, "points");
    require(values, "values");
    for (size_t i = 0; i < count; ++i) require_point(points + 3 * i, "points");
    for (size_t i = 0; i < count; ++i) {
      const Imath::V3d x(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
      if (!gradients) {
        values[i] = f.value(x);
        continue;
      }
      const morsel::topology::Jet jet = f.jet(x);
      values[i] = jet.value;
      for (std::size_t k = 0; k < 3; ++k) gradients[3 * i + k] = jet.gradient[static_cast<int>(k)];
    }
  });
}
