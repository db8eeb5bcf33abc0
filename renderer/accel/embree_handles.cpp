// SPDX-License-Identifier: Apache-2.0
#include "renderer/accel/embree_handles.h"

#include <sys/types.h>

#include <stdexcept>

namespace morsel::render {
namespace {

const char* name_of(RTCError error) {
  switch (error) {
    case RTC_ERROR_NONE:
      return "no error";
    case RTC_ERROR_INVALID_ARGUMENT:
      return "invalid argument";
    case RTC_ERROR_INVALID_OPERATION:
      return "invalid operation";
    case RTC_ERROR_OUT_OF_MEMORY:
      return "out of memory";
    case RTC_ERROR_UNSUPPORTED_CPU:
      return "unsupported CPU";
    case RTC_ERROR_CANCELLED:
      return "cancelled";
    default:
      return "unknown error";
  }
}

}  // namespace

Device::Device() : device_(rtcNewDevice(nullptr)) {
  if (device_ == nullptr)
    throw std::runtime_error(std::string("Embree: no device: ") +
                             name_of(rtcGetDeviceError(nullptr)));
  rtcSetDeviceMemoryMonitorFunction(
      device_,
      [](void* self, ssize_t bytes, bool /*post*/) {
        static_cast<Device*>(self)->bytes_ += bytes;
        return true;
      },
      this);
}

Device::~Device() {
  // Scenes that others retain keep Embree's device, which would go on to count here.
  rtcSetDeviceMemoryMonitorFunction(device_, nullptr, nullptr);
  rtcReleaseDevice(device_);
}

void Device::check(const std::string& doing) const {
  const RTCError error = rtcGetDeviceError(device_);
  if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree: " + doing + ": " + name_of(error));
}

}  // namespace morsel::render
