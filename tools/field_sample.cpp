// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <vector>

#include "renderer/scene/scene_json.h"
#include "tools/commands.h"
#include "tools/grid_file.h"
#include "tools/output_file.h"
#include "tools/reporter.h"
#include "tools/scene_options.h"
#include "topology/certified.h"

namespace morsel::tools {
namespace {

constexpr std::size_t kBlock = 16;  // samples along an edge of a block that shares one restriction

struct Options {
  SceneOptions scene;
  ReportingOptions reporting;
  std::string geometry;
  std::string output;
  std::size_t resolution = 0;
  int threads = 0;
  bool json = false;
};

// The points of the grid; both ends are exact.
class Grid {
 public:
  Grid(const topology::Box& box, std::size_t n) : box_(box), n_(n) {}
  std::size_t n() const { return n_; }
  Imath::V3d point(std::size_t i, std::size_t j, std::size_t k) const {
    return {coordinate(0, i), coordinate(1, j), coordinate(2, k)};
  }

 private:
  double coordinate(int axis, std::size_t i) const {
    if (i + 1 == n_) return box_.max[axis];
    return box_.min[axis] +
           (box_.max[axis] - box_.min[axis]) * static_cast<double>(i) / static_cast<double>(n_ - 1);
  }
  topology::Box box_;
  std::size_t n_;
};

// Evaluates layers [k0, k1) into `values`, x fastest. Each block of samples is evaluated with the
// field restricted to it, which drops the noise impulses that do not reach the block.
void sample_layers(const topology::ScalarField& field, const Grid& grid, std::size_t k0,
                   std::size_t k1, std::vector<double>& values, const Session& session) {
  const std::size_t n = grid.n(), blocks = (n + kBlock - 1) / kBlock;
  oneapi::tbb::parallel_for(std::size_t{0}, blocks * blocks, [&](std::size_t block) {
    if (session.cancel->load(std::memory_order_relaxed)) return;
    const std::size_t i0 = block % blocks * kBlock, i1 = std::min(n, i0 + kBlock);
    const std::size_t j0 = block / blocks * kBlock, j1 = std::min(n, j0 + kBlock);
    const auto local = field.restricted_to(
        topology::Box(grid.point(i0, j0, k0), grid.point(i1 - 1, j1 - 1, k1 - 1)));
    for (std::size_t k = k0; k < k1; ++k)
      for (std::size_t j = j0; j < j1; ++j)
        for (std::size_t i = i0; i < i1; ++i)
          values[((k - k0) * n + j) * n + i] = local->value(grid.point(i, j, k));
  });
  if (session.cancel->load()) throw topology::Cancelled();
}

int run(const Options& options, const Session& session) {
  const std::string extension = std::filesystem::path(options.output).extension().string();
  if (extension != ".npy" && extension != ".vti")
    throw UsageError(fmt::format("-o {}: must end in .npy or .vti", options.output));
  const render::SceneDocument document(options.scene.scene, options.scene.overrides());
  const geom::Hypertexture hypertexture =
      render::read_hypertexture(document, render::find_hypertexture(document, options.geometry));
  const auto threads = limit_threads(options.threads);
  Reporter reporter(options.reporting);

  const topology::Box& box = hypertexture.certify.box;
  const std::size_t n = options.resolution;
  const Grid grid(box, n);
  OutputFile file(options.output);
  if (extension == ".npy")
    write_npy_header(file.stream(), n);
  else
    write_vti_header(file.stream(), n, box);
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  std::vector<double> values(n * n * std::min(n, kBlock));
  for (std::size_t k0 = 0; k0 < n; k0 += kBlock) {
    const std::size_t k1 = std::min(n, k0 + kBlock), count = n * n * (k1 - k0);
    sample_layers(*hypertexture.field, grid, k0, k1, values, session);
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(count);
    const auto [low, high] = std::minmax_element(values.begin(), end);
    lowest = std::min(lowest, *low);
    highest = std::max(highest, *high);
    file.stream().write(reinterpret_cast<const char*>(values.data()),
                        static_cast<std::streamsize>(count * sizeof(double)));
    reporter.progress(static_cast<double>(k1) / static_cast<double>(n), "sampling");
  }
  if (extension == ".vti") write_vti_footer(file.stream());
  file.commit();

  if (options.json) {
    const nlohmann::json result = {
        {"file", options.output},
        {"geometry", hypertexture.name},
        {"resolution", n},
        {"box",
         {{"min", {box.min.x, box.min.y, box.min.z}}, {"max", {box.max.x, box.max.y, box.max.z}}}},
        {"value", {{"min", lowest}, {"max", highest}}}};
    std::cout << result.dump(2) << '\n';
  } else {
    std::cout << fmt::format(
        "{}: {}^3 samples of {} from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}), "
        "values {:.6g} to {:.6g}\n",
        options.output, n, hypertexture.name, box.min.x, box.min.y, box.min.z, box.max.x, box.max.y,
        box.max.z, lowest, highest);
  }
  return kDone;
}

}  // namespace

void add_field_sample(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand(
      "sample",
      "Sample the field on a grid over its box, corners included; .npy arrays are "
      "indexed [z][y][x]");
  add_scene_options(*command, options->scene);
  command->add_option("--geometry", options->geometry,
                      "Hypertexture geometry; may be left out if there is only one");
  command->add_option("--resolution", options->resolution, "Samples along each axis")
      ->required()
      ->check(CLI::Range(2, 8192));
  command->add_option("-o,--output", options->output, "File to write: .npy or .vti")->required();
  command->add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(*command, options->threads);
  add_reporting_options(*command, options->reporting);
  command->callback([options, &session] {
    session.run = [options, &session] { return run(*options, session); };
  });
}

}  // namespace morsel::tools
