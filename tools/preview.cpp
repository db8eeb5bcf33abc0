// SPDX-License-Identifier: Apache-2.0
#include "tools/preview.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/image/png.h"

namespace morsel::tools {
namespace {

using Clock = Watcher::Clock;

// How often it is drawn again at most, seconds; also, it may not take more than this share of time.
constexpr double kInterval = 1.0, kShare = 0.05;

}  // namespace

Preview::Preview(const RenderPlan& plan, const render::Scene& scene, render::FilmSums& sums,
                 Reporter& reporter)
    : plan_(plan), scene_(scene), sums_(sums), reporter_(reporter) {}

// `make_film()` is asked only if it is to be shown.
template <class MakeFilm>
void Preview::show(MakeFilm&& make_film) {
  if (failed_ || (plan_.preview.empty() && !plan_.tev)) return;
  try {
    const render::Film& film = make_film();
    if (!plan_.preview.empty()) render::write_png(plan_.preview, film, scene_.settings.exposure);
    if (!plan_.tev) return;
    if (!tev_)
      tev_ = std::make_unique<TevClient>(*plan_.tev, plan_.exr.filename().string(),
                                         film.full_width(), film.full_height());
    tev_->update(film);
  } catch (const std::exception& e) {
    failed_ = true;
    reporter_.warn(fmt::format("{}; rendering goes on without a preview", e.what()));
  }
}

void Preview::watch(Watcher& watcher) {
  if (plan_.preview.empty() && !plan_.tev) return;
  watcher.add(Clock::now(), [this](Clock::time_point) {
    const auto begin = Clock::now();
    show([this] { return sums_.develop(); });
    const double pause = std::max(kInterval, seconds_since(begin) / kShare);
    return Clock::now() + to_duration(pause);
  });
}

void Preview::finish(const render::Film& film) {
  show([&]() -> const render::Film& { return film; });
}

}  // namespace morsel::tools
