// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/c_api/handle.h"

#include <deque>

namespace morsel::c_api {
namespace {

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::kField:
      return "field";
    case Kind::kTopology:
      return "topology";
    case Kind::kGeometry:
      return "geometry";
    case Kind::kQuery:
      return "query";
  }
  return "";
}

[[noreturn]] void invalid(Kind kind, const std::string& why) {
  throw ApiError(MORSEL_ERROR_INVALID_HANDLE, std::string(name_of(kind)) + " handle: " + why);
}

Handle& of_kind(void* handle, Kind kind) {
  if (!handle) invalid(kind, "it is NULL");
  auto& h = *static_cast<Handle*>(handle);
  if (h.kind != kind) invalid(kind, std::string("it is a ") + name_of(h.kind));
  return h;
}

constexpr char kReleased[] = "it was released already";

}  // namespace

Handle* new_handle(Kind kind, std::shared_ptr<void> object) {
  // Never destroyed: handles may be used in destructors of static objects.
  static std::mutex mutex;
  static auto& handles = *new std::deque<Handle>;
  const std::lock_guard lock(mutex);
  return &handles.emplace_back(kind, std::move(object));
}

void retain(void* handle, Kind kind) {
  Handle& h = of_kind(handle, kind);
  std::uint32_t count = h.references.load();
  do {
    if (count == 0) invalid(kind, kReleased);
    if (count == ~std::uint32_t{0})
      throw ApiError(MORSEL_ERROR_INVALID_ARGUMENT, "the handle has 2^32 - 1 references");
  } while (!h.references.compare_exchange_weak(count, count + 1));
}

void release(void* handle, Kind kind) {
  Handle& h = of_kind(handle, kind);
  std::uint32_t count = h.references.load();
  do {
    if (count == 0) invalid(kind, kReleased);
  } while (!h.references.compare_exchange_weak(count, count - 1));
  if (count > 1) return;
  h.object.reset();
  const std::lock_guard lock(h.error_mutex);
  std::string().swap(h.error_text);
}

Handle& checked(const void* handle, Kind kind) {
  Handle& h = of_kind(const_cast<void*>(handle), kind);
  if (h.references.load(std::memory_order_relaxed) == 0) invalid(kind, kReleased);
  return h;
}

Handle* alive(const void* handle) {
  auto* h = static_cast<Handle*>(const_cast<void*>(handle));
  return h && h->references.load(std::memory_order_relaxed) != 0 ? h : nullptr;
}

}  // namespace morsel::c_api
