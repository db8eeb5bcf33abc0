// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "hypertexture_geom/c_api/handle.h"

// What every function of the C API is made with: exceptions end here, structs are copied by the
// caller's size.
namespace morsel::c_api {

// Notes the exception in flight for the thread and, if it is alive, the handle; returns its code.
MorselResult note_exception(const void* handle) noexcept;

// Runs `body`; MORSEL_OK unless it throws. `handle` is the one that the call is about, or null.
template <class Body>
MorselResult call(const void* handle, const Body& body) noexcept {
  try {
    body();
    return MORSEL_OK;
  } catch (...) {
    return note_exception(handle);
  }
}

[[noreturn]] inline void bad_argument(const std::string& text) {
  throw ApiError(MORSEL_ERROR_INVALID_ARGUMENT, text);
}

inline void require(const void* pointer, const char* name) {
  if (!pointer) bad_argument(std::string(name) + " is NULL");
}

// Structs of the caller's, which may be of an older or a newer version than ours. A size below that
// of the first version, or that no struct has, is what memory holds that nobody set.
inline constexpr std::size_t kMostStructBytes = 4096;
inline void require_struct_size(std::size_t size, std::size_t least, const char* type,
                                const char* argument) {
  if (size >= least && size <= kMostStructBytes && size % alignof(double) == 0) return;
  bad_argument(std::string(type) + ": " + argument + " is " + std::to_string(size) +
               ", not a multiple of 8 from the " + std::to_string(least) +
               " bytes of the struct's first version to " + std::to_string(kMostStructBytes));
}

// The caller's options, with zeros for what its struct does not have yet. Null: all zeros. What a
// newer struct has beyond ours must be zero: the caller asks for nothing that we do not know.
template <class T>
T read_options(const T* given, std::size_t least, const char* type) {
  T options{};
  options.struct_size = sizeof(T);
  if (!given) return options;
  const std::size_t size = given->struct_size;
  require_struct_size(size, least, type, "struct_size");
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  for (std::size_t i = sizeof(T); i < size; ++i)
    if (bytes[i] != 0)
      bad_argument(std::string(type) + ": the byte at offset " + std::to_string(i) +
                   " is not 0, but this library knows the struct's first " +
                   std::to_string(sizeof(T)) + " bytes only: it is too old for what is asked");
  std::memcpy(&options, given, std::min(size, sizeof(T)));
  return options;
}

inline void require_zero(std::uint32_t reserved, const char* name) {
  if (reserved != 0)
    bad_argument(std::string(name) + " is " + std::to_string(reserved) + "; it must be 0");
}

// Writes as much of `value` as there is room for, and zeros to the rest of `size` bytes: what a
// newer caller's struct has and we do not know is never left to chance.
template <class T>
void write_entry(const T& value, void* out, std::size_t size) {
  const std::size_t known = std::min(size, sizeof(T));
  std::memcpy(out, &value, known);
  std::memset(static_cast<char*>(out) + known, 0, size - known);
}

// The same for a struct that says its size itself; value.struct_size is ignored.
template <class T>
void write_struct(T value, T* out, std::size_t least, const char* type) {
  const std::size_t size = out->struct_size;
  require_struct_size(size, least, type, "struct_size");
  value.struct_size = size;
  write_entry(value, out, size);
}

inline void require_threads(std::uint32_t threads) {
  constexpr std::uint32_t kMost = 4096;
  if (threads > kMost)
    bad_argument("threads is " + std::to_string(threads) + ", more than " + std::to_string(kMost));
}

// Coordinates that any field can be evaluated at; lattices of noise are numbered by integers.
inline constexpr double kLargestCoordinate = 1e9;
template <class T>
void require_point(const T* x, const char* name) {
  for (int i = 0; i < 3; ++i)
    if (!(std::abs(static_cast<double>(x[i])) <= kLargestCoordinate))
      bad_argument(std::string(name) + ": coordinate " + std::to_string(i) + " is " +
                   std::to_string(x[i]) + ", not within +-1e9");
}

template <class V>
void store(const V& v, double (&out)[3]) {
  for (int i = 0; i < 3; ++i) out[i] = v[i];
}
template <class V>
void store(const V& v, float (&out)[3]) {
  for (int i = 0; i < 3; ++i) out[i] = v[i];
}

}  // namespace morsel::c_api
