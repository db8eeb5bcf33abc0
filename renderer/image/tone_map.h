// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/math/vector.h"

namespace morsel::render {

// Scene-linear Rec. 709 to display-referred sRGB values in [0, 1], for previews.
//
// `exposure` in stops comes first. Up to 0.6 values pass unchanged; above, an exponential shoulder
// with the same slope approaches 1, so highlights roll off instead of clipping. The
// shoulder works half on each channel (which lets very bright colours turn white, as film does) and
// half on the largest channel with the others in proportion (which keeps hue and saturation).
// Then the sRGB transfer function.
V3f tone_map(const V3f& radiance, float exposure);

}  // namespace morsel::render
