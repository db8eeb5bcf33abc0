// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "renderer/light/environment.h"
#include "renderer/light/rectangle.h"

namespace morsel::render {

// Lights that one sample chooses among.
enum class LightGroup { kAll, kEnvironment, kRectangles };

// All lights of a scene and the choice among them: in proportion to the light that each can bring
// to the shaded point at most (visibility and the surface's normal not considered).
class LightSet {
 public:
  // Reads the environment's image. `complete`: every light is sampled wherever it shines; otherwise
  // BSDF samples are counted on for the even part of the environment. Throws std::runtime_error,
  // std::invalid_argument.
  LightSet(const Scene& scene, bool complete);

  bool empty() const { return !environment_ && rectangles_.empty(); }
  const std::optional<Environment>& environment() const { return environment_; }
  bool environment_visible_to_camera() const { return environment_visible_; }
  const Rectangle& rectangle(std::size_t i) const { return rectangles_[i]; }
  std::size_t rectangle_count() const { return rectangles_.size(); }

  // A direction from `p` to one of the group's lights; pdf includes the choice, and is 0 if none of
  // them can reach `p`.
  LightSample sample(LightGroup group, const V3f& p, float choice, const V2f& u) const;
  // The density of sample(group, p) for a direction that escapes or that hits rectangle `i`, as far
  // as that light, which must be of the group, is concerned. Lights do not overlap along a ray, so
  // this is what MIS needs.
  float environment_pdf(LightGroup group, const V3f& p, const V3f& wi) const;
  float rectangle_pdf(LightGroup group, std::size_t i, const V3f& p, const V3f& wi,
                      float distance) const;

 private:
  float total_importance(LightGroup group, const V3f& p) const;

  std::optional<Environment> environment_;
  bool environment_visible_ = true;
  float environment_importance_ = 0.0f;
  std::vector<Rectangle> rectangles_;
};

}  // namespace morsel::render
