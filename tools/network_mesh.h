// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "topology/morse/morse_complex.h"

namespace morsel::tools {

// What of a complex is drawn.
struct NetworkParts {
  bool maxima = true, saddles = true, separatrices = true;
};

// The network of a complex as triangles that a renderer can draw: balls of twice `radius` at maxima
// and 2-saddles, and tubes of `radius` along separatrices. ASCII PLY with vertex normals and, per
// vertex, the component it belongs to (-1: not known). `radius` is an object-space length > 0.
void write_network_ply(std::ostream& out, const topology::MorseComplex& complex,
                       const NetworkParts& parts, double radius);

}  // namespace morsel::tools
