// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "renderer/scene/scene_json.h"
#include "tools/commands.h"
#include "tools/reporter.h"
#include "tools/scene_options.h"
#include "topology/cache_file.h"
#include "topology/verify.h"

namespace morsel::tools {
namespace {

struct Options {
  std::string file;
  SceneOptions scene;
  ReportingOptions reporting;
  std::string geometry;
  topology::VerifyOptions verify;
  int threads = 0;
  bool json = false;
};

// The geometry that is named, else the one whose field the cache is of.
geom::Hypertexture find_geometry(const render::SceneDocument& document, const Options& options,
                                 const std::string& hash, const topology::Execution& execution) {
  if (!options.geometry.empty())
    return render::read_hypertexture(
        document, render::find_hypertexture(document, options.geometry), execution);
  std::string found;
  for (const render::GeometryEntry& entry : render::list_geometries(document)) {
    if (entry.type != "hypertexture") continue;
    geom::Hypertexture hypertexture = render::read_hypertexture(document, entry, execution);
    if (hypertexture.hash == hash) return hypertexture;
    found +=
        fmt::format("{}{} ({})", found.empty() ? "" : ", ", hypertexture.name, hypertexture.hash);
  }
  throw topology::CacheError(fmt::format("{}: its fingerprint is {}; {} has: {}", options.file,
                                         hash, document.file().string(),
                                         found.empty() ? "no hypertexture" : found));
}

int run(const Options& options, const Session& session) {
  const auto threads = limit_threads(options.threads);
  Reporter reporter(options.reporting);
  topology::Execution execution;
  execution.cancel = session.cancel;
  const topology::TopologyCache cache = topology::read_cache(options.file);
  const render::SceneDocument document(options.scene.scene, options.scene.overrides());
  const geom::Hypertexture hypertexture =
      find_geometry(document, options, cache.field_hash, execution);
  if (hypertexture.hash != cache.field_hash)
    throw topology::CacheError(
        fmt::format("{}: is the cache of another field: its fingerprint is "
                    "{}, that of {} is {}",
                    options.file, cache.field_hash, hypertexture.name, hypertexture.hash));
  execution.progress = [&](double fraction, const char* phase) {
    reporter.progress(fraction, fmt::format("{}: {}", hypertexture.name, phase));
  };
  const topology::VerifyReport report =
      topology::verify(*hypertexture.field, cache.topology, options.verify, execution);
  if (options.json) {
    const nlohmann::json result = {{"file", options.file},
                                   {"geometry", hypertexture.name},
                                   {"passed", report.passed()},
                                   {"full", options.verify.full},
                                   {"leaves", report.leaves},
                                   {"cells_proved", report.cells_proved},
                                   {"faces_proved", report.faces_proved},
                                   {"undecided", report.undecided},
                                   {"joins_checked", report.joins_checked},
                                   {"failure_count", report.failure_count},
                                   {"failures", report.failures}};
    std::cout << result.dump(2) << '\n';
  } else {
    for (const std::string& failure : report.failures) std::cout << failure << '\n';
    std::cout << fmt::format(
        "{}: {}: {} of {} cells and {} faces proved again, {} joins checked, {} failure{}\n",
        options.file, report.passed() ? "passed" : "FAILED", report.cells_proved, report.leaves,
        report.faces_proved, report.joins_checked, report.failure_count,
        report.failure_count == 1 ? "" : "s");
  }
  return report.passed() ? kDone : kFailed;
}

}  // namespace

void add_cache_verify(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand(
      "verify", "Prove a topology cache again: labels as a whole, a sample of cells and faces");
  command->add_option("FILE", options->file, "Topology cache (.topo)")->required();
  add_scene_options(*command, options->scene);
  command->add_option("--geometry", options->geometry,
                      "The geometry it is of (else found by the fingerprint)");
  command->add_option("--samples", options->verify.samples, "Cells to prove again")
      ->capture_default_str();
  command->add_option("--seed", options->verify.seed, "Which cells are drawn")
      ->capture_default_str();
  command->add_flag("--full", options->verify.full, "Prove every cell and face");
  command->add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(*command, options->threads);
  add_reporting_options(*command, options->reporting);
  command->callback([options, &session] {
    session.run = [options, &session] { return run(*options, session); };
  });
}

}  // namespace morsel::tools
