// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hypertexture_geom/field/expression.h"

namespace morsel::geom {

// a(x) + b(x).
std::unique_ptr<Expression> make_sum(std::shared_ptr<const Expression> a,
                                     std::shared_ptr<const Expression> b);

}  // namespace morsel::geom
