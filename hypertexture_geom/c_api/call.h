// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
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

// The caller's options, with zeros for what its struct does not have yet. Null: all zeros.
template <class T>
T read_options(const T* given, std::size_t least) {
  T options{};
  options.struct_size = sizeof(T);
  if (!given) return options;
  if (given->struct_size < least)
    bad_argument("struct_size is " + std::to_string(given->struct_size) + ", less than the " +
                 std::to_string(least) + " bytes of the struct's first version");
  std::memcpy(&options, given, std::min(given->struct_size, sizeof(T)));
  return options;
}

// Writes as much of `value` as the caller's struct has room for. `value.struct_size` is ignored.
template <class T>
void write_struct(T value, T* out, std::size_t least) {
  if (out->struct_size < least)
    bad_argument("struct_size is " + std::to_string(out->struct_size) + ", less than the " +
                 std::to_string(least) + " bytes of the struct's first version");
  value.struct_size = out->struct_size;
  std::memcpy(out, &value, std::min(out->struct_size, sizeof(T)));
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
