// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <mutex>
#include <vector>

#include "topology/certified.h"

namespace morsel::topology::meshing {

// Calls body(first, last) for consecutive pieces of [0, size), in parallel. Looks for cancellation
// between the pieces and reports progress when `phase` is given.
template <class Body>
void for_pieces(std::size_t size, const Execution& execution, const char* phase, Body&& body) {
  constexpr std::size_t kPiece = 128;
  const std::size_t pieces = (size + kPiece - 1) / kPiece;
  std::mutex mutex;
  std::size_t done = 0;
  tbb::parallel_for(std::size_t{0}, pieces, [&](std::size_t i) {
    execution.check_cancel();
    body(i * kPiece, std::min(size, (i + 1) * kPiece));
    if (phase == nullptr || !execution.progress) return;
    const std::lock_guard lock(mutex);
    ++done;
    execution.progress(static_cast<double>(done) / static_cast<double>(pieces), phase);
  });
}

// The same where the body appends to a vector: body(first, last, out). The pieces' results are
// joined in order, so that the whole does not depend on the number of threads.
template <class T, class Body>
std::vector<T> collect_pieces(std::size_t size, const Execution& execution, const char* phase,
                              Body&& body) {
  constexpr std::size_t kPiece = 128;
  std::vector<std::vector<T>> parts((size + kPiece - 1) / kPiece);
  for_pieces(size, execution, phase, [&](std::size_t first, std::size_t last) {
    body(first, last, parts[first / kPiece]);
  });
  std::size_t total = 0;
  for (const auto& part : parts) total += part.size();
  std::vector<T> all;
  all.reserve(total);
  for (auto& part : parts) {
    std::move(part.begin(), part.end(), std::back_inserter(all));
    part = {};
  }
  return all;
}

}  // namespace morsel::topology::meshing
