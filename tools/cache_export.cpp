// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "tools/commands.h"
#include "tools/output_file.h"
#include "topology/cache_file.h"
#include "topology/morse/export.h"
#include "topology/morse/morse_sections.h"

namespace morsel::tools {
namespace {

struct Options {
  std::string file, output;
  bool vtp = false, csv = false, svg = false;
  std::string axis = "z";
  int pixels = 800;
};

int run(const Options& options) {
  if (!(options.vtp || options.csv || options.svg))
    throw UsageError("one of --vtp, --csv and --svg is needed");
  const topology::TopologyCache cache = topology::read_cache(options.file);
  const auto complex =
      topology::get_morse(cache.sections, cache.topology.components.size(), options.file);
  if (!complex)
    throw std::runtime_error(
        fmt::format("{}: holds no critical points: it was made by the engine \"{}\"; build it with "
                    "`morsel cache build --engine both`",
                    options.file, cache.topology.engine));
  OutputFile output(options.output);
  if (options.vtp) topology::write_vtp(*complex, output.stream());
  if (options.csv) topology::write_csv(*complex, output.stream());
  if (options.svg)
    topology::write_svg(*complex, output.stream(), options.axis[0] - 'x', options.pixels);
  output.commit();
  return kDone;
}

}  // namespace

void add_cache_export(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand(
      "export", "Write a cache's critical points and separatrices for other programs");
  command->add_option("FILE", options->file, "Topology cache (.topo)")->required();
  command->add_option("-o,--output", options->output, "File to write")->required();
  CLI::Option* vtp = command->add_flag(
      "--vtp", options->vtp, "VTK PolyData: points, separatrices, types, F and component ids");
  CLI::Option* csv =
      command->add_flag("--csv", options->csv, "A table of the critical points")->excludes(vtp);
  command->add_flag("--svg", options->svg, "A drawing of the separatrices, maxima as dots")
      ->excludes(vtp)
      ->excludes(csv);
  command->add_option("--axis", options->axis, "--svg: look along this axis")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->capture_default_str();
  command->add_option("--pixels", options->pixels, "--svg: longer side of the drawing")
      ->check(CLI::Range(16, 100000))
      ->capture_default_str();
  command->callback([options, &session] { session.run = [options] { return run(*options); }; });
}

}  // namespace morsel::tools
