// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "renderer/integrator/render.h"
#include "renderer/scene/scene.h"

namespace morsel::render {

// Writes one scan-line EXR with the layers
//   R G B A            half   radiance, premultiplied; A: share of samples that see something
//   albedo.R .G .B     half   of the first vertex that is not a mirror or clear glass, in [0, 1]
//   N.X N.Y N.Z        half   normal there, world space, towards the viewer
//   Ng.X Ng.Y Ng.Z     half   normal of the first hit, without interpolation or bumps
//   P.X P.Y P.Z        float  the first hit, world space
//   variance.R .G .B   float  of R, G, B
//   Z                  float  depth of the first hit along the camera's axis, 1e10 if none
//   component          float  1 + id of the hypertexture component first hit, else 0
//   steps              float  mean evaluations of hypertexture by camera rays, hit or not
//   sampleCount        float  paths; 0 where the render was cancelled
//   denoised.R .G .B   half   R, G, B without noise, if RenderResult has it
//   light_NAME.R .G .B half   the part of R, G, B of each light group
//   crypto_object00.R .. crypto_object02.A, crypto_material.., crypto_component..
//                      float  Cryptomatte, if asked for: (id, share) of up to six names
// A crop is the data window inside the display window of the full image. The header has the
// versions of Morsel and of the libraries that made the pixels, samples, seed, depth, the time of
// writing and those of each phase of the render, rays, exposure, whether all samples are there
// (morsel:complete) and the camera's matrices (worldToCamera, worldToNDC). Values outside half's
// range are clamped to it. Appears under `path` only when complete; throws std::runtime_error that
// names the file.
void write_exr(const std::filesystem::path& path, const Scene& scene, const RenderResult& result);

// The same for a shard, whose film `result` has: the channels shard.* hold its sums exactly
// (shard_layers.h), for merge_shards().
void write_shard(const std::filesystem::path& path, const Scene& scene, const RenderResult& result,
                 FilmSums& sums, const std::string& scene_hash);

}  // namespace morsel::render
