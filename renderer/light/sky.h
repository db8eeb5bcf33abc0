// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/light/environment.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// The clear sky of A. J. Preetham, P. Shirley & B. Smits, "A Practical Analytic Model for
// Daylight", 1999, as a lat-long image without the sun; below the horizon the ground. Radiance 1
// stands for a luminance of 10 kcd/m^2.
EnvironmentImage sky_image(const SkyLight& sky);

// The sun of that sky: direct light by the same paper's attenuation (Rayleigh scattering and
// aerosols) of 128 klx outside the atmosphere, in the same unit; dark below the horizon.
DistantLight sun_of(const SkyLight& sky);

}  // namespace morsel::render
