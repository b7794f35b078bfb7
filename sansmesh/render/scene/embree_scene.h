// Ownership of an Embree device and scene.
#pragma once

struct RTCDeviceTy;
struct RTCSceneTy;
struct RTCGeometryTy;
struct RTCBoundsFunctionArguments;
struct RTCIntersectFunctionNArguments;

namespace sansmesh::inline v1::detail {

/// A device with a robust scene.
class EmbreeScene {
 public:
  /// Throws Error.
  EmbreeScene();
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  RTCDeviceTy* device() const { return device_; }
  RTCSceneTy* scene() const { return scene_; }

  /// Builds the tree of a geometry and takes it over. Throws Error.
  void build(RTCGeometryTy* geometry);
  /// The same for `count` primitives defined by functions of their `data`.
  void build(unsigned count, void* data, void (*bounds)(const RTCBoundsFunctionArguments*),
             void (*intersect)(const RTCIntersectFunctionNArguments*));

 private:
  RTCDeviceTy* device_ = nullptr;
  RTCSceneTy* scene_ = nullptr;
};

}  // namespace sansmesh::inline v1::detail
