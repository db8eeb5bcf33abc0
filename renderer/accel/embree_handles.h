// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>

#include "hypertexture_geom/embree/compat.h"

namespace morsel::render {

// Owning handles of Embree's reference-counted objects.
struct ReleaseScene {
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
};
struct ReleaseGeometry {
  void operator()(RTCGeometry g) const { rtcReleaseGeometry(g); }
};
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;
using GeometryHandle = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, ReleaseGeometry>;

// A device that counts its memory and turns its errors into exceptions.
class Device {
 public:
  Device();
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  RTCDevice get() const { return device_; }
  // Throws std::runtime_error when an error was reported since the last call; `doing` says what was
  // being done.
  void check(const std::string& doing) const;
  std::uint64_t bytes() const { return static_cast<std::uint64_t>(bytes_.load()); }

 private:
  RTCDevice device_ = nullptr;
  std::atomic<std::int64_t> bytes_{0};
};

}  // namespace morsel::render
