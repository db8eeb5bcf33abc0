// SPDX-License-Identifier: Apache-2.0
#include "tools/render_options.h"

#include <fmt/format.h>

#include <map>

#include "renderer/image/denoise.h"
#include "renderer/scene/readers.h"
#include "renderer/scene/scene_json.h"
#include "tools/number_range.h"
#include "tools/parse_values.h"
#include "tools/scene_options.h"
#include "tools/session.h"
#include "topology/replacing_file.h"

namespace morsel::tools {
namespace {

namespace fs = std::filesystem;

render::RenderSettings settings_of(const std::string& scene,
                                   const std::vector<render::Override>& overrides) {
  const render::SceneDocument document(scene, overrides);
  const auto section = document.root().find("render");
  return document.explain([&] {
    return render::read_settings(
        section == document.root().end() ? nlohmann::json::object() : *section,
        document.place() / "render");
  });
}

std::optional<render::Crop> checked_crop(const std::string& text,
                                         const render::RenderSettings& settings) {
  if (text.empty()) return std::nullopt;
  const std::vector<int> v = parse_integers("--crop", text, ',', 4, "x0,y0,x1,y1 in pixels");
  if (!(0 <= v[0] && v[0] < v[2] && v[2] <= settings.width && 0 <= v[1] && v[1] < v[3] &&
        v[3] <= settings.height))
    throw UsageError(fmt::format(
        "--crop {}: must be 0 <= x0 < x1 <= {} and 0 <= y0 < y1 <= {}, the picture's size", text,
        settings.width, settings.height));
  return render::Crop{v[0], v[1], v[2], v[3]};
}

render::Shard checked_shard(const std::string& text, const render::RenderSettings& settings) {
  if (text.empty()) return {};
  const render::Shard shard = parse_shard("--shard", text);
  if (shard.count > static_cast<std::uint32_t>(settings.spp))
    throw UsageError(fmt::format("--shard {}: {} samples a pixel cannot be split into more shards",
                                 text, settings.spp));
  return shard;
}

CheckpointInterval parse_interval(const std::string& text) {
  if (!text.empty() && text.back() == '%')
    return {0.0, parse_percentage("--checkpoint-interval", text)};
  return {parse_duration("--checkpoint-interval", text), 0.0};
}

bool is_folder(const std::string& name) {
  std::error_code error;
  return !name.empty() && (name.back() == '/' || fs::is_directory(name, error));
}

// Folders are not made: a name that is misspelt would become one.
void require_folder(const char* flag, const std::string& name) {
  std::error_code error;
  if (!name.empty() && name.back() == '/' && !fs::is_directory(name, error))
    throw std::runtime_error(
        fmt::format("{} {}: no such folder; make it first, by mkdir -p {}", flag, name, name));
}

// `name` is a file, or a folder for the file `in_folder`.
fs::path named_or_in(const std::string& name, const std::string& in_folder) {
  return is_folder(name) ? fs::path(name) / in_folder : fs::path(name);
}

fs::path exr_path(const RenderFlags& flags, const std::string& scene, const render::Shard& shard) {
  std::string own = fs::path(scene).stem().string();
  if (shard.count > 1) own += fmt::format("_{}", shard.index);
  own += ".exr";
  if (flags.output.empty()) return own;
  fs::path path = named_or_in(flags.output, own);
  if (path.extension() != ".exr")
    throw UsageError(fmt::format(
        "-o {}: must end in .exr, or in / for a folder; --png names the preview", flags.output));
  return path;
}

fs::path png_path(const RenderFlags& flags, const fs::path& exr, const render::Shard& shard) {
  if (flags.no_png) return {};
  if (flags.png.empty())
    return shard.count > 1 ? fs::path() : fs::path(exr).replace_extension("png");
  if (fs::path(flags.png).extension() != ".png")
    throw UsageError(fmt::format("--png {}: must end in .png", flags.png));
  return flags.png;
}

fs::path checkpoint_path(const RenderFlags& flags, const fs::path& exr) {
  if (flags.checkpoint.empty()) return {};
  fs::path path = named_or_in(flags.checkpoint, exr.stem().string() + ".checkpoint");
  if (path.extension() == ".exr" || path.extension() == ".json")
    throw UsageError(
        fmt::format("--checkpoint {}: names a picture or a scene; checkpoints are "
                    "files of their own, as in rock.checkpoint",
                    flags.checkpoint));
  return path;
}

// Two scenes of one name from two folders would write one picture.
void require_distinct(const std::vector<RenderPlan>& plans) {
  std::map<fs::path, std::string> writers;
  for (const RenderPlan& plan : plans)
    for (const fs::path& file : {plan.exr, plan.png, plan.checkpoint}) {
      if (file.empty()) continue;
      const auto [other, added] = writers.emplace(fs::weakly_canonical(file), plan.scene);
      if (!added)
        throw UsageError(
            fmt::format("{} and {} would both write {}", other->second, plan.scene, file.string()));
    }
}

void refuse_for_several(const RenderFlags& flags) {
  const auto count = flags.scenes.size();
  if (count < 2) return;
  const auto refuse = [&](const char* flag, const std::string& value, const char* instead) {
    throw UsageError(fmt::format("{} {}: names one file, and there are {} scenes; {}", flag, value,
                                 count, instead));
  };
  if (!flags.output.empty() && !is_folder(flags.output))
    refuse("-o", flags.output, "give a folder that ends in /");
  if (!flags.checkpoint.empty() && !is_folder(flags.checkpoint))
    refuse("--checkpoint", flags.checkpoint, "give a folder that ends in /");
  if (!flags.png.empty()) refuse("--png", flags.png, "leave it out: it stands beside the EXR");
  if (!flags.cache.empty()) refuse("--cache", flags.cache, "render one scene a call");
  if (!flags.debug_pixel.empty())
    throw UsageError("--debug-pixel: looks at one scene, not at several");
}

}  // namespace

std::vector<render::Override> render_overrides(const RenderFlags& flags, const std::string& scene) {
  std::vector<render::Override> all;
  for (const std::string& text : flags.set) all.push_back(render::parse_override(text));
  if (flags.denoise) all.push_back({"render.denoise", true, "--denoise"});
  if (flags.spp) all.push_back({"render.spp", *flags.spp, fmt::format("--spp {}", *flags.spp)});
  if (flags.seed)
    all.push_back({"render.seed", *flags.seed, fmt::format("--seed {}", *flags.seed)});
  if (!flags.resolution.empty())
    all.push_back(
        {"render.resolution",
         parse_integers("--resolution", flags.resolution, 'x', 2, "WIDTHxHEIGHT, as in 1280x720"),
         "--resolution " + flags.resolution});
  const std::vector<render::Override> plain = all;
  const auto add = [&](const char* key, const nlohmann::json& value, const std::string& source) {
    const auto more = for_each_hypertexture(scene, plain, key, value, source);
    if (more.empty()) throw UsageError(source + ": the scene has no hypertexture geometry");
    if (more.size() > 1 && std::string(key) == "cache")
      throw UsageError(
          fmt::format("{}: the scene has {} hypertexture geometries; use --set "
                      "geometries.NAME.cache=FILE",
                      source, more.size()));
    all.insert(all.end(), more.begin(), more.end());
  };
  if (!flags.keep.empty()) add("keep", flags.keep, "--keep " + flags.keep);
  if (!flags.solver.empty()) add("solver", flags.solver, "--solver " + flags.solver);
  if (!flags.membership.empty())
    add("membership", flags.membership, "--membership " + flags.membership);
  if (!flags.cache.empty())
    add("cache", fs::absolute(flags.cache).string(), "--cache " + flags.cache);
  return all;
}

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

std::vector<RenderPlan> plan_renders(const RenderFlags& flags) {
  refuse_for_several(flags);
  if (flags.resume && flags.checkpoint.empty())
    throw UsageError("--resume: needs --checkpoint FILE, which says from what");
  const CheckpointInterval interval = parse_interval(flags.checkpoint_interval);
  std::optional<double> time_limit;
  if (!flags.time_limit.empty()) time_limit = parse_duration("--time-limit", flags.time_limit);
  fs::path preview;
  std::optional<TevAddress> tev;
  if (fs::path(flags.preview).extension() == ".png")
    preview = flags.preview;
  else if (!flags.preview.empty())
    tev = parse_tev_address("--preview", flags.preview);

  std::vector<RenderPlan> plans;
  for (const std::string& scene : flags.scenes) {
    RenderPlan plan;
    plan.scene = scene;
    plan.overrides = render_overrides(flags, scene);
    // Known before the scene is loaded, because that can take minutes.
    const render::RenderSettings settings = settings_of(scene, plan.overrides);
    plan.crop = checked_crop(flags.crop, settings);
    plan.shard = checked_shard(flags.shard, settings);
    plan.exr = exr_path(flags, scene, plan.shard);
    plan.png = png_path(flags, plan.exr, plan.shard);
    plan.checkpoint = checkpoint_path(flags, plan.exr);
    plan.preview = preview;
    plan.tev = tev;
    plan.interval = interval;
    plan.resume = flags.resume;
    plan.time_limit = time_limit;
    plan.stop_at_nan = flags.stop_at_nan;
    plan.threads = flags.threads;
    plan.max_brick_file = bytes_of(flags.max_brick_file);
    plans.push_back(std::move(plan));
  }
  // Once all scenes are known to be right: what is wrong with the call comes before the disk.
  require_folder("-o", flags.output);
  require_folder("--checkpoint", flags.checkpoint);
  for (const RenderPlan& plan : plans)
    for (const fs::path& file : {plan.exr, plan.png, plan.checkpoint, plan.preview})
      if (!file.empty()) topology::require_replaceable(file);
  require_distinct(plans);
  return plans;
}

void add_render_flags(CLI::App& command, RenderFlags& flags) {
  command.add_option("SCENE", flags.scenes, "Scene file (JSON); several are rendered in turn")
      ->required();
  add_set_option(command, flags.set);
  command.add_option("-o,--output", flags.output,
                     "EXR file to write, or a folder that ends in / [the scene's name with .exr, "
                     "here]");
  auto* png =
      command.add_option("--png", flags.png, "PNG preview to write [beside the EXR, with .png]");
  command.add_flag("--no-png", flags.no_png, "Write no PNG preview")->excludes(png);
  command.add_option("--spp", flags.spp, "Samples a pixel, instead of the scene's");
  command.add_option("--time-limit", flags.time_limit,
                     "Stop sampling after this time, after the first pass at the earliest: 90s, "
                     "15m, 1.5h");
  command.add_option("--seed", flags.seed, "Seed of the samples, instead of the scene's");
  command.add_option("--resolution", flags.resolution,
                     "Size of the picture as WIDTHxHEIGHT, instead of the scene's");
  command.add_option("--crop", flags.crop,
                     "Render only the pixels x0,y0,x1,y1 (x1, y1 excluded; y down)");
  command.add_option("--checkpoint", flags.checkpoint,
                     "File, or folder that ends in /, that keeps what was rendered so far");
  command
      .add_option("--checkpoint-interval", flags.checkpoint_interval,
                  "How often: a time such as 10m, or the share of the time that writing may take")
      ->capture_default_str();
  command.add_flag("--resume", flags.resume,
                   "Go on from the checkpoint; without one, begin and say so");
  command.add_option("--shard", flags.shard,
                     "Take part INDEX of COUNT of each pixel's samples, as in 0/4; "
                     "`morsel merge` joins them");
  command.add_option("--preview", flags.preview,
                     "Where to show the picture while it is rendered: a PNG file that is kept up "
                     "to date, or the viewer tev (tev, tev:HOST, tev:HOST:PORT)");
  command
      .add_option("--keep", flags.keep,
                  "Pieces of the hypertextures to keep: main, largest:K, volume:V, "
                  "touching:X,Y,Z, all, detached, ids:I,J,...")
      ->type_name("TEXT:{main,largest:,volume:,touching:,all,detached,ids:}");
  command
      .add_option("--solver", flags.solver,
                  "How rays find hypertextures: model (fastest), segment, sphere (the paper's)")
      ->type_name("TEXT:{model,segment,sphere}");
  command
      .add_option("--membership", flags.membership,
                  "How detached pieces are told: labels, streamline (the paper's), off")
      ->type_name("TEXT:{labels,streamline,off}");
  command.add_option("--cache", flags.cache,
                     "Topology cache of the scene's only hypertexture; built if missing");
  command
      .add_option("--max-brick-file", flags.max_brick_file,
                  "GiB that the bricks of a hypertexture may have to be kept beside its topology "
                  "cache for the next render; 0: they are neither read nor kept")
      ->check(number_from(0.0, 1e6))
      ->capture_default_str();
  command.add_flag("--denoise", flags.denoise,
                   "Write a denoised layer too, and the preview of it (if this build can)");
  // Not in the flag's own help, of which the man page is made: that is the same for all builds.
  if (render::denoiser_version().empty())
    command.footer("This build has no Open Image Denoise: --denoise warns and does nothing.");
  command.add_option("--stats", flags.stats, "What it took: text, json or json:FILE");
  command.add_option("--debug-pixel", flags.debug_pixel,
                     "Print every sample of the pixel x,y with its rays, and render nothing");
  command.add_flag("--stop-at-nan", flags.stop_at_nan,
                   "Fail at the first sample that is not finite, and say where; for debugging");
  command.add_flag("--check", flags.check, "Only check the scene, as `scene check` does");
  add_threads_option(command, flags.threads);
  add_reporting_options(command, flags.reporting);
}

}  // namespace morsel::tools
