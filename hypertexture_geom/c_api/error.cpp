// SPDX-License-Identifier: Apache-2.0
#include <new>
#include <stdexcept>

#include "hypertexture_geom/c_api/call.h"
#include "hypertexture_geom/embree/compat.h"
#include "hypertexture_geom/params/json_reader.h"
#include "topology/cache_file.h"

namespace morsel::c_api {
namespace {

struct LastError {
  MorselResult result = MORSEL_OK;
  std::string text;
  std::string copy;  // of a handle's text, for the caller to read
};
LastError& last_error() {
  thread_local LastError error;
  return error;
}

MorselResult note(const void* handle, MorselResult result, const char* text) noexcept {
  try {
    LastError& e = last_error();
    e.result = result;
    e.text = text;
    if (Handle* h = alive(handle)) {
      const std::lock_guard lock(h->error_mutex);
      h->error_text = text;
    }
  } catch (...) {  // no memory for the text: the code is all there is
  }
  return result;
}

}  // namespace

MorselResult note_exception(const void* handle) noexcept {
  try {
    throw;
  } catch (const ApiError& e) {
    return note(handle, e.result, e.what());
  } catch (const params::InputError& e) {
    return note(handle, MORSEL_ERROR_INVALID_INPUT, e.what());
  } catch (const topology::CacheError& e) {
    return note(handle, MORSEL_ERROR_FILE, e.what());
  } catch (const topology::Cancelled& e) {
    return note(handle, MORSEL_ERROR_CANCELLED, e.what());
  } catch (const std::bad_alloc&) {
    return note(handle, MORSEL_ERROR_OUT_OF_MEMORY, "out of memory");
  } catch (const std::length_error& e) {
    return note(handle, MORSEL_ERROR_OUT_OF_MEMORY, e.what());
  } catch (const std::invalid_argument& e) {
    return note(handle, MORSEL_ERROR_INVALID_ARGUMENT, e.what());
  } catch (const std::exception& e) {
    return note(handle, MORSEL_ERROR_INTERNAL, e.what());
  } catch (...) {
    return note(handle, MORSEL_ERROR_INTERNAL, "unknown exception");
  }
}

}  // namespace morsel::c_api

using morsel::c_api::last_error;

uint32_t morsel_api_version(void) {
  return (static_cast<uint32_t>(MORSEL_API_VERSION_MAJOR) << 16) |
         static_cast<uint32_t>(MORSEL_API_VERSION_MINOR);
}

uint32_t morsel_embree_version(void) { return RTC_VERSION; }

const char* morsel_version_text(void) {
  return "Morsel " MORSEL_VERSION_TEXT ", Embree " RTC_VERSION_STRING;
}

const char* morsel_result_name(MorselResult result) {
  switch (result) {
    case MORSEL_OK:
      return "MORSEL_OK";
    case MORSEL_ERROR_INVALID_HANDLE:
      return "MORSEL_ERROR_INVALID_HANDLE";
    case MORSEL_ERROR_INVALID_ARGUMENT:
      return "MORSEL_ERROR_INVALID_ARGUMENT";
    case MORSEL_ERROR_INVALID_INPUT:
      return "MORSEL_ERROR_INVALID_INPUT";
    case MORSEL_ERROR_FILE:
      return "MORSEL_ERROR_FILE";
    case MORSEL_ERROR_CANCELLED:
      return "MORSEL_ERROR_CANCELLED";
    case MORSEL_ERROR_OUT_OF_MEMORY:
      return "MORSEL_ERROR_OUT_OF_MEMORY";
    case MORSEL_ERROR_EMBREE:
      return "MORSEL_ERROR_EMBREE";
    case MORSEL_ERROR_INTERNAL:
      return "MORSEL_ERROR_INTERNAL";
    default:
      return "unknown result";
  }
}

MorselResult morsel_last_error(void) {
  try {
    return last_error().result;
  } catch (...) {
    return MORSEL_ERROR_OUT_OF_MEMORY;
  }
}

const char* morsel_last_error_text(void) {
  try {
    return last_error().text.c_str();
  } catch (...) {
    return "";
  }
}

const char* morsel_object_error_text(const void* handle) {
  try {
    morsel::c_api::Handle* h = morsel::c_api::alive(handle);
    if (!h) return "";
    const std::lock_guard lock(h->error_mutex);
    return (last_error().copy = h->error_text).c_str();
  } catch (...) {
    return "";
  }
}
