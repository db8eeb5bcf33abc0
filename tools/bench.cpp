// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "hypertexture_geom/params/parameter.h"
#include "renderer/scene/load_scene.h"
#include "renderer/scene/scene_json.h"
#include "tools/bench_mixed.h"
#include "tools/bench_page.h"
#include "tools/bench_renderer.h"
#include "tools/bench_sweeps.h"
#include "tools/bench_vs_mesh.h"
#include "tools/commands.h"
#include "tools/count_engines.h"
#include "tools/loading_progress.h"
#include "tools/number_range.h"
#include "tools/output_file.h"
#include "tools/reporter.h"
#include "tools/scene_options.h"
#include "topology/morse/region_growing.h"

namespace morsel::tools {
namespace {

struct Options {
  SceneOptions scene;
  ReportingOptions reporting;
  std::string geometry;
  VsMeshOptions vs_mesh;
  SmallRender render;
  int threads = 0;
  int layers = 0;
  std::vector<int> engines;  // resolutions of those that have one
  bool mixed = false, scaling = false, json = false;
  std::string html;
};

void print_renderer(const nlohmann::json& result) {
  if (!result.contains("renderer")) return;
  const nlohmann::json& r = result["renderer"];
  std::cout << fmt::format("  of the scene's render {:.3f} is Embree ({} rays)\n",
                           r["efficiency"].get<double>(), r["rays"].get<std::uint64_t>());
}

// Whether there is a hypertexture to measure: a scene of meshes alone has its render measured.
bool has_hypertexture(const render::SceneDocument& document) {
  for (const render::GeometryEntry& entry : render::list_geometries(document))
    if (entry.type == "hypertexture") return true;
  return false;
}

void print_mixed(const nlohmann::json& result) {
  if (!result.contains("mixed")) return;
  const nlohmann::json& m = result["mixed"];
  std::cout << fmt::format(
      "  the scene {:.3f} of the samples/s of the same with meshes ({:.3f} to {:.3f}): {:.3g} "
      "against {:.3g}; {} triangles\n",
      m["ratio"].get<double>(), m["spread"][0].get<double>(), m["spread"][1].get<double>(),
      m["samples_per_second"]["mixed"].get<double>(), m["samples_per_second"]["mesh"].get<double>(),
      m["triangles"].get<std::uint64_t>());
}

void print_vs_mesh(const nlohmann::json& result) {
  const nlohmann::json& v = result["vs_mesh"];
  std::cout << fmt::format(
      "{}: hypertexture / Embree triangles of the same surface within {:.3g}\n",
      result["geometry"].get<std::string>(), v["error"].get<double>());
  for (const char* kind : {"primary", "incoherent", "shadow"}) {
    const nlohmann::json &range = v["spread"][kind], &rate = v["rays_per_second"][kind];
    std::cout << fmt::format(
        "  {:<11} {:6.3f} of the rays/s ({:.3f} to {:.3f}); a core: {:.3f} against {:.3f} "
        "Mrays/s; ",
        kind, v[kind].get<double>(), range[0].get<double>(), range[1].get<double>(),
        1e-6 * rate["hypertexture"].get<double>(), 1e-6 * rate["mesh"].get<double>());
    std::cout << "evaluations a ray:";
    for (const auto& [solver, count] : result["evaluations_per_ray_of"][kind].items())
      std::cout << fmt::format(" {} {:.2f}", solver, count.get<double>());
    std::cout << '\n';
  }
  std::cout << fmt::format(
      "  memory      {:6.3f} ({} bricks against {} triangles)\n  ready time  {:6.3f}\n",
      v["memory"].get<double>(), v["hypertexture"]["bricks"].get<std::uint64_t>(),
      v["mesh"]["triangles"].get<std::uint64_t>(), v["ready_time"].get<double>());
}

void print_sweeps(const nlohmann::json& result) {
  if (result.contains("scaling"))
    for (const nlohmann::json& row : result["scaling"])
      std::cout << fmt::format("  {} threads: {:.3g} samples/s, {:.2f} times one\n",
                               row["threads"].get<int>(), row["samples_per_second"].get<double>(),
                               row["speedup"].get<double>());
  if (result.contains("layers"))
    for (const nlohmann::json& row : result["layers"])
      std::cout << fmt::format(
          "  {} layers: labels {:.2f} s, {} components, {:.3g} samples/s, {:.2f} evaluations a "
          "camera ray\n",
          row["layers"].get<int>(), row["label_seconds"].get<double>(),
          row["components"].get<std::uint64_t>(), row["samples_per_second"].get<double>(),
          row["evaluations_per_ray"].get<double>());
}

void print_engines(const nlohmann::json& result) {
  if (!result.contains("engines")) return;
  for (const nlohmann::json& row : result["engines"])
    std::cout << fmt::format(
        "  {}{}: {} components{}, {:.2f} s\n", row["engine"].get<std::string>(),
        row.contains("resolution") ? fmt::format(" {}^3", row["resolution"].get<int>()) : "",
        row["components"].get<std::uint64_t>(), row["certified"].get<bool>() ? ", certified" : "",
        row["seconds"].get<double>());
}

void write_page(const std::string& name, const nlohmann::json& result,
                const std::vector<BenchPicture>& pictures) {
  OutputFile file(name);
  file.stream() << bench_page(result, pictures);
  file.commit();
}

int run(const Options& options, const Session& session) {
  if (!options.html.empty()) topology::require_replaceable(options.html);
  const render::SceneDocument document(options.scene.scene, options.scene.overrides());
  const bool camera = document.root().contains("camera");
  topology::Execution execution;
  execution.cancel = session.cancel;
  // Without a camera, or with a name, it is an error that there is no hypertexture.
  std::optional<geom::Hypertexture> hypertexture;
  if (!camera || !options.geometry.empty() || has_hypertexture(document))
    hypertexture = render::read_hypertexture(
        document, render::find_hypertexture(document, options.geometry), execution);
  if (options.scaling && !camera)
    throw UsageError("--scaling: the scene has no camera, so there is no render to measure");
  if (options.mixed && !(camera && hypertexture))
    throw UsageError("--mixed: needs a scene with a camera and a hypertexture");
  if (options.layers > 0 && !(camera && hypertexture))
    throw UsageError("--layers: needs a scene with a camera and a hypertexture");
  if (!options.engines.empty() && !hypertexture)
    throw UsageError("--engines: needs a scene with a hypertexture");
  const auto threads = limit_threads(options.threads);
  Reporter reporter(options.reporting);
  execution.progress = loading_progress(reporter);
  // First, so that a scene that can't be loaded says so at once.
  std::optional<render::LoadedScene> scene;
  if (camera) {
    render::LoadOptions load;
    load.execution = execution;
    load.warn = [&](const std::string& message) { reporter.warn(message); };
    scene = render::load_scene(options.scene.scene, options.scene.overrides(), load);
  }
  nlohmann::json result = nlohmann::json::object();
  if (hypertexture) result = bench_vs_mesh(*hypertexture, options.vs_mesh, execution, reporter);
  result["scene"] = options.scene.scene;
  SmallRender small = options.render;
  small.repetitions = options.vs_mesh.repetitions;
  if (scene) {
    result["renderer"] = bench_renderer(*scene, small, reporter);
    result["renderer_efficiency"] = result["renderer"]["efficiency"];
  }
  std::vector<BenchPicture> pictures;
  if (options.mixed) {
    MixedBench bench =
        bench_mixed(document, *scene, options.vs_mesh.error, small, execution, reporter);
    result["mixed"] = std::move(bench.result);
    pictures = std::move(bench.pictures);
  }
  if (options.scaling) result["scaling"] = bench_scaling(*scene, small, execution, reporter);
  if (options.layers > 0)
    result["layers"] = bench_layers(options.scene.scene, options.scene.overrides(),
                                    hypertexture->name, options.layers, small, execution, reporter);
  if (!options.engines.empty())
    result["engines"] =
        count_by_engines(*hypertexture, {.resolutions = options.engines}, execution, reporter);
  result["threads"] =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  if (!options.html.empty()) write_page(options.html, result, pictures);
  if (options.json) {
    std::cout << result.dump(2) << '\n';
    return kDone;
  }
  if (hypertexture) print_vs_mesh(result);
  print_renderer(result);
  print_mixed(result);
  print_sweeps(result);
  print_engines(result);
  if (!options.html.empty()) std::cout << options.html << '\n';
  return kDone;
}

// A scene may have any name; one that is not there and looks like a command below is that one.
void refuse_misspelt_command(const CLI::App& command, const std::string& scene) {
  if (std::filesystem::exists(scene)) return;
  std::vector<std::string> names;
  for (const CLI::App* sub : command.get_subcommands({})) names.push_back(sub->get_name());
  const std::string near = params::nearest_name(scene, names);
  if (!near.empty())
    throw CLI::ParseError(
        fmt::format("{}: no such file or command, did you mean \"{}\"?", scene, near),
        CLI::ExitCodes::ExtrasError);
}

}  // namespace

void add_bench(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand(
      "bench", "Measure a hypertexture against Embree triangles of the same surface");
  add_scene_options(*command, options->scene);
  command->get_option("SCENE")->required(false);  // not of the subcommands, that is
  command->require_subcommand(0, 1);
  add_bench_topology(*command, session);
  command->add_option("--geometry", options->geometry,
                      "Hypertexture geometry; may be left out if there is only one, or none");
  command
      ->add_option("--error", options->vs_mesh.error,
                   "Error of the mesh as a share of the diagonal of what is kept")
      ->check(number_from(1e-7, 0.1))
      ->capture_default_str();
  command->add_option("--resolution", options->vs_mesh.side, "Side of the image for primary rays")
      ->check(CLI::Range(16, 8192))
      ->capture_default_str();
  command->add_option("--repetitions", options->vs_mesh.repetitions, "Of each measurement")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--render-width", options->render.width,
                   "Width of the picture whose rays are replayed")
      ->check(CLI::Range(1, 8192))
      ->capture_default_str();
  command->add_option("--render-spp", options->render.spp, "Its samples a pixel")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_flag("--mixed", options->mixed,
                    "Also the render against the same scene of meshes alone");
  command->add_flag("--scaling", options->scaling,
                    "Also the render with 1, 2, 4, ... threads up to all of the processor's");
  command
      ->add_option("--layers", options->layers,
                   "Also the hypertexture with 1 to this many layers of noise: labels, rays")
      ->check(CLI::Range(1, 16));
  command
      ->add_option("--engines", options->engines,
                   "Also the components as every method counts them, with times: certified, Morse, "
                   "and voxels and meshes with so many cells along each side, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(2, topology::kMaxGridResolution));
  command->add_option("--html", options->html, "Also write a page with plots, complete in itself");
  command->add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(*command, options->threads);
  add_reporting_options(*command, options->reporting);
  command->callback([options, command, &session] {
    if (!command->get_subcommands().empty()) return;
    if (options->scene.scene.empty()) throw CLI::RequiredError("SCENE");
    refuse_misspelt_command(*command, options->scene.scene);
    session.run = [options, &session] { return run(*options, session); };
  });
}

}  // namespace morsel::tools
