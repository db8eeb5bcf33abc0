// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "topology/scalar_field.h"

// A field on a box as a straight sequence of vector instructions. TapeBuilder writes tapes,
// CompiledField runs them; nothing else needs this header.
namespace morsel::geom {

// What an instruction makes of its operands a and b (registers) and its constants c[0], c[1], ...
// Registers hold a value and a gradient with respect to the tape's input for each point. x is the
// point that the instruction applies at, relative to the centre of its box.
enum class TapeOp : std::uint8_t {
  kConstant,     // c0
  kLinear,       // (c0, c1, c2) . x + c3
  kSquares,      // the sum of the squares of three of those, + c12
  kImpulses,     // sum over `count` blocks of eight impulses: x, y, z, inverse square, weight
  kProcess,      // an octave of sparse convolution whose impulses are hashed at every point
  kPerlin,       // an octave of Perlin noise with tabulated directions
  kPerlinHash,   // the same, its directions hashed at every point
  kOpaque,       // a field evaluated in double precision
  kMultiplyAdd,  // c0 a + c1
  kAdd,          // a + b
  kMultiply,     // a b
  kRoot,         // sqrt(max(a, c0))
  kSmoothAbs,    // sqrt(a^2 + c0^2) - c0
  kSoftSign,     // a / sqrt(a^2 + c0^2)
  kSmoothStep    // 6 t^5 - 15 t^4 + 10 t^3, t = a between 0 and 1
};

struct TapeInstruction {
  static constexpr std::uint16_t kInput = 0xffff;  // in place of point registers: the tape's input

  TapeOp op = TapeOp::kConstant;
  std::uint8_t reserved = 0;  // 0, as the other: files have instructions without padding
  std::uint16_t out = 0, a = 0, b = 0;
  std::uint16_t point[3] = {kInput, kInput, kInput};
  std::uint16_t reserved_too = 0;
  std::uint32_t constants = 0;  // where its constants begin
  std::uint32_t words = 0;      // and its integers
  std::uint32_t count = 0;
};
static_assert(sizeof(TapeInstruction) == 28 &&
              std::has_unique_object_representations_v<TapeInstruction>);

struct OpaqueField {
  const topology::ScalarField* field = nullptr;
  Imath::V3d centre{0.0};
};

template <class T>
struct Tape {
  std::vector<TapeInstruction> instructions;
  std::vector<T> constants;
  std::vector<std::int32_t> words;
  std::vector<OpaqueField> opaque;
  std::uint16_t registers = 0;
  std::uint16_t result = 0;
};

// Impulses in a block of kImpulses.
inline constexpr std::size_t kTapeBlock = 8;

// Layouts that the builder and the interpreter share. kProcess: constants frequency, the box's
// centre in its lattice cell (3), scale; words cell of the centre (3), hash key, impulses per cell.
// kPerlin: constants frequency, shift (3), amplitude; words cells along each axis (3) and then for
// each cell, x fastest, the directions at its eight corners in four bits each, lowest first.
// kPerlinHash: constants likewise; words cell of the centre (3), hash key.

// Evaluates `count` points; coordinates and results are arrays of their own. `gradient` is null for
// values only.
template <class T>
void run_tape(const Tape<T>& tape, const T* const (&x)[3], std::size_t count, T* value,
              T* const* gradient);

}  // namespace morsel::geom
