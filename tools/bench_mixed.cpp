// SPDX-License-Identifier: Apache-2.0
#include "tools/bench_mixed.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "renderer/image/png.h"
#include "renderer/scene/cache_store.h"
#include "tools/bench_numbers.h"
#include "tools/bench_surfaces.h"

namespace morsel::tools {
namespace {

namespace fs = std::filesystem;

render::TriangleMesh to_triangles(const topology::Mesh& mesh) {
  render::TriangleMesh triangles;
  triangles.normals = mesh.normals;
  triangles.positions.reserve(mesh.positions.size());
  for (const Imath::V3d& p : mesh.positions) triangles.positions.emplace_back(p);
  triangles.triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    triangles.triangles.emplace_back(static_cast<int>(t[0]), static_cast<int>(t[1]),
                                     static_cast<int>(t[2]));
  return triangles;
}

double mean_luminance(const render::Film& film) {
  double sum = 0.0;
  const render::Crop& window = film.window();
  for (int y = window.y0; y < window.y1; ++y)
    for (int x = window.x0; x < window.x1; ++x) {
      const render::V3f& c = film.at(x, y).color;
      sum += 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
    }
  return sum / (static_cast<double>(film.width()) * film.height());
}

BenchPicture picture(const std::string& caption, const render::Film& film, float exposure) {
  const fs::path file = fs::temp_directory_path() / fmt::format("morsel-bench-{}.png", ::getpid());
  render::write_png(file, film, exposure);
  std::ifstream in(file, std::ios::binary);
  BenchPicture p{caption, std::string(std::istreambuf_iterator<char>(in), {})};
  std::error_code ignored;
  fs::remove(file, ignored);
  return p;
}

}  // namespace

MixedBench bench_mixed(const render::SceneDocument& document, const render::LoadedScene& loaded,
                       double error, const SmallRender& small, const topology::Execution& execution,
                       Reporter& reporter) {
  render::Scene mixed = loaded.scene;
  make_small(mixed, small);
  render::Scene meshes = mixed;
  render::CacheStore caches(document);
  std::uint64_t triangles = 0;
  for (const render::HypertextureReport& used : loaded.hypertextures) {
    reporter.info(used.geometry + ": meshing");
    const geom::Hypertexture hypertexture =
        render::read_hypertexture(document, render::find_hypertexture(document, used.geometry));
    const auto cache = caches.get(hypertexture, execution,
                                  [&](const std::string& message) { reporter.warn(message); });
    const topology::Mesh mesh = mesh_kept(hypertexture, cache.cache->topology, error, execution);
    triangles += mesh.triangles.size();
    for (std::size_t i = 0; i < meshes.geometries.size(); ++i) {
      if (meshes.geometries[i].name != used.geometry) continue;
      meshes.geometries[i].shape = to_triangles(mesh);
      for (render::Instance& instance : meshes.instances)
        if (instance.geometry == i) instance.detached_material.reset();
    }
  }

  MixedBench bench;
  std::vector<double> ratios, rates[2];
  for (int i = 0; i < small.repetitions; ++i) {
    reporter.info("rendering, with hypertextures and with meshes");
    const render::RenderResult ours = render_once(mixed, 0, execution);
    const render::RenderResult theirs = render_once(meshes, 0, execution);
    rates[0].push_back(samples_per_second(ours.statistics));
    rates[1].push_back(samples_per_second(theirs.statistics));
    ratios.push_back(rates[0].back() / rates[1].back());
    if (i > 0) continue;  // all are the same picture
    bench.result["mean_luminance"] = {{"mixed", mean_luminance(ours.film)},
                                      {"mesh", mean_luminance(theirs.film)}};
    const float exposure = mixed.settings.exposure;
    bench.pictures = {picture("with hypertextures", ours.film, exposure),
                      picture("with meshes of them", theirs.film, exposure)};
  }
  bench.result["ratio"] = median(ratios);
  bench.result["spread"] = spread(ratios);
  bench.result["samples_per_second"] = {{"mixed", median(rates[0])}, {"mesh", median(rates[1])}};
  bench.result["hypertextures"] = loaded.hypertextures.size();
  bench.result["triangles"] = triangles;
  bench.result["relative_error"] = error;
  return bench;
}

}  // namespace morsel::tools
