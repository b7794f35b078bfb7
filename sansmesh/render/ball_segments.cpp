#include "sansmesh/render/ball_segments.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sansmesh/core/error.h"

namespace sansmesh {

/// Spheres of Embree itself will not do: from inside a ball they tell where it ends, but not that one is inside. So the
/// balls are geometry of our own, which hands out both ends.
struct BallSegments::State {
  struct Ball {
    float x, y, z, radius;
  };
  std::vector<Ball> balls;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {

using Ball = float[4];
constexpr unsigned kPacket = 8;

/// Embree hands its first member back to the callbacks.
struct Query {
  RTCIntersectContext context;
  BallSegment* best;       // of the rays of the packet
  unsigned ball[kPacket];  // the ball behind each of them
};

void ball_bounds(const RTCBoundsFunctionArguments* arguments) {
  const float* ball = static_cast<const float*>(arguments->geometryUserPtr) + std::size_t{4} * arguments->primID;
  RTCBounds& b = *arguments->bounds_o;
  b.lower_x = ball[0] - ball[3], b.lower_y = ball[1] - ball[3], b.lower_z = ball[2] - ball[3];
  b.upper_x = ball[0] + ball[3], b.upper_y = ball[1] + ball[3], b.upper_z = ball[2] + ball[3];
}

void cross_ball(const RTCIntersectFunctionNArguments* arguments) {
  const float* ball = static_cast<const float*>(arguments->geometryUserPtr) + std::size_t{4} * arguments->primID;
  auto* query = reinterpret_cast<Query*>(arguments->context);
  const unsigned n = arguments->N;
  RTCRayN* ray = RTCRayHitN_RayN(arguments->rayhit, n);
  RTCHitN* hit = RTCRayHitN_HitN(arguments->rayhit, n);
  const float radius = ball[3];
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    const Vec3f to_center{ball[0] - RTCRayN_org_x(ray, n, i), ball[1] - RTCRayN_org_y(ray, n, i),
                          ball[2] - RTCRayN_org_z(ray, n, i)};
    const Vec3f direction{RTCRayN_dir_x(ray, n, i), RTCRayN_dir_y(ray, n, i), RTCRayN_dir_z(ray, n, i)};
    const float middle = dot(to_center, direction);
    const float square = radius * radius - squared_norm(to_center - middle * direction);
    if (!(square > 0)) continue;
    const float half = std::sqrt(square), from = RTCRayN_tnear(ray, n, i);
    const float entry = std::max(from, middle - half), exit = middle + half;
    if (!(exit > entry + BallSegments::slack(entry, radius)) || entry > RTCRayN_tfar(ray, n, i)) continue;
    const unsigned lane = RTCRayN_id(ray, n, i);
    BallSegment& best = query->best[lane];
    // Embree finds balls in an order that depends on its tree, and that on the threads which built it: the answer must
    // not.
    if (best.found &&
        (entry > best.entry ||
         (entry == best.entry && (exit < best.exit || (exit == best.exit && arguments->primID > query->ball[lane])))))
      continue;
    best = {true, entry, exit, radius};
    query->ball[lane] = arguments->primID;
    RTCRayN_tfar(ray, n, i) = entry;
    RTCHitN_geomID(hit, n, i) = 0;
    RTCHitN_primID(hit, n, i) = arguments->primID;
  }
}

}  // namespace

BallSegments::BallSegments(BallSegments&&) noexcept = default;
BallSegments& BallSegments::operator=(BallSegments&&) noexcept = default;
BallSegments::~BallSegments() = default;

BallSegments::BallSegments(const BallUnion& balls) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.balls.reserve(balls.centers.size());
  for (std::size_t i = 0; i < balls.centers.size(); ++i) {
    const Vec3f& c = balls.centers[i];
    s.balls.push_back({c.x, c.y, c.z, balls.radii[i]});
  }
  s.device = rtcNewDevice(nullptr);
  if (!s.device) throw Error("the ray caster (Embree) cannot start");
  s.scene = rtcNewScene(s.device);
  rtcSetSceneFlags(s.scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(s.balls.size()));
  rtcSetGeometryUserData(geometry, s.balls.data());
  rtcSetGeometryBoundsFunction(geometry, ball_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, cross_ball);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(s.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(s.scene);
  if (rtcGetDeviceError(s.device) != RTC_ERROR_NONE) throw Error("the ray caster (Embree) failed to build its tree");
}

void BallSegments::first(std::span<const SegmentQuery> queries, std::span<BallSegment> segments) const {
  for (std::size_t first = 0; first < queries.size(); first += kPacket) {
    const auto count = static_cast<unsigned>(std::min<std::size_t>(kPacket, queries.size() - first));
    alignas(32) int valid[kPacket] = {};
    RTCRayHit8 packet;
    Query query;
    rtcInitIntersectContext(&query.context);
    query.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    query.best = segments.data() + first;
    for (unsigned i = 0; i < kPacket; ++i) {
      const SegmentQuery& q = queries[first + std::min(i, count - 1)];
      valid[i] = i < count ? -1 : 0;
      if (i < count) segments[first + i] = {};
      packet.ray.org_x[i] = q.origin.x, packet.ray.org_y[i] = q.origin.y, packet.ray.org_z[i] = q.origin.z;
      packet.ray.dir_x[i] = q.direction.x, packet.ray.dir_y[i] = q.direction.y, packet.ray.dir_z[i] = q.direction.z;
      packet.ray.tnear[i] = q.from;
      packet.ray.tfar[i] = q.far;
      packet.ray.time[i] = 0;
      packet.ray.mask[i] = 0xFFFFFFFFu;
      packet.ray.id[i] = i;
      packet.ray.flags[i] = 0;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid, state_->scene, &query.context, &packet);
  }
}

}  // namespace sansmesh
