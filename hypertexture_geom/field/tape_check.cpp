// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/tape_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hypertexture_geom/field/perlin_lattice.h"

namespace morsel::geom {
namespace {

// What an instruction reads, besides the point and the words of a table.
struct Needs {
  int operands = 0;
  std::uint64_t constants = 0, words = 0;
};

// False: not for tapes in double precision, or not at all.
bool needs_of(const TapeInstruction& in, Needs& needs) {
  switch (in.op) {
    case TapeOp::kConstant:
      needs = {0, 1, 0};
      return true;
    case TapeOp::kLinear:
      needs = {0, 4, 0};
      return true;
    case TapeOp::kSquares:
      needs = {0, 13, 0};
      return true;
    case TapeOp::kImpulses:
      needs = {0, std::uint64_t{5} * kTapeBlock * in.count, 0};
      return true;
    case TapeOp::kPerlin:
      needs = {0, 5, 3};
      return true;
    case TapeOp::kMultiplyAdd:
      needs = {1, 2, 0};
      return true;
    case TapeOp::kAdd:
    case TapeOp::kMultiply:
      needs = {2, 0, 0};
      return true;
    case TapeOp::kRoot:
    case TapeOp::kSmoothAbs:
    case TapeOp::kSoftSign:
      needs = {1, 1, 0};
      return true;
    case TapeOp::kSmoothStep:
      needs = {1, 0, 0};
      return true;
    case TapeOp::kProcess:
    case TapeOp::kPerlinHash:
    case TapeOp::kOpaque:
      break;
  }
  return false;
}

// Whether the table of directions lies within `room` words and names none that there is not.
bool is_perlin_table(const std::int32_t* words, std::uint64_t room) {
  constexpr std::uint64_t kMostCells = 1u << 30;  // are numbered by an int
  std::uint64_t cells = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (words[axis] < 1) return false;
    cells *= static_cast<std::uint64_t>(words[axis]);
    if (cells > std::min(room - 3, kMostCells)) return false;
  }
  return std::all_of(words + 3, words + 3 + cells, [](std::int32_t cell) {
    for (int corner = 0; corner < 8; ++corner)
      if (((static_cast<std::uint32_t>(cell) >> (4 * corner)) & 15u) >= kPerlinDirections)
        return false;
    return true;
  });
}

}  // namespace

std::string problem_of(const Tape<double>& tape) {
  if (!tape.opaque.empty()) return "refers to fields";
  const auto finite = [](double c) { return std::isfinite(c); };
  if (!std::all_of(tape.constants.begin(), tape.constants.end(), finite))
    return "a constant is not finite";
  // Each has an instruction that writes it first.
  if (tape.registers > tape.instructions.size()) return "more registers than instructions";
  std::vector<bool> written(tape.registers, false);
  const auto readable = [&](std::uint16_t r) { return r < written.size() && written[r]; };
  for (std::size_t i = 0; i < tape.instructions.size(); ++i) {
    const TapeInstruction& in = tape.instructions[i];
    const auto problem = [&](const char* what) {
      return fmt::format("instruction {} (operation {}): {}", i, static_cast<int>(in.op), what);
    };
    if (in.reserved != 0 || in.reserved_too != 0) return problem("a reserved number is not 0");
    Needs needs;
    if (!needs_of(in, needs)) return problem("there is no such operation");
    if (needs.constants > tape.constants.size() ||
        in.constants > tape.constants.size() - needs.constants)
      return problem("its constants are beyond the end");
    if (needs.words > tape.words.size() || in.words > tape.words.size() - needs.words)
      return problem("its integers are beyond the end");
    if (in.op == TapeOp::kPerlin &&
        !is_perlin_table(tape.words.data() + in.words, tape.words.size() - in.words))
      return problem("its table of directions is none");
    if ((needs.operands > 0 && !readable(in.a)) || (needs.operands > 1 && !readable(in.b)))
      return problem("it reads what was not computed");
    const bool at_input = in.point[0] == TapeInstruction::kInput;
    for (const std::uint16_t p : in.point)
      if (needs.operands == 0 && (at_input ? p != TapeInstruction::kInput : !readable(p)))
        return problem("it applies where nothing was computed");
    if (in.out >= tape.registers) return problem("there is no such register");
    written[in.out] = true;
  }
  return readable(tape.result) ? "" : "its result is not computed";
}

}  // namespace morsel::geom
