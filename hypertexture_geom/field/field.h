// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "hypertexture_geom/field/term.h"
#include "hypertexture_geom/params/json_reader.h"
#include "topology/cache_file.h"
#include "topology/certified.h"
#include "topology/scalar_field.h"

namespace morsel::geom {

// A field that came from a scene file.
class Field : public Term {
 public:
  // The field's description with every default filled in and keys in a fixed order.
  virtual nlohmann::json canonical_json() const = 0;

  // A box outside of which F < 0 is certain; may be far too large. Empty when the solid is
  // unbounded.
  virtual std::optional<topology::Box> solid_bounds() const = 0;
};

// The declaration of {"density", "modulations"}.
const params::Declaration& field_declaration();

// Reads {"density": {...}, "modulations": [{...}, ...]}. Throws params::InputError.
std::shared_ptr<const Field> field_from_json(const nlohmann::json& json,
                                             const params::Place& place);

// A hypertexture geometry of a scene: the field, the box that its topology is computed in, and how.
struct Hypertexture {
  std::string name;
  std::shared_ptr<const Field> field;
  topology::CertifyOptions certify;  // box derived from the field unless the scene gives "bounds"
  topology::KeepRule keep;
  std::string cache;  // explicit cache file of the scene ("" if none), relative to the scene file
  nlohmann::json canonical;  // field and options that the topology depends on
  std::string hash;          // fingerprint of `canonical`, 32 hexadecimal digits
};

// Reads a geometry object {"name", "type": "hypertexture", "field", "bounds", "max_depth",
// "min_depth", "keep", "cache"}. Throws params::InputError. Deriving the box takes up to a few
// seconds.
Hypertexture hypertexture_from_json(const nlohmann::json& json, const params::Place& place);

// The declaration that hypertexture_from_json reads by.
const params::Declaration& hypertexture_declaration();

// Runs the certified engine and returns the cache, not yet written. Throws topology::Cancelled.
topology::TopologyCache build_cache(const Hypertexture& hypertexture,
                                    const topology::Execution& execution = {});

}  // namespace morsel::geom
