// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/mesh.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>

#include "renderer/scene/cache_store.h"
#include "renderer/scene/scene_json.h"
#include "tools/commands.h"
#include "tools/mesh_file.h"
#include "tools/number_range.h"
#include "tools/output_file.h"
#include "tools/reporter.h"
#include "tools/scene_options.h"

namespace morsel::tools {
namespace {

struct Options {
  SceneOptions scene;
  ReportingOptions reporting;
  std::string geometry;
  std::string output;
  std::string keep;  // empty: as the scene says
  topology::MeshOptions mesh;
  int threads = 0;
  double max_memory = 0.0;  // GiB
  bool json = false;
};

nlohmann::json describe_component(const topology::MeshComponent& c) {
  return {{"component", c.component},
          {"vertices", c.vertices},
          {"triangles", c.triangles},
          {"surfaces", c.surfaces},
          {"area", c.area},
          {"volume", c.volume},
          {"euler_characteristic", c.euler_characteristic}};
}

nlohmann::json describe_unresolved(const topology::Unresolved& u) {
  const Imath::V3d at = topology::centre(u.box), size = u.box.max - u.box.min;
  return {{"centre", {at.x, at.y, at.z}}, {"size", {size.x, size.y, size.z}}, {"value", u.value}};
}

void report(const Options& options, const geom::Hypertexture& hypertexture, const std::string& keep,
            const topology::Mesh& mesh, bool labels_certified, double seconds, Reporter& reporter) {
  const std::vector<topology::MeshComponent> parts = topology::mesh_components(mesh);
  if (mesh.unresolved_cells > 0) {
    const Imath::V3d at = topology::centre(mesh.unresolved[0].box);
    reporter.warn(fmt::format(
        "{} cells at the depth limit: {}; one is at ({:.6g}, {:.6g}, {:.6g})",
        mesh.unresolved_cells,
        mesh.certified ? "the error is not met there" : "the topology is not certified there", at.x,
        at.y, at.z));
  }
  if (options.json) {
    nlohmann::json result = {{"file", options.output},
                             {"geometry", hypertexture.name},
                             {"keep", keep},
                             {"error", options.mesh.error},
                             {"error_bound", mesh.error_bound},
                             {"certified", mesh.certified},
                             {"labels_certified", labels_certified},
                             {"unresolved_cells", mesh.unresolved_cells},
                             {"vertices", mesh.positions.size()},
                             {"triangles", mesh.triangles.size()},
                             {"cells", mesh.cells},
                             {"depth", mesh.depth},
                             {"seconds", seconds},
                             {"bytes", std::filesystem::file_size(options.output)}};
    result["components"] = nlohmann::json::array();
    for (const auto& part : parts) result["components"].push_back(describe_component(part));
    result["unresolved"] = nlohmann::json::array();
    for (const auto& u : mesh.unresolved) result["unresolved"].push_back(describe_unresolved(u));
    std::cout << result.dump(2) << '\n';
    return;
  }
  std::cout << fmt::format(
      "{}: {} triangles, {} vertices, {} component{} of {}, within {:.3g} of the surface, {}{}, "
      "{:.2f} s\n",
      options.output, mesh.triangles.size(), mesh.positions.size(), parts.size(),
      parts.size() == 1 ? "" : "s", hypertexture.name, mesh.error_bound,
      mesh.certified ? "topology certified" : "topology NOT certified",
      labels_certified ? "" : ", labels NOT certified", seconds);
  constexpr std::size_t kShown = 10;
  for (std::size_t i = 0; i < std::min(parts.size(), kShown); ++i)
    std::cout << fmt::format(
        "  component {}: {} closed surface{}, Euler characteristic {}, area {:.6g}, volume "
        "{:.6g}\n",
        parts[i].component, parts[i].surfaces, parts[i].surfaces == 1 ? "" : "s",
        parts[i].euler_characteristic, parts[i].area, parts[i].volume);
  if (parts.size() > kShown)
    std::cout << fmt::format("  and {} more (--json lists all)\n", parts.size() - kShown);
}

std::string extension_of(const std::string& file) {
  return std::filesystem::path(file).extension().string();
}

// Empty if there is none.
std::string problem_of_output(const std::string& file) {
  const std::string extension = extension_of(file);
  if (extension == ".ply" || extension == ".glb" || extension == ".obj") return "";
  return fmt::format("{}: must end in .ply, .glb or .obj", file);
}

double write(std::ostream& out, const topology::Mesh& mesh, double error,
             const std::string& extension) {
  if (extension == ".ply") return write_ply(out, mesh, error);
  return extension == ".glb" ? write_glb(out, mesh, error) : write_obj(out, mesh, error);
}

int run(const Options& options, const Session& session) {
  const auto threads = limit_threads(options.threads);
  topology::Execution execution;
  execution.cancel = session.cancel;
  execution.max_bytes = bytes_of(options.max_memory);
  const render::SceneDocument document(options.scene.scene, options.scene.overrides());
  const geom::Hypertexture hypertexture = render::read_hypertexture(
      document, render::find_hypertexture(document, options.geometry), execution);
  topology::KeepRule keep = hypertexture.keep;
  if (!options.keep.empty()) {
    try {
      keep = topology::KeepRule::parse(options.keep);
    } catch (const std::invalid_argument& e) {
      throw UsageError(fmt::format("--keep {}: {}", options.keep, e.what()));
    }
  }
  Reporter reporter(options.reporting);
  OutputFile file(options.output);

  execution.progress = [&](double fraction, const char* phase) {
    reporter.progress(fraction, fmt::format("{}: {}", hypertexture.name, phase));
  };
  const auto cache = render::CacheStore(document).get(
      hypertexture, execution, [&](const std::string& message) { reporter.warn(message); });
  const topology::Topology& t = cache.cache->topology;
  for (const std::string& text : render::topology_warnings(hypertexture, t)) reporter.warn(text);
  // What rounding to floats may add is left to it.
  topology::MeshOptions within = options.mesh;
  within.error *= 0.99;
  const auto start = std::chrono::steady_clock::now();
  topology::Mesh mesh = topology::extract_mesh(
      *hypertexture.field, t.octree(), topology::kept_components(keep, t.components, t.octree()),
      within, execution);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  mesh.error_bound += write(file.stream(), mesh, options.mesh.error, extension_of(options.output));
  file.commit();
  report(options, hypertexture, keep.to_string(), mesh, t.certified, seconds.count(), reporter);
  return kDone;
}

}  // namespace

void add_mesh(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand(
      "mesh", "Write a closed triangle mesh of what is kept of a hypertexture geometry");
  add_scene_options(*command, options->scene);
  command->add_option("--geometry", options->geometry,
                      "Hypertexture geometry; may be left out if there is only one");
  command
      ->add_option("--error", options->mesh.error,
                   "Largest distance of the mesh from the surface, in object-space lengths")
      ->required()
      ->check(number_above_zero());
  command->add_option("--keep", options->keep,
                      "Components to mesh instead of those that the scene keeps: main, largest:K, "
                      "volume:V, touching:X,Y,Z, all, detached, ids:I,J,...");
  command
      ->add_option("--max-depth", options->mesh.max_depth,
                   "Level of the octree below which cells are not subdivided")
      ->check(CLI::Range(1, topology::kMaxDepth))
      ->capture_default_str();
  // Before anything is said of what is missing, and of the last that is given.
  const auto set_output = [options](const std::string& file) {
    const std::string problem = problem_of_output(file);
    if (!problem.empty()) throw CLI::ValidationError("--output", problem);
    options->output = file;
  };
  command
      ->add_option_function<std::string>("-o,--output", set_output,
                                         "File to write: .ply, .glb or .obj")
      ->required();
  add_max_memory_option(*command, options->max_memory,
                        "the mesh, or the octree if it has to be labelled first, may take while it "
                        "is made; beyond, the command fails and writes nothing");
  command->add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(*command, options->threads);
  add_reporting_options(*command, options->reporting);
  command->callback([options, &session] {
    session.run = [options, &session] { return run(*options, session); };
  });
}

}  // namespace morsel::tools
