// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "topology/scalar_field.h"

namespace morsel::geom {

class TapeBuilder;
struct TapeValue;

// A field, or the restriction of one, that can write itself onto a tape (tape_builder.h) for fast
// evaluation. Those that cannot are evaluated in double precision, a point at a time.
class Term : public topology::ScalarField {
 public:
  // Writes instructions that evaluate the field at the builder's current point, for any point of
  // the builder's current box, on which the field must be defined.
  virtual TapeValue emit(TapeBuilder& builder) const;
};

}  // namespace morsel::geom
