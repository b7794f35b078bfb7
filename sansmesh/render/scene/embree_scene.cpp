#include "sansmesh/render/scene/embree_scene.h"

#include <embree3/rtcore.h>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::detail {

EmbreeScene::EmbreeScene() : device_(rtcNewDevice(nullptr)) {
  if (!device_) throw Error("the ray caster (Embree) cannot start");
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void EmbreeScene::build(RTCGeometry geometry) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  lend_threads([&] { rtcCommitScene(scene_); });
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw Error("the ray caster (Embree) failed to build its tree");
}

void EmbreeScene::build(unsigned count, void* data, RTCBoundsFunction bounds, RTCIntersectFunctionN intersect) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, count);
  rtcSetGeometryUserData(geometry, data);
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  build(geometry);
}

}  // namespace sansmesh::inline v1::detail
