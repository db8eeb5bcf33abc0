// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace morsel::render {

// Fraction of light from a direction at cosine `cos_theta` in (0, 1] that a GGX mirror with F = 1
// reflects in a single bounce (the rest would bounce again); alpha in [0, 1]. Interpolated from a
// table that is integrated at first use (about 20 ms).
float ggx_directional_albedo(float cos_theta, float alpha);

}  // namespace morsel::render
