// SPDX-License-Identifier: Apache-2.0
#include "tools/count_engines.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>

#include "topology/bound_solid.h"
#include "topology/morse/morse_complex.h"
#include "topology/morse/region_growing.h"

namespace morsel::tools {
namespace {

using nlohmann::json;

struct Row {
  json values;
  std::string certified;
};

Row certified_row(const geom::Hypertexture& rock, const topology::Execution& execution) {
  const auto start = std::chrono::steady_clock::now();
  const topology::Topology t = topology::certify(*rock.field, rock.certify, execution);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return {{{"engine", "certified"},
           {"components", t.components.size()},
           {"certified", t.certified},
           {"seconds", seconds.count()}},
          t.certified ? "yes"
                      : fmt::format("no: {} cells, {} faces undecided", t.unresolved_cells,
                                    t.unresolved_faces)};
}

// `cut`: where the box cuts the solid.
Row morse_row(const geom::Hypertexture& rock, const topology::Box& box,
              const std::optional<Imath::V3d>& cut, const topology::Execution& execution) {
  topology::MorseOptions options;
  options.box = box;
  const topology::MorseComplex c = topology::morse_complex(*rock.field, options, execution);
  return {{{"engine", "morse"},
           {"components", c.sets.size()},
           {"certified", false},
           {"maxima", c.count(topology::CriticalType::kMaximum)},
           {"saddles2", c.count(topology::CriticalType::kSaddle2)},
           {"boxes", c.boxes},
           {"touches_box", cut ? json{cut->x, cut->y, cut->z} : json()},
           {"lost_ascents", c.lost.size()},
           {"unresolved_boxes", c.unresolved_boxes},
           {"seconds", c.seconds_points + c.seconds_separatrices}},
          cut            ? "no: the box cuts the solid"
          : c.resolved() ? "critical points, not separatrices"
                         : "no: some are unresolved"};
}

Row grown_row(const std::string& engine, int n, const topology::RegionCount& count) {
  return {{{"engine", engine},
           {"resolution", n},
           {"components", count.components},
           {"certified", false},
           {"elements", count.elements},
           {"evaluations", count.evaluations},
           {"seconds", count.seconds}},
          "no"};
}

}  // namespace

json count_by_engines(
    const geom::Hypertexture& hypertexture, const EngineChoice& choice,
    topology::Execution execution, Reporter& reporter,
    const std::function<void(const json& row, const std::string& certified)>& each) {
  std::string current;
  execution.progress = [&](double fraction, const char* phase) {
    reporter.progress(fraction, fmt::format("{}: {}", current, phase));
  };
  const topology::Box box = topology::dyadic_box(hypertexture.certify.box);
  const std::optional<Imath::V3d> cut =
      topology::place_where_cut(*hypertexture.field, box, execution);
  if (cut)
    reporter.warn(
        fmt::format("geometry \"{}\": its surface reaches its bounds near ({:.4g}, {:.4g}, "
                    "{:.4g}) and is cut "
                    "there; pieces that have no maximum inside are not among the Morse engine's",
                    hypertexture.name, cut->x, cut->y, cut->z));
  json rows = json::array();
  const auto add = [&](Row row) {
    if (each) each(row.values, row.certified);
    rows.push_back(std::move(row.values));
  };
  for (const std::string& engine : choice.engines) {
    current = engine;
    if (engine == "certified")
      add(certified_row(hypertexture, execution));
    else if (engine == "morse")
      add(morse_row(hypertexture, box, cut, execution));
    else
      for (const int n : choice.resolutions)
        add(grown_row(engine, n,
                      engine == "voxel"
                          ? topology::grow_voxel_regions(*hypertexture.field, box, n, execution)
                          : topology::grow_mesh_regions(*hypertexture.field, box, n, execution)));
  }
  return rows;
}

}  // namespace morsel::tools
