// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <string_view>

namespace morsel::topology {

// Index of a set of maxima (one per component of S) that is not known.
inline constexpr std::uint32_t kNoSet = 0xffffffffu;

// By the signs of the Hessian's eigenvalues (negative ones: 3, 2, 1, 0). Degenerate: a sign is not
// certain.
enum class CriticalType : std::uint8_t {
  kMaximum = 0,
  kSaddle2 = 1,
  kSaddle1 = 2,
  kMinimum = 3,
  kDegenerate = 4,
};

constexpr std::string_view to_string(CriticalType type) {
  constexpr std::string_view kNames[] = {"maximum", "2-saddle", "1-saddle", "minimum",
                                         "degenerate"};
  return kNames[static_cast<int>(type)];
}

// A zero of grad F with F > 0, proved to exist.
struct CriticalPoint {
  Imath::V3d position{0.0};
  double radius = 0.0;  // the true point is within this distance of `position` along every axis
  double value = 0.0;   // F there
  Imath::V3d eigenvalues{0.0};  // of the Hessian, ascending
  Imath::V3d axis{0.0};         // unit eigenvector of the largest eigenvalue: v3 of the paper
  CriticalType type = CriticalType::kDegenerate;
  // Maxima: ascent from within this distance ends at this maximum (certified; see basin.h). 0: no
  // basin could be certified.
  double basin = 0.0;
  std::uint32_t set = kNoSet;  // of MorseComplex::sets
};

}  // namespace morsel::topology
