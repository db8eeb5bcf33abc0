// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace morsel::geom {

// Everything that a field's description may say, as Markdown, from the declarations. It is
// hypertexture_geom/PARAMETERS.md; a test keeps that up to date.
std::string field_reference();

// JSON Schema (draft 7) of a hypertexture geometry, with "definitions" of the kinds "density",
// "modulation" and "mask" that it refers to: each is one of its declared types.
nlohmann::json hypertexture_schema();

}  // namespace morsel::geom
