// SPDX-License-Identifier: Apache-2.0
// 10^7 sample points in long double against the bounds of local models, half of them with
// flush-to-zero on while the models were computed.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/hypertexture_geom/against_reference.h"

namespace morsel::geom::testing {
namespace {

void expect_sound(bool flush, std::uint64_t seed) {
  const ReferenceCheck check = check_against_reference(5'000'000, seed, flush);
  std::printf(
      "%lld samples in %lld boxes (%lld eight at a time) of %lld fields; on %lld wide boxes slopes "
      "have no bound\n",
      static_cast<long long>(check.samples), static_cast<long long>(check.boxes),
      static_cast<long long>(check.child_boxes), static_cast<long long>(check.fields),
      static_cast<long long>(check.without_slopes));
  EXPECT_EQ(check.total(), 0) << check.text();
  EXPECT_LT(check.without_slopes, check.boxes / 20);
  EXPECT_GT(check.child_boxes, check.boxes / 4);
}

TEST(SoundnessSlow, TenMillionSamplesGradualUnderflow) { expect_sound(false, 21); }
TEST(SoundnessSlow, TenMillionSamplesFlushToZero) { expect_sound(true, 22); }

}  // namespace
}  // namespace morsel::geom::testing
