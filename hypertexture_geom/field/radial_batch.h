// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include "hypertexture_geom/field/impulse_list.h"
#include "hypertexture_geom/field/radial_polynomial.h"
#include "topology/model_batch.h"

// Sums of radial terms as models of the eight children of a box at once: what RadialSum (see
// radial_model.h) is for one box, with the same polynomials and error bounds.
namespace morsel::geom {

// `models` has been started; receives the sum of the impulses and of a polynomial that holds on a
// box that contains all of them.
void child_models_of(const ImpulseList& impulses, const RadialPolynomial& polynomial,
                     topology::ModelBatch& models);

// radius - sqrt(|x - centre|^2 + square), square > 0.
void child_models_of_sphere(const Imath::V3d& centre, double radius, double square,
                            topology::ModelBatch& models);

}  // namespace morsel::geom
