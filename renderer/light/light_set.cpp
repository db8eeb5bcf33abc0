// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/light_set.h"

namespace morsel::render {

LightSet::LightSet(const Scene& scene, bool complete) {
  if (scene.environment) {
    const EnvironmentLight& e = *scene.environment;
    environment_.emplace(e.file.empty() ? EnvironmentImage{} : EnvironmentImage::read(e.file),
                         e.radiance, e.rotation, !complete);
    environment_visible_ = e.visible_to_camera;
    // Irradiance under a hemisphere of the mean radiance.
    environment_importance_ = kPi * environment_->sampled_luminance();
  }
  for (const RectangleLight& r : scene.rectangles) rectangles_.emplace_back(r);
}

float LightSet::total_importance(LightGroup group, const V3f& p) const {
  float total = group == LightGroup::kRectangles ? 0.0f : environment_importance_;
  if (group != LightGroup::kEnvironment)
    for (const Rectangle& r : rectangles_) total += r.importance(p);
  return total;
}

LightSample LightSet::sample(LightGroup group, const V3f& p, float choice, const V2f& u) const {
  const float total = total_importance(group, p);
  if (!(total > 0.0f)) return {};
  float rest = choice * total;
  if (group != LightGroup::kRectangles && environment_importance_ > 0.0f) {
    if (group == LightGroup::kEnvironment || rest < environment_importance_) {
      LightSample s = environment_->sample(u);
      s.pdf *= environment_importance_ / total;
      return s;
    }
    rest -= environment_importance_;
  }
  const Rectangle* chosen = nullptr;
  float importance = 0.0f;
  for (const Rectangle& r : rectangles_) {
    const float i = r.importance(p);
    if (i <= 0.0f) continue;
    chosen = &r;  // the last one stands in when rounding leaves something over
    importance = i;
    if (rest < i) break;
    rest -= i;
  }
  if (chosen == nullptr) return {};
  LightSample s = chosen->sample(p, u);
  s.pdf *= importance / total;
  return s;
}

float LightSet::environment_pdf(LightGroup group, const V3f& p, const V3f& wi) const {
  if (!(environment_importance_ > 0.0f)) return 0.0f;
  const float share = group == LightGroup::kEnvironment
                          ? 1.0f
                          : environment_importance_ / total_importance(group, p);
  return environment_->pdf(wi) * share;
}

float LightSet::rectangle_pdf(LightGroup group, std::size_t i, const V3f& p, const V3f& wi,
                              float distance) const {
  const float importance = rectangles_[i].importance(p);
  if (!(importance > 0.0f)) return 0.0f;
  return rectangles_[i].pdf(p, wi, distance) * importance / total_importance(group, p);
}

}  // namespace morsel::render
