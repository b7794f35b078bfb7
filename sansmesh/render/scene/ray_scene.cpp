#include "sansmesh/render/scene/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/render/scene/embree_scene.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kPacket = 16;  // rays per packet

/// Results of a query so far, for each of its rays by id; Embree passes its first member to the filter.
struct Query {
  RTCIntersectContext context;
  std::array<float, kPacket> distance;
  std::array<unsigned, kPacket> primitive;
  std::vector<RayCrossing>* all = nullptr;  // if set, receives every hit of the single ray, which continues

  Query() {
    rtcInitIntersectContext(&context);
    distance.fill(std::numeric_limits<float>::infinity());
    primitive.fill(RTC_INVALID_GEOMETRY_ID);
  }
};

/// Among hits at the same distance the lowest primitive counts: their order depends on the tree, and the tree on the
/// threads that built it.
void settle_ties(const RTCFilterFunctionNArguments* arguments) {
  auto* query = reinterpret_cast<Query*>(arguments->context);
  RTCRayN* ray = arguments->ray;
  RTCHitN* hit = arguments->hit;
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    const float distance = RTCRayN_tfar(ray, n, i);
    const unsigned primitive = RTCHitN_primID(hit, n, i);
    if (query->all) {
      const float along = RTCRayN_dir_x(ray, n, i) * RTCHitN_Ng_x(hit, n, i) +
                          RTCRayN_dir_y(ray, n, i) * RTCHitN_Ng_y(hit, n, i) +
                          RTCRayN_dir_z(ray, n, i) * RTCHitN_Ng_z(hit, n, i);
      query->all->push_back({distance, primitive, along < 0});
      arguments->valid[i] = 0;
      continue;
    }
    const std::size_t slot = RTCRayN_id(ray, n, i);
    if (distance == query->distance[slot] && primitive > query->primitive[slot]) {
      arguments->valid[i] = 0;
      continue;
    }
    query->distance[slot] = distance;
    query->primitive[slot] = primitive;
  }
}

}  // namespace

/// The scene and its single geometry.
struct RayScene::State {
  detail::EmbreeScene embree;
  RTCGeometry geometry = nullptr;

  explicit State(RTCGeometryType type) : geometry(rtcNewGeometry(embree.device(), type)) {
    rtcSetGeometryIntersectFilterFunction(geometry, settle_ties);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (geometry) rtcReleaseGeometry(geometry);
  }

  /// Embree's own memory: it reads slightly beyond the end, which vectors need not permit.
  template <class T>
  T* buffer(RTCBufferType type, RTCFormat format, std::size_t count) {
    void* data = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), count);
    if (!data) throw Error("not enough memory for the ray caster");
    return static_cast<T*>(data);
  }
};

namespace {

struct Ball {
  float x, y, z, radius;
};

template <class Radius>
void write_balls(Ball* balls, std::span<const Vec3f> centers, const Radius& radius) {
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
  state->embree.build(std::exchange(state->geometry, nullptr));
  return RayScene(std::move(state));
}

template <class Radius>
std::unique_ptr<RayScene::State> RayScene::make_balls(std::span<const Vec3f> centers, std::span<const Vec3f> normals,
                                                      const Radius& radius) {
  const bool flat = !normals.empty();
  auto state = std::make_unique<State>(flat ? RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT : RTC_GEOMETRY_TYPE_SPHERE_POINT);
  write_balls(state->template buffer<Ball>(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, centers.size()), centers, radius);
  if (flat)
    std::copy(normals.begin(), normals.end(),
              state->template buffer<Vec3f>(RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, normals.size()));
  state->embree.build(std::exchange(state->geometry, nullptr));
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
  RTCRayHit found{};
  found.ray = make_ray(origin, direction, std::numeric_limits<float>::infinity());
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->embree.scene(), &query.context, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return RayHit{found.ray.tfar, normalized(Vec3f{found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z}), found.hit.primID,
                found.hit.u, found.hit.v};
}

void RayScene::closest(std::span<const Vec3f> origins, std::span<const Vec3f> directions, std::span<const float> beyond,
                       std::span<const float> until, std::span<std::optional<RayHit>> hits) const {
  for (std::size_t first = 0; first < directions.size(); first += kPacket) {
    const std::size_t n = std::min(kPacket, directions.size() - first);
    Query query;
    query.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RTCRayHit16 packet;
    alignas(64) std::array<int, kPacket> valid{};
    for (std::size_t i = 0; i < kPacket; ++i) {
      const Vec3f d = i < n ? directions[first + i] : Vec3f{};
      const Vec3f& origin = origins[origins.size() == 1 || i >= n ? 0 : first + i];
      valid[i] = i < n ? -1 : 0;
      packet.ray.org_x[i] = origin.x, packet.ray.org_y[i] = origin.y, packet.ray.org_z[i] = origin.z;
      packet.ray.dir_x[i] = d.x, packet.ray.dir_y[i] = d.y, packet.ray.dir_z[i] = d.z;
      packet.ray.tnear[i] = i < n && !beyond.empty() ? beyond[first + i] : 0;
      packet.ray.tfar[i] = i < n && !until.empty() ? until[first + i] : std::numeric_limits<float>::infinity();
      packet.ray.time[i] = 0;
      packet.ray.mask[i] = 0xFFFFFFFFu;
      packet.ray.id[i] = static_cast<unsigned>(i);
      packet.ray.flags[i] = 0;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect16(valid.data(), state_->embree.scene(), &query.context, &packet);
    for (std::size_t i = 0; i < n; ++i) {
      std::optional<RayHit>& hit = hits[first + i];
      hit.reset();
      if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      hit = RayHit{packet.ray.tfar[i], normalized(Vec3f{packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]}),
                   packet.hit.primID[i], packet.hit.u[i], packet.hit.v[i]};
    }
  }
}

void RayScene::crossings(const Vec3f& origin, const Vec3f& direction, float length,
                         std::vector<RayCrossing>& found) const {
  found.clear();
  Query query;
  query.all = &found;
  RTCRayHit hit{};
  hit.ray = make_ray(origin, direction, length);
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->embree.scene(), &query.context, &hit);
  std::sort(found.begin(), found.end(), [](const RayCrossing& a, const RayCrossing& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.primitive < b.primitive;
  });
}

bool RayScene::blocked(const Vec3f& origin, const Vec3f& direction, float length, float near) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = make_ray(origin, direction, length);
  ray.tnear = near;
  rtcOccluded1(state_->embree.scene(), &context, &ray);
  return ray.tfar < 0;
}

}  // namespace sansmesh::inline v1
