// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tools/commands.h"
#include "tools/network_mesh.h"
#include "tools/number_range.h"
#include "tools/output_file.h"
#include "topology/cache_file.h"
#include "topology/morse/export.h"
#include "topology/morse/morse_sections.h"

namespace morsel::tools {
namespace {

struct Options {
  std::string file, output;
  bool vtp = false, csv = false, svg = false, ply = false;
  std::string axis = "z";
  int pixels = 800;
  std::vector<std::string> parts{"maxima", "saddles", "separatrices"};
  double radius = 0.0;  // 0: a five-hundredth of the box's side
};

void write_ply(const Options& options, const topology::MorseComplex& complex, std::ostream& out) {
  const auto has = [&](const char* part) {
    return std::find(options.parts.begin(), options.parts.end(), part) != options.parts.end();
  };
  const NetworkParts parts{has("maxima"), has("saddles"), has("separatrices")};
  const Imath::V3d side = complex.box.size();
  write_network_ply(out, complex, parts,
                    options.radius > 0.0 ? options.radius : side[complex.box.majorAxis()] / 500.0);
}

int run(const Options& options) {
  if (!(options.vtp || options.csv || options.svg || options.ply))
    throw UsageError("one of --vtp, --csv, --svg and --ply is needed");
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
  if (options.ply) write_ply(options, *complex, output.stream());
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
  CLI::Option* svg =
      command->add_flag("--svg", options->svg, "A drawing of the separatrices, maxima as dots")
          ->excludes(vtp)
          ->excludes(csv);
  command
      ->add_flag("--ply", options->ply,
                 "Triangles that `render` can draw: balls at maxima and saddles, tubes along "
                 "separatrices")
      ->excludes(vtp)
      ->excludes(csv)
      ->excludes(svg);
  command
      ->add_option("--parts", options->parts,
                   "--ply: what to draw, separated by commas: maxima, saddles, separatrices")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"maxima", "saddles", "separatrices"}))
      ->capture_default_str();
  command
      ->add_option("--radius", options->radius,
                   "--ply: radius of the tubes in object space, the balls' is twice that (default: "
                   "a five-hundredth of the box)")
      ->check(number_above_zero());
  command->add_option("--axis", options->axis, "--svg: look along this axis")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->capture_default_str();
  command->add_option("--pixels", options->pixels, "--svg: longer side of the drawing")
      ->check(CLI::Range(16, 100000))
      ->capture_default_str();
  command->callback([options, &session] { session.run = [options] { return run(*options); }; });
}

}  // namespace morsel::tools
