// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/registry.h"

#include "hypertexture_geom/field/density_sphere.h"
#include "hypertexture_geom/field/sparse_convolution.h"
#include "hypertexture_geom/field/sum.h"

namespace morsel::geom {
namespace {

using params::JsonReader;
using params::Type;

DensityEntry sphere() {
  return {
      {"sphere",
       "Sphere: radius - sqrt(|x - center|^2 + smoothing^2).",
       {{"type", Type::kString, "sphere", "Kind of density."},
        {"center", Type::kVector3, {0.0, 0.0, 0.0}, "Centre.", "length"},
        {"radius", Type::kNumber, 1.0, "Radius.", "length", 0.0, 1e6, true},
        {"smoothing", Type::kNumber, 0.01, "Rounds the apex at the centre.", "length", 1e-6, 1e6}}},
      [](const JsonReader& r) {
        return make_sphere(r.vector3("center"), r.number("radius"), r.number("smoothing"));
      }};
}

ModulationEntry fbm() {
  return {{"fbm",
           "Adds octaves of noise, octave i scaled by lacunarity^(-hurst i) at frequency "
           "lacunarity^i (equation 13 of the paper).",
           {{"type", Type::kString, "fbm", "Kind of modulation."},
            {.name = "noise",
             .type = Type::kChoice,
             .default_value = "sparse_convolution",
             .help = "Basis noise.",
             .choices = {"sparse_convolution"}},
            {"amplitude", Type::kNumber, 0.1, "Factor of the first octave.", "length", -1e6, 1e6},
            {"frequency", Type::kNumber, 3.0,
             "Lattice cells per unit of length in the first octave.", "1/length", 1e-6, 1e6},
            {"layers", Type::kInteger, 1, "Number of octaves.", "", 1, 16},
            {"lacunarity", Type::kNumber, 2.0, "Ratio of the frequencies of successive octaves.",
             "", 1.0, 8.0, true},
            {"hurst", Type::kNumber, 0.8, "Hurst exponent: larger is smoother.", "", 0.0, 4.0},
            {"seed", Type::kInteger, 0, "Seed of the impulse process.", "", 0, 4294967295.0},
            {"impulses_per_cell", Type::kInteger, 3,
             "Impulses in each lattice cell (sparse convolution).", "", 1, 64}}},
          [](std::shared_ptr<const Expression> previous, const JsonReader& r) {
            SparseConvolutionParameters p;
            p.octaves = fbm_octaves(r.number("amplitude"), r.number("frequency"),
                                    static_cast<int>(r.integer("layers")), r.number("lacunarity"),
                                    r.number("hurst"));
            p.seed = static_cast<std::uint32_t>(r.integer("seed"));
            p.impulses_per_cell = static_cast<int>(r.integer("impulses_per_cell"));
            if (p.octaves.back().frequency > 1e9)
              r.place("layers").fail(
                  "the finest octave's frequency exceeds 1e9 cells per unit of length");
            return make_sum(std::move(previous), make_sparse_convolution(p));
          }};
}

template <class Entry>
const Entry& entry_of(const std::vector<Entry>& entries, const nlohmann::json& object,
                      const params::Place& place) {
  std::vector<std::string> names;
  for (const Entry& e : entries) names.push_back(e.declaration.name);
  const std::string type = params::type_of(object, names, place);
  for (const Entry& e : entries)
    if (e.declaration.name == type) return e;
  throw std::logic_error("type_of returned an unknown type");
}

}  // namespace

const std::vector<DensityEntry>& densities() {
  static const std::vector<DensityEntry> all{sphere()};
  return all;
}

const std::vector<ModulationEntry>& modulations() {
  static const std::vector<ModulationEntry> all{fbm()};
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
