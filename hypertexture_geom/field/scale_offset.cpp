// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/scale_offset.h"

#include "hypertexture_geom/field/univariate_function.h"

namespace morsel::geom {

using params::Type;

ModulationEntry scale_offset_entry() {
  return {{"scale_offset",
           "Multiplies by a factor and adds a constant.",
           {{"type", Type::kString, "scale_offset", "Kind of modulation."},
            {"scale", Type::kNumber, 1.0,
             "Factor, not 0; a negative one turns the inside out, which needs \"bounds\".", "",
             -1e6, 1e6},
            {"offset", Type::kNumber, 0.0, "Added after that: positive values thicken.", "length",
             -1e6, 1e6}}},
          [](std::shared_ptr<const Expression> previous, const params::JsonReader& r) {
            if (r.number("scale") == 0.0) r.place("scale").fail("must not be 0");
            return make_univariate(affine_function(r.number("scale"), r.number("offset")),
                                   std::move(previous));
          }};
}

}  // namespace morsel::geom
