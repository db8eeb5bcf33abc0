// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "topology/morse/audit.h"
#include "topology/morse/morse_complex.h"
#include "topology/section_file.h"

namespace morsel::topology {

// The Morse engine's results in a topology cache:
//   morse.points        a record for each critical point, by decreasing F
//   morse.separatrices  saddle, maximum, and where its path lies in morse.paths
//   morse.paths         float32 x, y, z
//   morse.meta          JSON: what was left undecided, the audit, times
void put_morse(Sections& sections, const MorseComplex& complex, const Audit* audit);

// Reads them back; empty when the file has none. Throws CacheError, naming `file` and the record,
// when they are not what put_morse writes. `components` is the size of the component table, which
// the points' sets refer to.
std::optional<MorseComplex> get_morse(const Sections& sections, std::size_t components,
                                      std::string_view file);

// morse.meta, or null.
nlohmann::json morse_meta(const Sections& sections, std::string_view file);

}  // namespace morsel::topology
