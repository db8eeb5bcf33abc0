// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "hypertexture_geom/include/morsel/hypertexture_geom.h"

// What stands behind a handle of the C API. Headers of handles are never freed or used again (about
// 150 bytes each), so that one that was released is recognised for as long as the process lives.
namespace morsel::c_api {

enum class Kind : std::uint32_t { kField, kTopology, kGeometry, kQuery };

struct Handle {
  Handle(Kind k, std::shared_ptr<void> o) : kind(k), object(std::move(o)) {}

  const Kind kind;
  std::atomic<std::uint32_t> references{1};
  std::shared_ptr<void> object;
  std::mutex error_mutex;
  std::string error_text;  // of the last failed call
};

// An error of the API itself; other exceptions are given their code in error.cpp.
struct ApiError : std::runtime_error {
  ApiError(MorselResult r, const std::string& text) : std::runtime_error(text), result(r) {}
  MorselResult result;
};

// A new handle with one reference.
Handle* new_handle(Kind kind, std::shared_ptr<void> object);

// Adds or gives back a reference; the last one destroys the object. Throws ApiError.
void retain(void* handle, Kind kind);
void release(void* handle, Kind kind);

// The handle if it is alive and of that kind. Throws ApiError.
Handle& checked(const void* handle, Kind kind);
// The handle if it is one and alive, else null.
Handle* alive(const void* handle);

// What a handle stands for. `T::kKind` says which.
template <class T>
T& object_of(const void* handle) {
  return *static_cast<T*>(checked(handle, T::kKind).object.get());
}
template <class T>
std::shared_ptr<T> shared_object_of(const void* handle) {
  return std::static_pointer_cast<T>(checked(handle, T::kKind).object);
}
template <class T, class H>
void give(std::shared_ptr<T> object, H* out) {
  *out = reinterpret_cast<H>(new_handle(T::kKind, std::move(object)));
}

}  // namespace morsel::c_api
