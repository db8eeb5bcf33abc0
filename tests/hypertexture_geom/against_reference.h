// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace morsel::geom::testing {

// What local models were seen to break, of how many samples.
struct ReferenceCheck {
  std::int64_t fields = 0, boxes = 0, samples = 0;
  std::int64_t child_boxes = 0;  // of boxes, those whose models came eight at a time
  std::int64_t value = 0, gradient = 0, range = 0, gradient_range = 0;
  std::int64_t undefined = 0;       // NaN for a bound, or a coefficient that is not finite
  std::int64_t infinite = 0;        // boxes without a bound where there is to be one
  std::int64_t without_slopes = 0;  // boxes without a bound of the slopes; wide ones may be
  std::string first;                // the first failure, in words
  std::int64_t total() const {
    return value + gradient + range + gradient_range + undefined + infinite;
  }
  std::string text() const {
    return std::to_string(value) + " values, " + std::to_string(gradient) + " gradients, " +
           std::to_string(range) + " ranges, " + std::to_string(gradient_range) +
           " gradient ranges, " + std::to_string(undefined) + " undefined, " +
           std::to_string(infinite) + " infinite; first: " + first;
  }
};

// Random fields of every kind and composition, random boxes of widths 2^-1 to 2^-20 (about one half
// straddling an apex, a support border, a lattice plane or the end of a mask; some flat, some far
// away, some
// where values underflow), sample points in long double against the models' bounds for value and
// gradient, by an independent implementation of the fields (reference_field.h). Models come from
// model(), and from model() and child_models() (all eight) of fields that were restricted to the
// box in up to 24 steps. `scale` < 1 weakens the
// bounds, to show that that is noticed.
ReferenceCheck check_against_reference(std::int64_t samples, std::uint64_t seed, bool flush_to_zero,
                                       double scale = 1.0);

}  // namespace morsel::geom::testing
