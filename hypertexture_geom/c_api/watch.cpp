// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/c_api/watch.h"

#include <algorithm>
#include <utility>

namespace morsel::c_api {

Watch::Watch(void (*progress)(void*, double, const char*), std::int32_t (*cancel)(void*),
             void* user, std::vector<Phase> phases)
    : progress_(progress), cancel_(cancel), user_(user), phases_(std::move(phases)) {
  if (cancel_ && cancel_(user_) != 0) throw topology::Cancelled();
}

topology::Execution Watch::execution() {
  topology::Execution execution;
  execution.cancel = &cancelled_;
  if (progress_ || cancel_)
    execution.progress = [this](double fraction, const char* phase) { report(fraction, phase); };
  return execution;
}

void Watch::report(double fraction, const char* phase) {
  double before = 0.0;
  for (const Phase& p : phases_) {
    if (p.name == phase) {
      last_ = std::clamp(before + p.share * std::clamp(fraction, 0.0, 1.0), last_, 1.0);
      break;
    }
    before += p.share;
  }
  if (progress_) progress_(user_, last_, phase);
  if (cancel_ && cancel_(user_) != 0) cancelled_ = true;
}

void Watch::finish() {
  if (cancelled_) throw topology::Cancelled();
  if (progress_) progress_(user_, 1.0, "done");
}

}  // namespace morsel::c_api
