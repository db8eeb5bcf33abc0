// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <nlohmann/json.hpp>

#include "hypertexture_geom/params/json_reader.h"
#include "renderer/math/affine.h"

namespace morsel::render {

// Scales, then rotates about the fixed axes x, y, z in this order (degrees, counter-clockwise seen
// from the axis' tip), then translates. Row vectors: p' = p * M.
Imath::M44d make_transform(const Imath::V3d& scale, const Imath::V3d& rotate_degrees,
                           const Imath::V3d& translate);

// Takes 4 rows of 4 numbers (params::Type::kMatrix4) in the column-vector convention of most texts
// (p' = M p, translation in the last column) and returns the matrix for row vectors. Throws
// params::InputError for a last row other than 0 0 0 1, or a matrix without inverse.
Imath::M44d read_transform(const nlohmann::json& rows, const params::Place& place);

}  // namespace morsel::render
