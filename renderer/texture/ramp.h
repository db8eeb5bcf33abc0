// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>

#include "renderer/accel/interaction.h"
#include "renderer/scene/scene.h"

namespace morsel::geom {
class Field;
}

namespace morsel::render {

// The numbers that ramps go by, of the hypertextures of a scene.
class SolidInputs {
 public:
  // Prepares what the scene's ramps ask for. `scene` must outlive this object.
  explicit SolidInputs(const Scene& scene);

  // In object space of the hit's instance; none where the hit has no such number.
  std::optional<float> value(RampInput input, const SurfaceInteraction& hit) const;

 private:
  struct Solid {
    const geom::Field* field = nullptr;
    std::shared_ptr<const geom::Field> density;  // without its modulations
    std::size_t components = 1;
  };
  std::map<std::uint32_t, Solid> solids_;  // by geometry
};

// The colour at `x` in [low, high]; see RampTexture.
V3f ramp_color(const RampTexture& ramp, float x);

}  // namespace morsel::render
