// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "hypertexture_geom/field/ray_options.h"
#include "hypertexture_geom/field/term.h"
#include "hypertexture_geom/params/json_reader.h"
#include "topology/cache_file.h"
#include "topology/certified.h"
#include "topology/morse/engine.h"
#include "topology/scalar_field.h"

namespace morsel::geom {

// What a field's value F(x) is made of, for shading.
struct FieldParts {
  double density = 0.0;  // D, as it was before any modulation
  double noise = 0.0;    // F(x) - D: all that the modulations did
  // Reference coordinates: the place at which D was evaluated, that is where the point was on the
  // object before domain warps moved it. The point itself when there are none.
  Imath::V3d reference{0.0};
};

// A field that came from a scene file.
class Field : public Term {
 public:
  // The field's description with every default filled in and keys in a fixed order.
  virtual nlohmann::json canonical_json() const = 0;

  // A box outside of which F < 0 is certain; may be far too large. Empty when the solid is
  // unbounded.
  virtual std::optional<topology::Box> solid_bounds() const = 0;

  // The parts of F(x); unless a field says otherwise, all of it is density.
  virtual FieldParts parts(const Imath::V3d& x) const { return {value(x), 0.0, x}; }
};

// The declaration of {"density", "modulations"}.
const params::Declaration& field_declaration();

// Reads {"density": {...}, "modulations": [{...}, ...]}. Throws params::InputError.
std::shared_ptr<const Field> field_from_json(const nlohmann::json& json,
                                             const params::Place& place);

// A hypertexture geometry of a scene: the field, the box that its topology is computed in, and how.
// NOLINTNEXTLINE(bugprone-exception-escape): what clang-tidy takes for throwing are assertions.
struct Hypertexture {
  std::string name;
  std::shared_ptr<const Field> field;
  topology::CertifyOptions certify;  // box derived from the field unless the scene gives "bounds"
  topology::KeepRule keep;
  Solver solver = Solver::kModel;
  Membership membership = Membership::kLabels;
  std::string cache;  // explicit cache file of the scene ("" if none), relative to the scene file
  nlohmann::json canonical;  // field and options that the topology depends on
  std::string hash;          // fingerprint of `canonical`, 32 hexadecimal digits
};

// Reads a geometry object {"name", "type": "hypertexture", "field", "bounds", "max_depth",
// "min_depth", "keep", "solver", "membership", "cache"}. Throws params::InputError. Deriving the
// box takes a few seconds, with many layers of noise up to a minute; throws topology::Cancelled.
Hypertexture hypertexture_from_json(const nlohmann::json& json, const params::Place& place,
                                    const topology::Execution& execution = {});

// The declaration that hypertexture_from_json reads by.
const params::Declaration& hypertexture_declaration();

// Runs the engine and returns the cache, not yet written. Throws what topology::run_engine throws.
topology::TopologyCache build_cache(const Hypertexture& hypertexture,
                                    const topology::Execution& execution = {},
                                    const topology::EngineOptions& engine = {});

}  // namespace morsel::geom
