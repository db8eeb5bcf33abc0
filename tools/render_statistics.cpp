// SPDX-License-Identifier: Apache-2.0
#include "tools/render_statistics.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::tools {
namespace {

using nlohmann::json;

json hypertexture_json(const render::HypertextureReport& report) {
  return {{"geometry", report.geometry},
          {"cache", report.cache_file.string()},
          {"cache_built", report.built},
          {"cache_build_seconds", report.build_seconds},
          {"components", report.components},
          {"kept", report.kept},
          {"certified", report.certified},
          {"bricks", report.bricks},
          {"bricks_read", report.bricks_were_read},
          {"bytes", report.bytes}};
}

json path_json(const std::filesystem::path& path) {
  return path.empty() ? json(nullptr) : json(path.string());
}

const char* end_name(render::RenderEnd end) {
  switch (end) {
    case render::RenderEnd::kDone:
      return "done";
    case render::RenderEnd::kDeadline:
      return "time_limit";
    case render::RenderEnd::kCancelled:
      break;
  }
  return "interrupted";
}

double per_second(std::uint64_t count, double seconds) {
  return seconds > 0 ? static_cast<double>(count) / seconds : 0.0;
}

json places_json(const std::vector<render::NonFinitePlace>& places) {
  json list = json::array();
  for (const render::NonFinitePlace& p : places)
    list.push_back(
        {{"pixel", {p.x, p.y}}, {"half", p.half}, {"sample", p.sample}, {"bounce", p.bounce}});
  return list;
}

json cost_json(const render::RayCost& cost) {
  std::uint64_t rays = 0;
  std::size_t bins = 0;
  for (std::size_t i = 0; i < cost.rays.size(); ++i) {
    rays += cost.rays[i];
    if (cost.rays[i] > 0) bins = i + 1;
  }
  return {
      {"evaluations", cost.evaluations},
      {"per_ray",
       rays > 0 ? static_cast<double>(cost.evaluations) / static_cast<double>(rays) : 0.0},
      {"histogram", std::vector<std::uint64_t>(
                        cost.rays.begin(), cost.rays.begin() + static_cast<std::ptrdiff_t>(bins))},
      {"filter_calls", cost.filtered}};
}

// How much the pixels' means are off, relative to the picture's: its mean squared standard error.
double relative_variance(const render::Film& film) {
  double variance = 0.0, mean = 0.0;
  const render::Crop& w = film.window();
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x) {
      const render::Pixel& p = film.at(x, y);
      variance += (p.variance.x + p.variance.y + p.variance.z) / 3.0;
      mean += (p.color.x + p.color.y + p.color.z) / 3.0;
    }
  const double pixels = static_cast<double>(film.width()) * film.height();
  return mean > 0.0 ? variance * pixels / (mean * mean) : 0.0;
}

json efficiency_json(const RenderReport& report, const render::RenderStatistics& s,
                     const render::Film& film) {
  const double variance = relative_variance(film);
  const double seconds = s.seconds_of("trace") + s.earlier_seconds;
  const double available = report.render_seconds * report.threads;
  return {{"relative_variance", variance},
          {"per_second", variance > 0.0 && seconds > 0.0 ? 1.0 / (variance * seconds) : 0.0},
          {"threads", report.threads},
          {"processor_seconds", report.processor_seconds},
          {"processor_share", available > 0.0 ? report.processor_seconds / available : 0.0}};
}

std::uint64_t peak_memory() {
  rusage usage{};
  return ::getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::uint64_t>(usage.ru_maxrss) * 1024u
                                               : 0;
}

}  // namespace

std::uint64_t step_limits(const render::Scene& scene) {
  std::uint64_t count = 0;
  for (const render::Geometry& g : scene.geometries) {
    const auto* hypertexture =
        std::get_if<std::shared_ptr<const geom::HypertextureGeometry>>(&g.shape);
    if (hypertexture && *hypertexture) count += (*hypertexture)->statistics().limits;
  }
  return count;
}

json statistics_json(const RenderReport& report, const RenderPlan& plan,
                     const render::LoadedScene& loaded, const render::RenderResult& result) {
  const render::RenderStatistics& s = result.statistics;
  const render::RenderSettings& settings = loaded.scene.settings;
  const render::Crop& window = result.film.window();
  json phases = json::object();
  for (const auto& [phase, seconds] : s.seconds) phases[phase] = seconds;
  phases["load"] = report.load_seconds;
  phases["write"] = report.write_seconds;
  phases["total"] = report.load_seconds + report.render_seconds + report.write_seconds;
  phases["earlier_runs"] = s.earlier_seconds;
  const double trace = s.seconds_of("trace");

  json texture_cache = json::object();
  for (const auto& [name, value] : s.texture_numbers) texture_cache[name] = value;
  json hypertextures = json::array();
  for (const render::HypertextureReport& h : loaded.hypertextures)
    hypertextures.push_back(hypertexture_json(h));
  return {{"scene", plan.scene},
          {"exr", plan.exr.string()},
          {"png", path_json(plan.png)},
          {"checkpoint", path_json(plan.checkpoint)},
          {"end", end_name(result.end)},
          {"shard", {plan.shard.index, plan.shard.count}},
          {"resolution", {settings.width, settings.height}},
          {"window", {window.x0, window.y0, window.x1, window.y1}},
          {"spp", settings.spp},
          {"seed", settings.seed},
          {"max_depth", settings.max_depth},
          {"seconds", phases},
          {"rays",
           {{"camera", s.rays.camera},
            {"bounce", s.rays.bounce},
            {"shadow", s.rays.shadow},
            {"total", s.rays.total()},
            {"step_limits", step_limits(loaded.scene)},
            {"cost",
             {{"camera", cost_json(s.rays.costs[0])},
              {"bounce", cost_json(s.rays.costs[1])},
              {"shadow", cost_json(s.rays.costs[2])}}},
            {"per_second", per_second(s.rays.total() - s.earlier_rays, trace)}}},
          {"samples",
           {{"total", s.samples},
            {"non_finite", s.non_finite_samples},
            {"non_finite_places", places_json(s.non_finite_places)},
            {"firefly_pixels", s.firefly_pixels},
            {"brightest", s.brightest_sample},
            {"per_second", per_second(s.samples - s.earlier_samples, trace)}}},
          {"acceleration",
           {{"triangles", s.accel.triangles},
            {"bricks", s.accel.hypertexture_bricks},
            {"bytes", s.accel.bytes}}},
          {"hypertextures", hypertextures},
          {"memory", {{"peak", peak_memory()}}},
          {"efficiency", efficiency_json(report, s, result.film)},
          {"texture_cache", texture_cache},
          {"textures", s.textures}};
}

std::string statistics_text(const json& s) {
  std::string text;
  for (const json& h : s["hypertextures"])
    text += fmt::format(
        "{:<14} {} of {} components kept, {} bricks {}, {:.1f} MiB, cache {} ({:.2f} s)\n",
        h["geometry"].get<std::string>(), h["kept"].get<std::uint64_t>(),
        h["components"].get<std::uint64_t>(), h["bricks"].get<std::uint64_t>(),
        h["bricks_read"].get<bool>() ? "read" : "made", h["bytes"].get<double>() / 1048576,
        h["cache_built"].get<bool>() ? "built" : "read", h["cache_build_seconds"].get<double>());
  text += fmt::format("{:<14} {} triangles, {} bricks, {:.1f} MiB in Embree\n", "scene",
                      s["acceleration"]["triangles"].get<std::uint64_t>(),
                      s["acceleration"]["bricks"].get<std::uint64_t>(),
                      s["acceleration"]["bytes"].get<double>() / 1048576);
  text += fmt::format(
      "{:<14} {} camera, {} bounce, {} shadow, {:.3g} M/s\n", "rays",
      s["rays"]["camera"].get<std::uint64_t>(), s["rays"]["bounce"].get<std::uint64_t>(),
      s["rays"]["shadow"].get<std::uint64_t>(), s["rays"]["per_second"].get<double>() / 1e6);
  const json& cost = s["rays"]["cost"];
  text += fmt::format(
      "{:<14} {:.2f} camera, {:.2f} bounce, {:.2f} shadow evaluations of fields a ray\n", "cost",
      cost["camera"]["per_ray"].get<double>(), cost["bounce"]["per_ray"].get<double>(),
      cost["shadow"]["per_ray"].get<double>());
  text += fmt::format(
      "{:<14} {} paths, {:.3g} M/s, {} not finite, {} firefly pixels, brightest {:.3g}\n",
      "samples", s["samples"]["total"].get<std::uint64_t>(),
      s["samples"]["per_second"].get<double>() / 1e6,
      s["samples"]["non_finite"].get<std::uint64_t>(),
      s["samples"]["firefly_pixels"].get<std::uint64_t>(), s["samples"]["brightest"].get<double>());
  text += s["textures"].get<std::string>();
  text += fmt::format("{:<14} {:.1f} MiB at most\n", "memory",
                      s["memory"]["peak"].get<double>() / 1048576);
  text += fmt::format("{:<14}", "seconds");
  for (const auto& phase : s["seconds"].items())
    text += fmt::format(" {} {:.2f}", phase.key(), phase.value().get<double>());
  return text + "\n";
}

}  // namespace morsel::tools
