// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "renderer/accel/interaction.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// The number that a ramp goes by, in object space of the hit's instance; none where the hit has no
// such number. See RampTexture.
std::optional<float> ramp_input(const Scene& scene, RampInput input, const SurfaceInteraction& hit);

// The colour at `x` in [low, high]; see RampTexture.
V3f ramp_color(const RampTexture& ramp, float x);

}  // namespace morsel::render
