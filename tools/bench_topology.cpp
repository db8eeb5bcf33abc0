// SPDX-License-Identifier: Apache-2.0
#include "tools/bench_topology.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <iostream>
#include <memory>
#include <vector>

#include "hypertexture_geom/field/compiled_field.h"
#include "renderer/scene/scene_json.h"
#include "tools/commands.h"
#include "tools/reporter.h"
#include "tools/scene_options.h"
#include "topology/octree_codec.h"

namespace morsel::tools {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Voxels along a side of a block, which shares one compiled field.
constexpr int kBlock = 16;

// F at the centres of all voxels of one block; how many are not negative.
std::uint64_t evaluate_block(const topology::ScalarField& field, const Imath::V3d& corner,
                             const Imath::V3d& step) {
  const geom::CompiledField<float> compiled(field,
                                            topology::Box(corner, corner + step * double{kBlock}));
  float x[kBlock], y[kBlock], z[kBlock], value[kBlock];
  const Imath::V3d first = corner + step * 0.5 - compiled.centre();
  for (int i = 0; i < kBlock; ++i) x[i] = static_cast<float>(first.x + i * step.x);
  const float* const points[3] = {x, y, z};
  std::uint64_t positive = 0;
  for (int k = 0; k < kBlock; ++k) {
    std::fill(z, z + kBlock, static_cast<float>(first.z + k * step.z));
    for (int j = 0; j < kBlock; ++j) {
      std::fill(y, y + kBlock, static_cast<float>(first.y + j * step.y));
      compiled.values(points, kBlock, value);
      for (const float v : value) positive += v >= 0.0f;
    }
  }
  return positive;
}

struct Options {
  SceneOptions scene;
  ReportingOptions reporting;
  std::string geometry;
  int resolution = 512;
  int threads = 0;
  bool json = false;
};

int run(const Options& options, const Session& session) {
  const auto threads = limit_threads(options.threads);
  Reporter reporter(options.reporting);
  const render::SceneDocument document(options.scene.scene, options.scene.overrides());
  topology::Execution execution;
  execution.cancel = session.cancel;
  const geom::Hypertexture hypertexture = render::read_hypertexture(
      document, render::find_hypertexture(document, options.geometry), execution);
  execution.progress = [&](double fraction, const char* phase) {
    reporter.progress(fraction, fmt::format("{}: {}", hypertexture.name, phase));
  };
  const TopologyBench bench = bench_topology(hypertexture, options.resolution, execution);
  const topology::Topology& t = bench.topology;
  if (options.json) {
    const nlohmann::json result = {{"geometry", hypertexture.name},
                                   {"label_seconds", bench.label_seconds},
                                   {"evaluate_seconds", bench.evaluate_seconds},
                                   {"resolution", bench.resolution},
                                   {"positive_voxels", bench.positive},
                                   {"labels_vs_evaluation", bench.ratio()},
                                   {"components", t.components.size()},
                                   {"certified", t.certified},
                                   {"octree",
                                    {{"leaves", t.leaves},
                                     {"nodes", t.nodes.size()},
                                     {"depth", t.depth},
                                     {"models", t.models},
                                     {"packed_bytes", bench.packed_bytes}}}};
    std::cout << result.dump(2) << '\n';
  } else {
    std::cout << fmt::format(
        "{}: labels {:.2f} s ({} components, {}, {} leaves, {} models, {} bytes packed); F at {}^3 "
        "voxels {:.2f} s; ratio {:.2f}\n",
        hypertexture.name, bench.label_seconds, t.components.size(),
        t.certified ? "certified" : "NOT certified", t.leaves, t.models, bench.packed_bytes,
        bench.resolution, bench.evaluate_seconds, bench.ratio());
  }
  return kDone;
}

}  // namespace

TopologyBench bench_topology(const geom::Hypertexture& hypertexture, int resolution,
                             const topology::Execution& execution) {
  TopologyBench bench;
  const auto start = Clock::now();
  bench.topology = topology::certify(*hypertexture.field, hypertexture.certify, execution);
  bench.label_seconds = seconds_since(start);
  bench.packed_bytes = topology::pack_octree(bench.topology.nodes).size();

  const int blocks = (resolution + kBlock - 1) / kBlock;
  bench.resolution = blocks * kBlock;
  const topology::Box& box = bench.topology.box;
  const Imath::V3d step = (box.max - box.min) / bench.resolution;
  std::atomic<std::uint64_t> positive{0};
  const auto begin = Clock::now();
  tbb::parallel_for(0, blocks * blocks * blocks, [&](int b) {
    execution.check_cancel();
    // NOLINTNEXTLINE(bugprone-integer-division): whole numbers are meant.
    const Imath::V3d place(b % blocks, b / blocks % blocks, b / (blocks * blocks));
    positive += evaluate_block(*hypertexture.field, box.min + step * place * double{kBlock}, step);
  });
  bench.evaluate_seconds = seconds_since(begin);
  bench.positive = positive;
  return bench;
}

void add_bench_topology(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand(
      "topology", "Time of certified labels against one evaluation of the field at each voxel");
  add_scene_options(*command, options->scene);
  command->add_option("--geometry", options->geometry, "This hypertexture geometry");
  command
      ->add_option("--resolution", options->resolution,
                   "Voxels along each axis of the box (rounded up to a multiple of 16)")
      ->capture_default_str()
      ->check(CLI::Range(16, 4096));
  command->add_flag("--json", options->json, "Print one JSON document");
  add_threads_option(*command, options->threads);
  add_reporting_options(*command, options->reporting);
  command->callback([options, &session] {
    session.run = [options, &session] { return run(*options, session); };
  });
}

}  // namespace morsel::tools
