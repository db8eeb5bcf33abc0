// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// mask(x) f(x). Where the mask is 0 all over a box, f is not evaluated there.
std::unique_ptr<Expression> make_masked(std::shared_ptr<const Expression> mask,
                                        std::shared_ptr<const Expression> f);

}  // namespace morsel::geom
