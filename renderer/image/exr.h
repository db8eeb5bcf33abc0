// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "renderer/integrator/render.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Writes one scan-line EXR with the layers
//   R G B A            half   radiance, premultiplied; A: share of samples that see something
//   albedo.R .G .B     half   of the first vertex that is not a mirror or clear glass, in [0, 1]
//   N.X N.Y N.Z        half   normal there, world space, towards the viewer
//   variance.R .G .B   float  of R, G, B
//   Z                  float  depth of the first hit along the camera's axis, 1e10 if none
//   component          float  1 + id of the hypertexture component first hit, else 0
//   sampleCount        float  paths; 0 where the render was cancelled
// A crop is the data window inside the display window of the full image. The header has version,
// samples, seed, depth, render time, rays, exposure and the camera's matrices (worldToCamera,
// worldToNDC). Values outside half's range are clamped to it. Appears under `path` only when
// complete; throws std::runtime_error that names the file.
void write_exr(const std::filesystem::path& path, const Scene& scene, const RenderResult& result);

}  // namespace morsel::render
