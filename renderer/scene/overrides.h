// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hypertexture_geom/params/json_reader.h"

namespace morsel::render {

// One value of a scene file, replaced before the file is read. `path` has keys separated by dots;
// an element of an array is named by its "name" (an instance without one by its geometry's) or by
// its index: "geometries.rock.keep", "geometries.0.field.modulations.0.seed".
// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON throws nothing.
struct Override {
  std::string path;
  nlohmann::json value;
  std::string source;  // how the user wrote it, for messages: "--set render.spp=16"
};

// Reads "path=value" as given to `--set`; the value is JSON, or a string when it is not.
// Throws params::InputError when there is no "=" or a part of the path is empty.
Override parse_override(const std::string& text);

// Sets the value in `root`, making objects that are missing on the way (whether their keys are
// known is for the reader to say). Returns the JSON pointer of the value, or of the outermost
// object that was made for it. Throws params::InputError when the path leads into a number or
// string, or names an element that an array does not have or has several of.
std::string apply_override(nlohmann::json& root, const Override& change, const params::Place& file);

}  // namespace morsel::render
