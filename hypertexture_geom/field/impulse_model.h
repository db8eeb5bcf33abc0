// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/impulse_list.h"
#include "hypertexture_geom/field/radial_model.h"
#include "topology/scalar_field.h"

namespace morsel::geom {

// False only when the impulse is 0 on all of the box |u_i| <= half_i about `centre`.
bool reaches(const Impulse& impulse, const Imath::V3d& centre, const Imath::V3d& half);

// Adds the impulses' values and derivatives at `x`.
void add_jet(const ImpulseList& impulses, const Imath::V3d& x, topology::Jet& jet);

// Adds the impulses that reach the sum's box.
void add_terms(const ImpulseList& impulses, RadialSum& sum);

}  // namespace morsel::geom
