// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hypertexture_geom/field/univariate_model.h"
#include "topology/local_model.h"

// Arithmetic of local models: each function returns a model of the result on the same box, rounding
// included. Where two models go in they must be of the same box (the same centre and half).
namespace morsel::geom {

// A model without terms on the box: its centre, and half sizes that reach to the box's faces
// whatever the rounding of the centre.
topology::LocalModel empty_model(const topology::Box& box);

// Makes errors that are NaN infinite, and all of them if a coefficient is not finite: what
// overflow leaves behind says nothing, and must say so.
void forget_nans(topology::LocalModel& m);

// The function that is `value` everywhere, to within `error`.
topology::LocalModel constant_model(const topology::Box& box, double value, double error = 0.0);

// The coordinate x_axis.
topology::LocalModel coordinate_model(const topology::Box& box, int axis);

// c + b.(x - origin) + (x - origin).A (x - origin) with A symmetric (xx, yy, zz, xy, xz, yz).
topology::LocalModel quadratic_model(const topology::Box& box, const Imath::V3d& origin, double c,
                                     const Imath::V3d& b, const double (&a)[6]);

topology::LocalModel add(const topology::LocalModel& f, const topology::LocalModel& g);
topology::LocalModel subtract(const topology::LocalModel& f, const topology::LocalModel& g);
topology::LocalModel negate(topology::LocalModel f);
topology::LocalModel scale(topology::LocalModel f, double factor);
topology::LocalModel add_constant(topology::LocalModel f, double constant);
topology::LocalModel product(const topology::LocalModel& f, const topology::LocalModel& g);

// phi(f), where phi is modelled about f.c[0] on an interval that holds all values of f (usually
// f.range()).
topology::LocalModel compose(const topology::LocalModel& f, const UnivariateModel& phi);

// f(y(x)) for a model f on a box that holds every y(x), given models of y's three components on one
// box: a warp.
topology::LocalModel compose(const topology::LocalModel& f, const topology::LocalModel (&y)[3]);

}  // namespace morsel::geom
