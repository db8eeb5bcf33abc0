// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "renderer/film/film_sums.h"
#include "renderer/scene/scene.h"
#include "tools/render_options.h"
#include "tools/reporter.h"
#include "tools/tev_client.h"
#include "tools/watcher.h"

namespace morsel::tools {

// Shows a picture while it is rendered, in a file or in tev, as the plan says; or nowhere. What
// goes wrong is said once and does not stop the render.
class Preview {
 public:
  Preview(const RenderPlan& plan, const render::Scene& scene, render::FilmSums& sums,
          Reporter& reporter);

  void watch(Watcher& watcher);
  void finish(const render::Film& film);  // the picture as it became

 private:
  template <class MakeFilm>
  void show(MakeFilm&& make_film);

  const RenderPlan& plan_;
  const render::Scene& scene_;
  render::FilmSums& sums_;
  Reporter& reporter_;
  std::unique_ptr<TevClient> tev_;
  bool failed_ = false;
};

}  // namespace morsel::tools
