#include "sansmesh/render/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh {
namespace {

/// What a query has found so far; Embree hands its first member back to the filter.
struct Query {
  RTCIntersectContext context;
  float distance = std::numeric_limits<float>::infinity();
  unsigned primitive = RTC_INVALID_GEOMETRY_ID;
  std::vector<RayCrossing>* all = nullptr;  // where wanted, every hit, and the ray goes on
};

/// Of hits at the same distance the lowest primitive counts: which one comes last depends on the tree, and the tree on
/// the threads that built it.
void settle_ties(const RTCFilterFunctionNArguments* arguments) {
  auto* query = reinterpret_cast<Query*>(arguments->context);
  const float distance = RTCRayN_tfar(arguments->ray, arguments->N, 0);
  const unsigned primitive = RTCHitN_primID(arguments->hit, arguments->N, 0);
  if (query->all) {
    RTCRayN* ray = arguments->ray;
    RTCHitN* hit = arguments->hit;
    const unsigned n = arguments->N;
    const float along = RTCRayN_dir_x(ray, n, 0) * RTCHitN_Ng_x(hit, n, 0) +
                        RTCRayN_dir_y(ray, n, 0) * RTCHitN_Ng_y(hit, n, 0) +
                        RTCRayN_dir_z(ray, n, 0) * RTCHitN_Ng_z(hit, n, 0);
    query->all->push_back({distance, primitive, along < 0});
    arguments->valid[0] = 0;
    return;
  }
  if (distance == query->distance && primitive > query->primitive) {
    arguments->valid[0] = 0;
    return;
  }
  query->distance = distance;
  query->primitive = primitive;
}

}  // namespace

/// The device, the scene and its one geometry.
struct RayScene::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;

  explicit State(RTCGeometryType type) {
    device = rtcNewDevice(nullptr);
    if (!device) throw Error("the ray caster (Embree) cannot start");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    geometry = rtcNewGeometry(device, type);
    rtcSetGeometryIntersectFilterFunction(geometry, settle_ties);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }

  /// Embree's own memory: it reads a little beyond the end, which vectors need not allow.
  template <class T>
  T* buffer(RTCBufferType type, RTCFormat format, std::size_t count) {
    void* data = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), count);
    if (!data) throw Error("not enough memory for the ray caster");
    return static_cast<T*>(data);
  }
  void commit() {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    lend_threads([&] { rtcCommitScene(scene); });
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw Error("the ray caster (Embree) failed to build its tree");
  }
};

namespace {

struct Ball {
  float x, y, z, radius;
};

template <class Radius>
void place_balls(Ball* balls, std::span<const Vec3f> centers, const Radius& radius) {
  for (std::size_t i = 0; i < centers.size(); ++i) balls[i] = {centers[i].x, centers[i].y, centers[i].z, radius(i)};
}

}  // namespace

RayScene::RayScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

RayScene RayScene::triangles(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  auto state = std::make_unique<State>(RTC_GEOMETRY_TYPE_TRIANGLE);
  std::copy(vertices.begin(), vertices.end(),
            state->buffer<Vec3f>(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, vertices.size()));
  std::copy(triangles.begin(), triangles.end(),
            state->buffer<Triangle>(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, triangles.size()));
  state->commit();
  return RayScene(std::move(state));
}

template <class Radius>
std::unique_ptr<RayScene::State> RayScene::make_balls(std::span<const Vec3f> centers, std::span<const Vec3f> normals,
                                                      const Radius& radius) {
  const bool flat = !normals.empty();
  auto state = std::make_unique<State>(flat ? RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT : RTC_GEOMETRY_TYPE_SPHERE_POINT);
  place_balls(state->template buffer<Ball>(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, centers.size()), centers, radius);
  if (flat)
    std::copy(normals.begin(), normals.end(),
              state->template buffer<Vec3f>(RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, normals.size()));
  state->commit();
  return state;
}

RayScene RayScene::balls(std::span<const Vec3f> centers, float radius) {
  return RayScene(make_balls(centers, {}, [=](std::size_t) { return radius; }));
}

RayScene RayScene::balls(std::span<const Vec3f> centers, std::span<const float> radii) {
  return RayScene(make_balls(centers, {}, [=](std::size_t i) { return radii[i]; }));
}

RayScene RayScene::discs(std::span<const Vec3f> centers, std::span<const Vec3f> normals, float radius) {
  return RayScene(make_balls(centers, normals, [=](std::size_t) { return radius; }));
}

RayScene RayScene::discs(std::span<const Vec3f> centers, std::span<const Vec3f> normals, std::span<const float> radii) {
  return RayScene(make_balls(centers, normals, [=](std::size_t i) { return radii[i]; }));
}

namespace {

RTCRay make_ray(const Vec3f& origin, const Vec3f& direction, float length) {
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tnear = 0;
  ray.tfar = length;
  ray.mask = 0xFFFFFFFFu;
  return ray;
}

}  // namespace

std::optional<RayHit> RayScene::closest(const Vec3f& origin, const Vec3f& direction) const {
  Query query;
  rtcInitIntersectContext(&query.context);
  RTCRayHit found{};
  found.ray = make_ray(origin, direction, std::numeric_limits<float>::infinity());
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->scene, &query.context, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return RayHit{found.ray.tfar, normalized(Vec3f{found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z}), found.hit.primID,
                found.hit.u, found.hit.v};
}

void RayScene::crossings(const Vec3f& origin, const Vec3f& direction, std::vector<RayCrossing>& found) const {
  found.clear();
  Query query;
  query.all = &found;
  rtcInitIntersectContext(&query.context);
  RTCRayHit hit{};
  hit.ray = make_ray(origin, direction, std::numeric_limits<float>::infinity());
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->scene, &query.context, &hit);
  std::sort(found.begin(), found.end(), [](const RayCrossing& a, const RayCrossing& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.primitive < b.primitive;
  });
}

bool RayScene::blocked(const Vec3f& origin, const Vec3f& direction, float length) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = make_ray(origin, direction, length);
  rtcOccluded1(state_->scene, &context, &ray);
  return ray.tfar < 0;
}

}  // namespace sansmesh
