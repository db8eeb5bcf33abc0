// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hypertexture_geom/field/tape.h"

namespace morsel::geom {

// Of a tape that was read from a file: what keeps it from being run, or nothing. A tape without a
// problem reads no register before it is written, and no constant or integer beyond the tape's end,
// whatever its numbers are. One that refers to fields is a problem.
std::string problem_of(const Tape<double>& tape);

}  // namespace morsel::geom
