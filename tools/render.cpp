// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/render.h"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "renderer/image/denoise.h"
#include "renderer/image/exr.h"
#include "renderer/image/png.h"
#include "renderer/scene/load_scene.h"
#include "renderer/scene/readers.h"
#include "renderer/scene/scene_json.h"
#include "tools/commands.h"
#include "tools/image_check.h"
#include "tools/output_file.h"
#include "tools/render_statistics.h"
#include "tools/reporter.h"
#include "tools/scene_check.h"
#include "tools/scene_options.h"

namespace morsel::tools {
namespace {

namespace fs = std::filesystem;

struct Options {
  SceneOptions scene;
  ReportingOptions reporting;
  std::string output, png;
  bool no_png = false;
  std::optional<std::int64_t> spp, seed;
  int threads = 0;
  std::string resolution, crop, keep, solver, membership, cache, stats;
  bool denoise = false;
  bool check = false;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Exactly `count` integers separated by `separator`.
std::vector<int> parse_integers(const std::string& flag, const std::string& text, char separator,
                                std::size_t count, const char* form) {
  std::vector<int> values;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (values.size() < count) {
    int value = 0;
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error != std::errc()) break;
    values.push_back(value);
    at = rest;
    if (values.size() < count && (at == end || *at++ != separator)) break;
  }
  if (values.size() != count || at != end)
    throw UsageError(fmt::format("{} {}: must be {}", flag, text, form));
  return values;
}

// --set first, then the flags that stand for values of the scene.
std::vector<render::Override> all_overrides(const Options& options) {
  std::vector<render::Override> all = options.scene.overrides();
  if (options.denoise) all.push_back({"render.denoise", true, "--denoise"});
  if (options.spp)
    all.push_back({"render.spp", *options.spp, fmt::format("--spp {}", *options.spp)});
  if (options.seed)
    all.push_back({"render.seed", *options.seed, fmt::format("--seed {}", *options.seed)});
  if (!options.resolution.empty())
    all.push_back(
        {"render.resolution",
         parse_integers("--resolution", options.resolution, 'x', 2, "WIDTHxHEIGHT, as in 1280x720"),
         "--resolution " + options.resolution});
  std::vector<render::Override> plain = all;
  const auto add = [&](const char* key, const nlohmann::json& value, const std::string& source) {
    const auto more = for_each_hypertexture(options.scene.scene, plain, key, value, source);
    if (more.empty()) throw UsageError(source + ": the scene has no hypertexture geometry");
    if (more.size() > 1 && std::string(key) == "cache")
      throw UsageError(
          fmt::format("{}: the scene has {} hypertexture geometries; use --set "
                      "geometries.NAME.cache=FILE",
                      source, more.size()));
    all.insert(all.end(), more.begin(), more.end());
  };
  if (!options.keep.empty()) add("keep", options.keep, "--keep " + options.keep);
  if (!options.solver.empty()) add("solver", options.solver, "--solver " + options.solver);
  if (!options.membership.empty())
    add("membership", options.membership, "--membership " + options.membership);
  if (!options.cache.empty())
    add("cache", fs::absolute(options.cache).string(), "--cache " + options.cache);
  return all;
}

// Known before the scene is loaded, because that can take minutes.
std::optional<render::Crop> checked_crop(const Options& options,
                                         const std::vector<render::Override>& overrides) {
  if (options.crop.empty()) return std::nullopt;
  const std::vector<int> v =
      parse_integers("--crop", options.crop, ',', 4, "x0,y0,x1,y1 in pixels");
  const render::SceneDocument document(options.scene.scene, overrides);
  const auto section = document.root().find("render");
  const render::RenderSettings settings = document.explain([&] {
    return render::read_settings(
        section == document.root().end() ? nlohmann::json::object() : *section,
        document.place() / "render");
  });
  if (!(0 <= v[0] && v[0] < v[2] && v[2] <= settings.width && 0 <= v[1] && v[1] < v[3] &&
        v[3] <= settings.height))
    throw UsageError(fmt::format(
        "--crop {}: must be 0 <= x0 < x1 <= {} and 0 <= y0 < y1 <= {}, the picture's size",
        options.crop, settings.width, settings.height));
  return render::Crop{v[0], v[1], v[2], v[3]};
}

// "text", "json" or "json:FILE".
struct StatisticsTarget {
  bool text = false, json = false;
  std::string file;
};

StatisticsTarget parse_statistics(const std::string& text) {
  StatisticsTarget target;
  if (text == "text")
    target.text = true;
  else if (text == "json")
    target.json = true;
  else if (text.rfind("json:", 0) == 0 && text.size() > 5)
    target.file = text.substr(5);
  else if (!text.empty())
    throw UsageError(fmt::format("--stats {}: must be text, json or json:FILE", text));
  return target;
}

fs::path exr_path(const Options& options) {
  if (options.output.empty()) return fs::path(options.scene.scene).stem().string() + ".exr";
  if (fs::path(options.output).extension() != ".exr")
    throw UsageError(
        fmt::format("-o {}: must end in .exr; --png names the preview", options.output));
  return options.output;
}

fs::path png_path(const Options& options, const fs::path& exr) {
  if (options.no_png) return {};
  if (options.png.empty()) return fs::path(exr).replace_extension(".png");
  if (fs::path(options.png).extension() != ".png")
    throw UsageError(fmt::format("--png {}: must end in .png", options.png));
  return options.png;
}

void write_statistics(const StatisticsTarget& target, const nlohmann::json& statistics) {
  if (target.json) std::cout << statistics.dump(2) << '\n';
  if (target.text) std::cout << statistics_text(statistics);
  if (target.file.empty()) return;
  OutputFile file(target.file);
  file.stream() << statistics.dump(2) << '\n';
  file.commit();
}

int run(const Options& options, const Session& session) {
  Reporter reporter(options.reporting);
  const std::vector<render::Override> overrides = all_overrides(options);
  if (options.check) return print_problems(options.scene.scene, overrides, reporter, false);

  const std::optional<render::Crop> crop = checked_crop(options, overrides);
  const StatisticsTarget target = parse_statistics(options.stats);
  const fs::path exr = exr_path(options), png = png_path(options, exr);
  topology::require_replaceable(exr);
  if (!png.empty()) topology::require_replaceable(png);
  if (!target.file.empty()) topology::require_replaceable(target.file);

  const auto threads = limit_threads(options.threads);
  RenderReport report{options.scene.scene, exr.string(), png.string()};
  auto start = std::chrono::steady_clock::now();
  render::LoadOptions load;
  load.execution.cancel = session.cancel;
  load.execution.progress = [&](double fraction, const char* phase) {
    reporter.progress(fraction, fmt::format("topology: {}", phase));
  };
  load.warn = [&](const std::string& message) { reporter.warn(message); };
  load.check_image = check_image;
  render::LoadedScene loaded = render::load_scene(options.scene.scene, overrides, load);
  loaded.scene.settings.crop = crop;
  report.load_seconds = seconds_since(start);
  for (const render::HypertextureReport& h : loaded.hypertextures)
    reporter.debug(fmt::format("{}: cache {} {}", h.geometry, h.built ? "built" : "read from",
                               h.cache_file.string()));
  if (session.cancel->load()) throw topology::Cancelled();

  start = std::chrono::steady_clock::now();
  render::RenderOptions render_options;
  render_options.threads = options.threads;
  render_options.cancel = session.cancel;
  render_options.progress = [&](double fraction) { reporter.progress(fraction, "rendering"); };
  render::RenderResult result = render::render(loaded.scene, render_options);
  if (result.cancelled) throw topology::Cancelled();
  report.render_seconds = seconds_since(start);
  if (result.statistics.non_finite_samples > 0)
    reporter.warn(fmt::format("{} of {} samples were not finite and count as black",
                              result.statistics.non_finite_samples, result.statistics.samples));
  if (const std::uint64_t limits = step_limits(loaded.scene); limits > 0)
    reporter.warn(fmt::format(
        "{} ray tests ended at the limit of field evaluations: hits may be missing", limits));

  if (loaded.scene.settings.denoise) {
    if (render::denoiser_version().empty())
      reporter.warn("this build has no Open Image Denoise: no denoised layer is written");
    else
      result.denoised = render::denoise(result.film);
  }
  start = std::chrono::steady_clock::now();
  render::write_exr(exr, loaded.scene, result);
  if (!png.empty())
    render::write_png(png, result.film, loaded.scene.settings.exposure, result.denoised);
  report.write_seconds = seconds_since(start);

  if (!target.json) {
    std::cout << exr.string() << '\n';
    if (!png.empty()) std::cout << png.string() << '\n';
  }
  if (!options.stats.empty()) write_statistics(target, statistics_json(report, loaded, result));
  return kDone;
}

}  // namespace

void add_render(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand("render", "Render a scene");
  add_scene_options(*command, options->scene);
  command->add_option("-o,--output", options->output,
                      "EXR file to write [the scene's name with .exr, here]");
  auto* png = command->add_option("--png", options->png,
                                  "PNG preview to write [beside the EXR, with .png]");
  command->add_flag("--no-png", options->no_png, "Write no PNG preview")->excludes(png);
  command->add_option("--spp", options->spp, "Samples a pixel, instead of the scene's");
  command->add_option("--seed", options->seed, "Seed of the samples, instead of the scene's");
  command->add_option("--resolution", options->resolution, "WIDTHxHEIGHT, instead of the scene's");
  command->add_option("--crop", options->crop,
                      "Render only the pixels x0,y0,x1,y1 (x1, y1 excluded; y down)");
  command->add_option("--keep", options->keep,
                      "Pieces of the hypertextures to keep: main, largest:K, volume:V, "
                      "touching:X,Y,Z, all, detached, ids:I,J,...");
  command->add_option(
      "--solver", options->solver,
      "How rays find hypertextures: model (fastest), segment, sphere (the paper's)");
  command->add_option("--membership", options->membership,
                      "How detached pieces are told: labels, streamline (the paper's), off");
  command->add_option("--cache", options->cache,
                      "Topology cache of the scene's only hypertexture; built if missing");
  command->add_flag("--denoise", options->denoise,
                    "Write a denoised layer too, and the preview of it (if this build can)");
  command->add_option("--stats", options->stats, "What it took: text, json or json:FILE");
  command->add_flag("--check", options->check, "Only check the scene, as `scene check` does");
  add_threads_option(*command, options->threads);
  add_reporting_options(*command, options->reporting);
  command->callback([options, &session] {
    session.run = [options, &session] { return run(*options, session); };
  });
}

}  // namespace morsel::tools
