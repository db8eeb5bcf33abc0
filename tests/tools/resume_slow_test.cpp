// SPDX-License-Identifier: Apache-2.0
#include "interrupted_render.h"

namespace morsel::test {
namespace {

TEST(KilledRender, GoesOnToTheSamePixels) {
  InterruptedRender({"--spp", "400", "--resolution", "64x48"}).kill_and_resume(20, 11);
}

TEST(KilledRender, AdaptiveGoesOnToTheSamePixels) {
  InterruptedRender({"--spp", "1024", "--resolution", "64x48", "--set", "render.noise_target=0.01"})
      .kill_and_resume(20, 12);
}

}  // namespace
}  // namespace morsel::test
