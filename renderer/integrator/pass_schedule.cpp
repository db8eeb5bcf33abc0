// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/pass_schedule.h"

#include <algorithm>

namespace morsel::render {

std::vector<std::uint32_t> pass_schedule(std::uint32_t first, std::uint32_t last) {
  constexpr std::uint64_t kDoubling = 16, kMost = 64;
  std::vector<std::uint32_t> targets;
  std::uint64_t target = std::max(first, 1u);
  while (target < last) {
    targets.push_back(static_cast<std::uint32_t>(target));
    target = target < kDoubling
                 ? 2 * target
                 : target + std::clamp(target / 8 / kDoubling * kDoubling, kDoubling, kMost);
  }
  targets.push_back(last);
  return targets;
}

}  // namespace morsel::render
