// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "renderer/scene/scene_json.h"

namespace morsel::render {

// Everything that a scene file may say, as Markdown, from the declarations. It is
// scenes/REFERENCE.md; a test keeps that up to date.
std::string scene_reference();

// JSON Schema (draft 7) of a scene file, from the same declarations. It says which keys, types,
// ranges and choices there are; what the values mean to one another (names that refer, what
// excludes what) is for `morsel scene check`.
nlohmann::json scene_schema();

// Every problem of a document that the declarations can tell, in the words of the loader.
std::vector<std::string> declared_problems(const SceneDocument& document);

}  // namespace morsel::render
