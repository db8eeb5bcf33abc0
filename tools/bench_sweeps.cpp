// SPDX-License-Identifier: Apache-2.0
#include "tools/bench_sweeps.h"

#include <fmt/format.h>
#include <oneapi/tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "renderer/integrator/render.h"
#include "tools/bench_numbers.h"

namespace morsel::tools {
namespace {

namespace fs = std::filesystem;

// A file that goes with the object.
class TemporaryCache {
 public:
  explicit TemporaryCache(int layers)
      : file_(fs::temp_directory_path() /
              fmt::format("morsel-bench-{}-{}.topo", ::getpid(), layers)) {}
  ~TemporaryCache() {
    std::error_code ignored;
    fs::remove(file_, ignored);
  }
  TemporaryCache(const TemporaryCache&) = delete;
  TemporaryCache& operator=(const TemporaryCache&) = delete;
  std::string name() const { return file_.string(); }

 private:
  fs::path file_;
};

}  // namespace

nlohmann::json bench_scaling(const render::LoadedScene& loaded, const SmallRender& small,
                             const topology::Execution& execution, Reporter& reporter) {
  render::Scene scene = loaded.scene;
  make_small(scene, small);
  const int all = oneapi::tbb::info::default_concurrency();
  std::vector<int> counts;
  for (int n = 1; n < all; n *= 2) counts.push_back(n);
  counts.push_back(all);
  std::vector<std::vector<double>> rates(counts.size());
  for (int i = 0; i < small.repetitions; ++i)
    for (std::size_t k = 0; k < counts.size(); ++k) {
      reporter.info(fmt::format("rendering with {} threads", counts[k]));
      rates[k].push_back(samples_per_second(render_once(scene, counts[k], execution).statistics));
    }
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const double rate = median(rates[k]);
    rows.push_back({{"threads", counts[k]},
                    {"samples_per_second", rate},
                    {"spread", spread(rates[k])},
                    {"speedup", 1.0}});
    rows.back()["speedup"] = rate / rows.front()["samples_per_second"].get<double>();
  }
  return rows;
}

nlohmann::json bench_layers(const std::string& scene,
                            const std::vector<render::Override>& overrides,
                            const std::string& geometry, int most, const SmallRender& small,
                            const topology::Execution& execution, Reporter& reporter) {
  nlohmann::json rows = nlohmann::json::array();
  for (int layers = 1; layers <= most; ++layers) {
    reporter.info(fmt::format("labelling and rendering with {} of {} layers", layers, most));
    const TemporaryCache cache(layers);
    const std::string source = fmt::format("--layers {}", most);
    std::vector<render::Override> changed = overrides;
    const std::string path = fmt::format("geometries.{}.", geometry);
    changed.push_back({path + "field.modulations.0.layers", layers, source});
    changed.push_back({path + "cache", cache.name(), source});
    render::LoadOptions options;
    options.execution = execution;
    options.warn = [&](const std::string& message) { reporter.warn(message); };
    render::LoadedScene loaded = render::load_scene(scene, changed, options);
    make_small(loaded.scene, small);
    const render::RenderStatistics statistics = render_once(loaded.scene, 0, execution).statistics;
    const render::RayCost& camera = statistics.rays.costs[0];
    for (const render::HypertextureReport& h : loaded.hypertextures) {
      if (h.geometry != geometry) continue;
      rows.push_back({{"layers", layers},
                      {"label_seconds", h.build_seconds},
                      {"components", h.components},
                      {"certified", h.certified},
                      {"bricks", h.bricks},
                      {"samples_per_second", samples_per_second(statistics)},
                      {"evaluations_per_ray", static_cast<double>(camera.evaluations) /
                                                  static_cast<double>(statistics.rays.camera)}});
    }
  }
  return rows;
}

}  // namespace morsel::tools
