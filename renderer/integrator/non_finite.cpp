// SPDX-License-Identifier: Apache-2.0
#include "renderer/integrator/non_finite.h"

#include <fmt/format.h>

#include <iterator>
#include <stdexcept>

namespace morsel::render {

std::string NonFinitePlace::text() const {
  return fmt::format("pixel {},{}, sample {}{}, after bounce {}", x, y, sample,
                     half == 0 ? "" : " of the second half", bounce);
}

void NonFiniteReport::add(const NonFinitePlace& place) {
  if (stop_)
    throw std::runtime_error(
        fmt::format("radiance that is not finite: {}; stopped as asked", place.text()));
  const std::lock_guard lock(mutex_);
  places_.insert(place);
  if (places_.size() > kMost) places_.erase(std::prev(places_.end()));
}

std::vector<NonFinitePlace> NonFiniteReport::places() const {
  const std::lock_guard lock(mutex_);
  return {places_.begin(), places_.end()};
}

}  // namespace morsel::render
