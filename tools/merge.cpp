// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/merge_shards.h"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <set>

#include "renderer/image/png.h"
#include "tools/commands.h"
#include "tools/reporter.h"
#include "topology/replacing_file.h"

namespace morsel::tools {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> shards;
  std::string output, png;
  bool no_png = false;
  ReportingOptions reporting;
};

// By name: that two files hold one shard is found when they are read.
void require_different(const std::vector<std::string>& shards) {
  std::set<fs::path> seen;
  for (const std::string& shard : shards) {
    std::error_code error;
    const fs::path file = fs::weakly_canonical(shard, error);
    if (!error && !seen.insert(file).second)
      throw std::runtime_error(fmt::format("{}: is given twice", shard));
  }
}

int run(const Options& options) {
  Reporter reporter(options.reporting);
  const fs::path exr = options.output;
  if (exr.extension() != ".exr")
    throw UsageError(fmt::format("-o {}: must end in .exr; --png names the preview", exr.string()));
  fs::path png;
  if (!options.no_png)
    png = options.png.empty() ? fs::path(exr).replace_extension("png") : fs::path(options.png);
  if (!png.empty() && png.extension() != ".png")
    throw UsageError(fmt::format("--png {}: must end in .png", png.string()));
  require_different(options.shards);
  topology::require_replaceable(exr);
  if (!png.empty()) topology::require_replaceable(png);

  const render::MergedShards merged =
      render::merge_shards({options.shards.begin(), options.shards.end()}, exr);
  for (const std::uint32_t i : merged.missing)
    reporter.warn(
        fmt::format("shard {}/{} is missing: the picture has fewer samples", i, merged.shards));
  for (const fs::path& file : merged.unfinished)
    reporter.warn(fmt::format("{}: was interrupted: the picture has fewer samples", file.string()));
  std::cout << exr.string() << '\n';
  if (!png.empty()) {
    render::write_png(png, merged.film, merged.exposure, merged.denoised);
    std::cout << png.string() << '\n';
  }
  return kDone;
}

}  // namespace

void add_merge(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand("merge", "Join the shards of a render");
  command->add_option("SHARD", options->shards, "EXR files that `render --shard` wrote")
      ->required();
  command->add_option("-o,--output", options->output, "EXR file to write")->required();
  auto* png = command->add_option("--png", options->png,
                                  "PNG preview to write [beside the EXR, with .png]");
  command->add_flag("--no-png", options->no_png, "Write no PNG preview")->excludes(png);
  add_reporting_options(*command, options->reporting);
  command->callback([options, &session] { session.run = [options] { return run(*options); }; });
}

}  // namespace morsel::tools
