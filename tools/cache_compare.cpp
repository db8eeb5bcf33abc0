// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <optional>

#include "renderer/scene/scene_json.h"
#include "tools/commands.h"
#include "tools/reporter.h"
#include "tools/scene_options.h"
#include "topology/bound_solid.h"
#include "topology/morse/morse_complex.h"
#include "topology/morse/region_growing.h"

namespace morsel::tools {
namespace {

using topology::RegionCount;

struct Options {
  SceneOptions scene;
  ReportingOptions reporting;
  std::string geometry;
  std::vector<std::string> engines{"certified", "morse", "voxel", "mesh"};
  std::vector<int> resolutions{64, 128, 256, 512, 1024};
  bool json = false;
  int threads = 0;
};

class Comparison {
 public:
  Comparison(const Options& options, const Session& session)
      : options_(options), reporter_(options.reporting) {
    execution_.cancel = session.cancel;
    execution_.progress = [this](double fraction, const char* phase) {
      reporter_.progress(fraction, fmt::format("{}: {}", current_, phase));
    };
  }

  int run() {
    const auto threads = limit_threads(options_.threads);
    const render::SceneDocument document(options_.scene.scene, options_.scene.overrides());
    const render::GeometryEntry entry = render::find_hypertexture(document, options_.geometry);
    const geom::Hypertexture rock = render::read_hypertexture(document, entry, execution_);
    const topology::Box box = topology::dyadic_box(rock.certify.box);
    cut_ = topology::place_where_cut(*rock.field, box, execution_);
    if (cut_)
      reporter_.warn(
          fmt::format("geometry \"{}\": its surface reaches its bounds near ({:.4g}, {:.4g}, "
                      "{:.4g}) and is cut "
                      "there; pieces that have no maximum inside are not among the Morse engine's",
                      rock.name, cut_->x, cut_->y, cut_->z));
    if (!options_.json)
      std::cout << fmt::format("{:<10} {:>10} {:>12} {:>10}  {}\n", "engine", "resolution",
                               "components", "seconds", "certified");
    for (const std::string& engine : options_.engines) {
      current_ = engine;
      if (engine == "certified")
        certified(rock);
      else if (engine == "morse")
        morse(rock, box);
      else
        for (const int n : options_.resolutions)
          row(engine, n,
              engine == "voxel" ? topology::grow_voxel_regions(*rock.field, box, n, execution_)
                                : topology::grow_mesh_regions(*rock.field, box, n, execution_));
    }
    if (options_.json) std::cout << results_.dump(2) << '\n';
    return kDone;
  }

 private:
  void certified(const geom::Hypertexture& rock) {
    const auto start = std::chrono::steady_clock::now();
    const topology::Topology t = topology::certify(*rock.field, rock.certify, execution_);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    print("certified", 0, t.components.size(), seconds,
          t.certified ? "yes"
                      : fmt::format("no: {} cells, {} faces undecided", t.unresolved_cells,
                                    t.unresolved_faces));
    results_.push_back({{"engine", "certified"},
                        {"components", t.components.size()},
                        {"certified", t.certified},
                        {"seconds", seconds}});
  }

  void morse(const geom::Hypertexture& rock, const topology::Box& box) {
    topology::MorseOptions options;
    options.box = box;
    const topology::MorseComplex c = topology::morse_complex(*rock.field, options, execution_);
    print("morse", 0, c.sets.size(), c.seconds_points + c.seconds_separatrices,
          cut_           ? "no: the box cuts the solid"
          : c.resolved() ? "critical points, not separatrices"
                         : "no: some are unresolved");
    results_.push_back(
        {{"engine", "morse"},
         {"components", c.sets.size()},
         {"certified", false},
         {"maxima", c.count(topology::CriticalType::kMaximum)},
         {"saddles2", c.count(topology::CriticalType::kSaddle2)},
         {"boxes", c.boxes},
         {"touches_box", cut_ ? nlohmann::json{cut_->x, cut_->y, cut_->z} : nlohmann::json()},
         {"lost_ascents", c.lost.size()},
         {"unresolved_boxes", c.unresolved_boxes},
         {"seconds", c.seconds_points + c.seconds_separatrices}});
  }

  void row(const std::string& engine, int n, const RegionCount& count) {
    print(engine, n, count.components, count.seconds, "no");
    results_.push_back({{"engine", engine},
                        {"resolution", n},
                        {"components", count.components},
                        {"certified", false},
                        {"elements", count.elements},
                        {"evaluations", count.evaluations},
                        {"seconds", count.seconds}});
  }

  void print(const std::string& engine, int n, std::uint64_t components, double seconds,
             const std::string& certified) {
    if (options_.json) return;
    std::cout << fmt::format("{:<10} {:>10} {:>12} {:>10.2f}  {}\n", engine,
                             n == 0 ? "" : std::to_string(n), components, seconds, certified)
              << std::flush;
  }

  const Options& options_;
  Reporter reporter_;
  topology::Execution execution_;
  std::string current_;
  std::optional<Imath::V3d> cut_;  // where the box cuts the solid
  nlohmann::json results_ = nlohmann::json::array();
};

}  // namespace

void add_cache_compare(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand(
      "compare",
      "Count components by every method: certified, Morse, and region growing over voxels and over "
      "a polygonal mesh, which are not certified");
  add_scene_options(*command, options->scene);
  command->add_option("--geometry", options->geometry, "This hypertexture geometry");
  command
      ->add_option("--engine", options->engines,
                   "Methods, separated by commas: certified, morse, voxel, mesh")
      ->delimiter(',')
      ->check(CLI::IsMember({"certified", "morse", "voxel", "mesh"}))
      ->capture_default_str();
  command
      ->add_option("--resolution", options->resolutions,
                   "Voxels along each side of the box, separated by commas, for voxel and mesh")
      ->delimiter(',')
      ->check(CLI::Range(2, topology::kMaxGridResolution))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(*command, options->threads);
  add_reporting_options(*command, options->reporting);
  command->callback([options, &session] {
    session.run = [options, &session] { return Comparison(*options, session).run(); };
  });
}

}  // namespace morsel::tools
