// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <set>

#include "renderer/scene/cache_store.h"
#include "renderer/scene/scene_json.h"
#include "tools/commands.h"
#include "tools/number_range.h"
#include "tools/reporter.h"
#include "tools/scene_options.h"
#include "topology/morse/engine.h"
#include "topology/morse/morse_sections.h"

namespace morsel::tools {
namespace {

namespace fs = std::filesystem;
using render::CacheState;

constexpr std::uint64_t kAnyNumber = std::numeric_limits<std::uint64_t>::max();

struct Options {
  SceneOptions scene;
  ReportingOptions reporting;
  std::string geometry;
  std::string output;
  bool force = false;
  bool json = false;
  int threads = 0;
  int max_depth = 0;  // 0: as the scene says
  std::string engine = "certified";
  double perturbation = 0.0;
  std::string euler = "auto";
  double max_memory = 0.0;  // GiB
};

// What the engines' audit said, or null when there was none.
nlohmann::json audit_of(const topology::TopologyCache& cache) {
  const nlohmann::json meta = topology::morse_meta(cache.sections, "topology cache");
  if (!meta.is_object() || !meta.contains("audit") || !meta["audit"].is_object()) return {};
  return meta["audit"];
}

// Why the cache has to be built; empty when the one that is there is current.
// A file that is no cache at all is replaced only at a name of our own making.
std::string reason_to_build(const render::CacheInspection& found, bool own_name, bool force,
                            const topology::EngineOptions& wanted) {
  const topology::Engine engine = wanted.engine;
  switch (found.state) {
    case CacheState::kMissing:
      return "missing";
    case CacheState::kStale:
      return "stale";
    case CacheState::kDamaged:
      if (own_name || force) return "damaged";
      throw std::runtime_error(found.problem + " (use --force to replace the file)");
    case CacheState::kCurrent: {
      const std::string& has = found.cache->topology.engine;
      const bool by_morse = has == to_string(topology::Engine::kMorse);
      const bool audited = !audit_of(*found.cache).is_null();
      // Certified labels are good for whoever asks for no more than them; an audit that could not
      // be made would not be another time.
      const bool serves = engine == topology::Engine::kCertified ? !by_morse
                          : engine == topology::Engine::kMorse   ? by_morse
                                                                 : audited;
      if (!serves) return fmt::format("made by the engine \"{}\"", has);
      if (engine == topology::Engine::kCertified) break;
      const nlohmann::json meta = topology::morse_meta(found.cache->sections, "topology cache");
      if (const double had = meta.value("perturbation", 0.0); had != wanted.perturbation)
        return fmt::format("made with the perturbation {}", had);
      if (engine == topology::Engine::kBoth && wanted.audit.mesh_leaves == kAnyNumber &&
          !audit_of(*found.cache).value("mesh_asked", false))
        return "audited without the mesh";
      break;
    }
  }
  return force ? "forced" : "";
}

class Builder {
 public:
  Builder(const Options& options, const Session& session)
      : options_(options),
        reporter_(options.reporting),
        document_(options.scene.scene, overrides()),
        engine_(topology::engine_named(options.engine)) {
    execution_.cancel = session.cancel;
    execution_.max_bytes = bytes_of(options.max_memory);
    engine_.perturbation = options.perturbation;
    engine_.audit.mesh = options.euler != "octree";
    if (options.euler == "mesh") engine_.audit.mesh_leaves = kAnyNumber;
  }

  int run() {
    const auto threads = limit_threads(options_.threads);
    std::set<std::string> done;
    for (const render::GeometryEntry& entry : selected()) {
      const geom::Hypertexture hypertexture =
          render::read_hypertexture(document_, entry, execution_);
      if (!done.insert(hypertexture.hash).second) {
        reporter_.info(fmt::format("{}: the same field as another geometry", entry.name));
        continue;
      }
      build(hypertexture);
    }
    if (options_.json) std::cout << results_.dump(2) << '\n';
    // The caches hold certified labels, but that was not all that was asked for.
    if (!not_compared_.empty()) throw std::runtime_error(not_compared_);
    return kDone;
  }

 private:
  std::vector<render::Override> overrides() const {
    std::vector<render::Override> all = options_.scene.overrides();
    if (options_.max_depth == 0) return all;
    for (render::Override& change :
         for_each_hypertexture(options_.scene.scene, all, "max_depth", options_.max_depth,
                               fmt::format("--max-depth {}", options_.max_depth)))
      all.push_back(std::move(change));
    return all;
  }

  std::vector<render::GeometryEntry> selected() {
    if (!options_.geometry.empty() || !options_.output.empty())
      return {render::find_hypertexture(document_, options_.geometry)};
    std::vector<render::GeometryEntry> all;
    for (const render::GeometryEntry& entry : render::list_geometries(document_))
      if (entry.type == "hypertexture") all.push_back(entry);
    if (all.empty()) reporter_.warn("the scene has no hypertexture geometry: nothing to build");
    return all;
  }

  void build(const geom::Hypertexture& hypertexture) {
    const bool own_name = options_.output.empty() && hypertexture.cache.empty();
    const fs::path file = options_.output.empty() ? render::cache_file_of(document_, hypertexture)
                                                  : fs::path(options_.output);
    render::CacheInspection found = render::inspect_cache(file, hypertexture.hash);
    const std::string reason = reason_to_build(found, own_name, options_.force, engine_);
    if (!reason.empty()) {
      reporter_.debug(fmt::format("{}: {} is {}", hypertexture.name, file.string(), reason));
      topology::Execution execution = execution_;
      execution.progress = [&](double fraction, const char* phase) {
        reporter_.progress(fraction, fmt::format("{}: {}", hypertexture.name, phase));
      };
      try {
        found.cache = render::build_and_write(hypertexture, file, execution, engine_);
      } catch (const topology::EnginesDisagree& e) {
        throw topology::EnginesDisagree(fmt::format("{}: {}", hypertexture.name, e.what()));
      }
    }
    if (engine_.engine == topology::Engine::kBoth)
      check_audit(hypertexture.name, file, *found.cache);
    report(hypertexture, file, reason, *found.cache);
  }

  void report(const geom::Hypertexture& hypertexture, const fs::path& file,
              const std::string& reason, const topology::TopologyCache& cache) {
    for (const std::string& text : render::topology_warnings(hypertexture, cache.topology))
      reporter_.warn(text);
    if (options_.json) {
      nlohmann::json result = topology::describe(cache, hypertexture.keep);
      result["geometry"] = hypertexture.name;
      result["file"] = file.string();
      result["built"] = !reason.empty();
      result["reason"] = reason.empty() ? "up to date" : reason;
      results_.push_back(std::move(result));
      return;
    }
    const std::size_t components = cache.topology.components.size();
    std::cout << fmt::format("{}: {}: {} ({} component{}, {}{}, {:.2f} s)\n", hypertexture.name,
                             file.string(), reason.empty() ? "up to date" : "built, was " + reason,
                             components, components == 1 ? "" : "s",
                             cache.topology.certified ? "certified" : "NOT certified",
                             describe_audit(cache), cache.seconds);
    const nlohmann::json description = topology::describe(cache, hypertexture.keep);
    if (const nlohmann::json& morse = description["morse"]; morse.is_object()) {
      const nlohmann::json& points = description["critical_points"];
      std::cout << fmt::format(
          "  critical points: {} maxima, {} 2-saddles, {} 1-saddles, {} minima, {} degenerate; {} "
          "boxes tested, {} undecided; {} ascents lost; {:.2f} s, separatrices {:.2f} s{}\n",
          points["maxima"].dump(), points["saddles2"].dump(), points["saddles1"].dump(),
          points["minima"].dump(), points["degenerate"].dump(), morse["boxes"].dump(),
          morse["unresolved_boxes"].dump(), morse["lost_ascents"].size(),
          morse["seconds_critical_points"].get<double>(),
          morse["seconds_separatrices"].get<double>(), describe_audit_time(morse["audit"]));
    }
  }

  static std::string describe_audit_time(const nlohmann::json& audit) {
    return audit.is_object() ? fmt::format(", audit {:.2f} s", audit.value("seconds", 0.0)) : "";
  }

  void check_audit(const std::string& geometry, const fs::path& file,
                   const topology::TopologyCache& cache) {
    const nlohmann::json audit = audit_of(cache);
    if (audit.value("agreed", false)) return;
    not_compared_ += fmt::format(
        "{}{}: the engines could not be compared; {} holds certified labels, and critical points "
        "without an audit:",
        not_compared_.empty() ? "" : "\n", geometry, file.string());
    for (const auto& reason : audit.value("reasons", nlohmann::json::array()))
      not_compared_ += fmt::format("\n  {}", reason.get<std::string>());
  }

  static std::string describe_audit(const topology::TopologyCache& cache) {
    const nlohmann::json audit = audit_of(cache);
    if (audit.is_null()) return "";
    if (!audit.value("agreed", false)) return ", engines NOT compared";
    const bool mesh = audit.value("euler_compared_with", nlohmann::json::array()).size() > 1;
    const bool asked = audit.value("mesh_asked", false);
    return fmt::format(", engines agree, Euler characteristics by octree{}",
                       mesh    ? " and mesh"
                       : asked ? " alone (the mesh was made but is not certified)"
                               : "");
  }

  const Options& options_;
  Reporter reporter_;
  render::SceneDocument document_;
  topology::EngineOptions engine_;
  topology::Execution execution_;
  nlohmann::json results_ = nlohmann::json::array();
  std::string not_compared_;  // what to fail with in the end
};

// Names of comparators lead to where they are; anything else gets the choices.
std::string check_engine(const std::string& name) {
  if (name == "voxel" || name == "mesh")
    return fmt::format(
        "the engine \"{}\" counts regions of a grid, not certified, and labels nothing that a "
        "cache "
        "could hold; count with `morsel cache compare SCENE --engine {} --resolution N`",
        name, name);
  try {
    topology::engine_named(name);
    return "";
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
}

}  // namespace

void add_cache_build(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand(
      "build", "Build the topology caches of a scene where they are missing or stale");
  add_scene_options(*command, options->scene);
  command->add_option("--geometry", options->geometry, "Only this hypertexture geometry");
  command->add_option("-o,--output", options->output,
                      "Write the cache of one geometry to this file");
  command->add_flag("--force", options->force, "Build even if the cache is up to date");
  command
      ->add_option("--max-depth", options->max_depth,
                   "Depth limit of the octree instead of the scene's (changes the fingerprint)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option(
          "--engine", options->engine,
          "certified: the octree; morse: critical points and separatrices; both: certified "
          "labels, critical points beside them, and an audit of one by the other, which fails when "
          "they disagree or cannot be compared")
      ->check(CLI::Validator([](std::string& name) { return check_engine(name); },
                             "{certified,morse,both}"))
      ->capture_default_str();
  command
      ->add_option(
          "--perturb", options->perturbation,
          "morse, both: look for critical points of the field plus a linear term that is at "
          "most this on the box, for fields whose critical points are not isolated")
      ->check(number_from_zero());
  command
      ->add_option(
          "--audit-euler", options->euler,
          "both: compare the Euler characteristics of the critical points with those of the "
          "octree's cells alone, or also with those of the certified mesh, which takes several "
          "times as long; auto: with the mesh up to a million leaves")
      ->check(CLI::IsMember({"auto", "octree", "mesh"}))
      ->capture_default_str();
  add_max_memory_option(*command, options->max_memory,
                        "an octree may take while it is built; beyond, the build fails and leaves "
                        "what it has in FILE.partial");
  command->add_flag("--json", options->json, "Print what `cache info --json` says of each cache");
  add_threads_option(*command, options->threads);
  add_reporting_options(*command, options->reporting);
  command->callback([options, &session] {
    session.run = [options, &session] { return Builder(*options, session).run(); };
  });
}

}  // namespace morsel::tools
