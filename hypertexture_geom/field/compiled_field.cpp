// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/compiled_field.h"

#include <limits>

#include "hypertexture_geom/field/tape_builder.h"

namespace morsel::geom {

template <class T>
CompiledField<T>::CompiledField(const topology::ScalarField& field, const topology::Box& box)
    : box_(box), restricted_(field.restricted_to(box)) {
  TapeBuilder builder(box, std::numeric_limits<T>::epsilon() / 2);
  centre_ = builder.centre();
  const TapeValue result = builder.field(*restricted_);
  value_error_ = result.error;
  for (int i = 0; i < 3; ++i) gradient_error_[i] = result.slope_error[i];
  tape_ = builder.finish<T>(result);
  if (tape_.opaque.empty()) restricted_.reset();
  tape_.instructions.shrink_to_fit();
  tape_.constants.shrink_to_fit();
  tape_.words.shrink_to_fit();
}

template <class T>
std::size_t CompiledField<T>::bytes() const {
  return sizeof(*this) + tape_.instructions.capacity() * sizeof(TapeInstruction) +
         tape_.constants.capacity() * sizeof(T) + tape_.words.capacity() * sizeof(std::int32_t) +
         tape_.opaque.capacity() * sizeof(OpaqueField);
}

template class CompiledField<float>;
template class CompiledField<double>;

}  // namespace morsel::geom
