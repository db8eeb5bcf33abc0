// SPDX-License-Identifier: Apache-2.0
#include "tools/render_statistics.h"

#include <fmt/format.h>

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
          {"bytes", report.bytes}};
}

double per_second(std::uint64_t count, double seconds) {
  return seconds > 0 ? static_cast<double>(count) / seconds : 0.0;
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

json statistics_json(const RenderReport& report, const render::LoadedScene& loaded,
                     const render::RenderResult& result) {
  const render::RenderStatistics& s = result.statistics;
  const render::RenderSettings& settings = loaded.scene.settings;
  const render::Crop& window = result.film.window();
  json phases = json::object();
  for (const auto& [phase, seconds] : s.seconds) phases[phase] = seconds;
  phases["load"] = report.load_seconds;
  phases["write"] = report.write_seconds;
  phases["total"] = report.load_seconds + report.render_seconds + report.write_seconds;
  const double trace = s.seconds_of("trace");

  json hypertextures = json::array();
  for (const render::HypertextureReport& h : loaded.hypertextures)
    hypertextures.push_back(hypertexture_json(h));
  return {{"scene", report.scene},
          {"exr", report.exr},
          {"png", report.png.empty() ? json(nullptr) : json(report.png)},
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
            {"per_second", per_second(s.rays.total(), trace)}}},
          {"samples",
           {{"total", s.samples},
            {"non_finite", s.non_finite_samples},
            {"firefly_pixels", s.firefly_pixels},
            {"brightest", s.brightest_sample},
            {"per_second", per_second(s.samples, trace)}}},
          {"acceleration",
           {{"triangles", s.accel.triangles},
            {"bricks", s.accel.hypertexture_bricks},
            {"bytes", s.accel.bytes}}},
          {"hypertextures", hypertextures},
          {"textures", s.textures}};
}

std::string statistics_text(const json& s) {
  std::string text;
  for (const json& h : s["hypertextures"])
    text += fmt::format(
        "{:<14} {} of {} components kept, {} bricks, {:.1f} MiB, cache {} ({:.2f} s)\n",
        h["geometry"].get<std::string>(), h["kept"].get<std::uint64_t>(),
        h["components"].get<std::uint64_t>(), h["bricks"].get<std::uint64_t>(),
        h["bytes"].get<double>() / 1048576, h["cache_built"].get<bool>() ? "built" : "read",
        h["cache_build_seconds"].get<double>());
  text += fmt::format("{:<14} {} triangles, {} bricks, {:.1f} MiB in Embree\n", "scene",
                      s["acceleration"]["triangles"].get<std::uint64_t>(),
                      s["acceleration"]["bricks"].get<std::uint64_t>(),
                      s["acceleration"]["bytes"].get<double>() / 1048576);
  text += fmt::format(
      "{:<14} {} camera, {} bounce, {} shadow, {:.3g} M/s\n", "rays",
      s["rays"]["camera"].get<std::uint64_t>(), s["rays"]["bounce"].get<std::uint64_t>(),
      s["rays"]["shadow"].get<std::uint64_t>(), s["rays"]["per_second"].get<double>() / 1e6);
  text += fmt::format(
      "{:<14} {} paths, {:.3g} M/s, {} not finite, {} firefly pixels, brightest {:.3g}\n",
      "samples", s["samples"]["total"].get<std::uint64_t>(),
      s["samples"]["per_second"].get<double>() / 1e6,
      s["samples"]["non_finite"].get<std::uint64_t>(),
      s["samples"]["firefly_pixels"].get<std::uint64_t>(), s["samples"]["brightest"].get<double>());
  text += s["textures"].get<std::string>();
  text += fmt::format("{:<14}", "seconds");
  for (const auto& phase : s["seconds"].items())
    text += fmt::format(" {} {:.2f}", phase.key(), phase.value().get<double>());
  return text + "\n";
}

}  // namespace morsel::tools
