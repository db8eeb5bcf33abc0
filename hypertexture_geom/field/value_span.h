// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/params/json_reader.h"

namespace morsel::geom {

// The values between `from` and `to`, both of which bias and gain keep.
struct ValueSpan {
  double width = 1.0;
  double middle = 0.5;
};

// The parameters "from" and "to".
std::vector<params::Parameter> value_span_parameters();

// Reads them. Throws params::InputError unless to is above from.
ValueSpan value_span_from_json(const params::JsonReader& reader);

}  // namespace morsel::geom
