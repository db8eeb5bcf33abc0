// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hypertexture_geom/params/parameter.h"

namespace morsel::params {

// What a declaration says, as Markdown: its help, and a table of its parameters with type, unit,
// default, range and help. Parameters named "type" are left out: they only choose the declaration.
// Records within it follow as tables of their own.
std::string reference_of(const Declaration& declaration, int heading_level);

}  // namespace morsel::params
