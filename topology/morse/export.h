// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>

#include "topology/morse/morse_complex.h"

namespace morsel::topology {

// VTK PolyData (XML, ASCII) for ParaView: a vertex for each critical point, then a polyline for
// each separatrix. Cell arrays: `type` (0 maximum, 1 2-saddle, 2 1-saddle, 3 minimum, 4 degenerate,
// 5 separatrix), `F` (of a separatrix: at its saddle), `component` (-1: not known), `point` (index
// of the critical point; of a separatrix: of its saddle).
void write_vtp(const MorseComplex& complex, std::ostream& out);

// One line a critical point, by decreasing F, with a header line; 17 significant digits. `end1` and
// `end2` are the indices of the maxima that a 2-saddle's separatrices end in, empty where lost.
void write_csv(const MorseComplex& complex, std::ostream& out);

// A drawing after figure 7 of the paper: the complex seen along `axis` (0, 1, 2) from above, the
// next axis but one (cyclically) pointing up; separatrices as lines, maxima as dots, the main
// component in black, the others in red. `pixels` is the longer side.
void write_svg(const MorseComplex& complex, std::ostream& out, int axis, int pixels);

}  // namespace morsel::topology
