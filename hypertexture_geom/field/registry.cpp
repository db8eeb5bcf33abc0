// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/registry.h"

#include "hypertexture_geom/field/bias.h"
#include "hypertexture_geom/field/fbm.h"
#include "hypertexture_geom/field/gain.h"
#include "hypertexture_geom/field/ridged.h"
#include "hypertexture_geom/field/scale_offset.h"
#include "hypertexture_geom/field/turbulence.h"
#include "hypertexture_geom/field/warp.h"

namespace morsel::geom {
namespace {

using params::JsonReader;
using params::Type;

template <class Entry>
const Entry& entry_of(const std::vector<Entry>& entries, const nlohmann::json& object,
                      const params::Place& place) {
  std::vector<std::string> names;
  names.reserve(entries.size());
  for (const Entry& e : entries) names.push_back(e.declaration.name);
  const std::string type = params::type_of(object, names, place);
  for (const Entry& e : entries)
    if (e.declaration.name == type) return e;
  throw std::logic_error("type_of returned an unknown type");
}

}  // namespace

const std::vector<ModulationEntry>& modulations() {
  static const std::vector<ModulationEntry> all{
      fbm_entry(),  turbulence_entry(),   ridged_entry(), bias_entry(),
      gain_entry(), scale_offset_entry(), warp_entry()};
  return all;
}

const DensityEntry& density_entry(const nlohmann::json& object, const params::Place& place) {
  return entry_of(densities(), object, place);
}

const ModulationEntry& modulation_entry(const nlohmann::json& object, const params::Place& place) {
  return entry_of(modulations(), object, place);
}

std::unique_ptr<Expression> density_from_json(const nlohmann::json& json,
                                              const params::Place& place) {
  const DensityEntry& entry = density_entry(json, place);
  return entry.make(JsonReader(json, entry.declaration, place));
}

}  // namespace morsel::geom
