// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>
#include <gtest/gtest.h>

#include "hypertexture_geom/embree/geometry.h"

namespace morsel::geom::test {

// One device and one scene with what a test attaches to it; errors of Embree fail the test.
class EmbreeScene {
 public:
  EmbreeScene() : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {}
  ~EmbreeScene() {
    EXPECT_EQ(rtcGetDeviceError(device_), RTC_ERROR_NONE);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  RTCDevice device() const { return device_; }
  RTCScene scene() const { return scene_; }

  // Attaches and gives up the caller's reference.
  unsigned attach(RTCGeometry geometry) {
    const unsigned id = rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    return id;
  }

  // An instance of another committed scene of the same device; p' = p * m.
  unsigned attach_instance(RTCScene of, const Imath::M44f& m) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, of);
    // Row vectors with the translation last: Embree's column-major 4 x 4 of column vectors.
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, m.x);
    accept_all_rays(geometry);
    rtcCommitGeometry(geometry);
    return attach(geometry);
  }

  void commit() { rtcCommitScene(scene_); }

  RTCRayHit intersect(const RTCRay& ray) const {
    RTCRayHit h = make_ray_hit(ray);
    intersect1(scene_, h);
    return h;
  }
  bool occluded(RTCRay ray) const { return occluded1(scene_, ray); }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

inline bool is_hit(const RTCRayHit& h) { return h.hit.geomID != RTC_INVALID_GEOMETRY_ID; }

inline RTCRay ray_of(const Imath::V3f& o, const Imath::V3f& d, float tnear = 0.0f,
                     float tfar = std::numeric_limits<float>::infinity()) {
  return make_ray(o.x, o.y, o.z, d.x, d.y, d.z, tnear, tfar);
}

}  // namespace morsel::geom::test
