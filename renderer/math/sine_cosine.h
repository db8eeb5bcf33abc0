// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

namespace morsel::render {

struct SineCosine {
  float sine, cosine;
};

// Of an angle in turns, |turns| <= 1: to 2e-7 beyond what rounding `turns` makes of them, in a
// quarter of the time of std::sin and std::cos and the same on every machine. Taylor series on an
// eighth of a turn to both sides of the nearest quarter.
inline SineCosine sine_cosine_of_turns(float turns) {
  const int quarters = static_cast<int>(4.0f * turns + 8.5f) - 8;  // rounded, whatever the sign
  constexpr float kTurn = 6.28318530717958647692f;
  const float x = kTurn * (turns - 0.25f * static_cast<float>(quarters)), x2 = x * x;
  constexpr float kSine[] = {1.0f / 362880.0f, -1.0f / 5040.0f, 1.0f / 120.0f, -1.0f / 6.0f, 1.0f};
  constexpr float kCosine[] = {1.0f / 40320.0f, -1.0f / 720.0f, 1.0f / 24.0f, -0.5f, 1.0f};
  float sine = 0.0f, cosine = 0.0f;
  for (const float c : kSine) sine = sine * x2 + c;
  for (const float c : kCosine) cosine = cosine * x2 + c;
  sine *= x;
  if ((quarters & 1) != 0) {
    std::swap(sine, cosine);
    cosine = -cosine;
  }
  if ((quarters & 2) != 0) {
    sine = -sine;
    cosine = -cosine;
  }
  return {sine, cosine};
}

}  // namespace morsel::render
