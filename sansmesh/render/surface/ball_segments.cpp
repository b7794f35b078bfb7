#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/render/surface/ball_segments.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway requires.
#include <embree3/rtcore.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <limits>

#include "sansmesh/error.h"
#include "sansmesh/render/scene/embree_scene.h"
#include "sansmesh/render/surface/ball_segments.h"

#ifndef SANSMESH_BALL_SEGMENTS_ONCE
#define SANSMESH_BALL_SEGMENTS_ONCE
namespace sansmesh::inline v1::detail {

constexpr unsigned kPacket = 8;  // rays

struct Ball {
  float x, y, z, radius;
};

/// Results of a packet of rays so far; Embree passes its first member to the callback.
struct PacketQuery {
  RTCIntersectContext context;
  alignas(32) float entry[kPacket], exit[kPacket], radius[kPacket];
  alignas(32) int ball[kPacket];
};

}  // namespace sansmesh::inline v1::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Intersects one ball with a packet. Embree finds balls in an order that depends on its tree, and thus on the threads
/// that built it. The answer must not: of several balls with the same entry, the one that ends last counts, then the
/// first one. No fused multiply-add: its rounding would differ from that of machines without it.
void CrossBall(const RTCIntersectFunctionNArguments* arguments) {
  const hn::CappedTag<float, kPacket> d;
  const hn::RebindToSigned<decltype(d)> di;
  const Ball& ball = static_cast<const Ball*>(arguments->geometryUserPtr)[arguments->primID];
  auto& query = *reinterpret_cast<PacketQuery*>(arguments->context);
  auto& ray = reinterpret_cast<RTCRayHit8*>(arguments->rayhit)->ray;
  const auto zero = hn::Zero(d), radius = hn::Set(d, ball.radius);
  const auto own = hn::Set(di, static_cast<int>(arguments->primID));
  for (std::size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const auto x = hn::Sub(hn::Set(d, ball.x), hn::Load(d, ray.org_x + i));
    const auto y = hn::Sub(hn::Set(d, ball.y), hn::Load(d, ray.org_y + i));
    const auto z = hn::Sub(hn::Set(d, ball.z), hn::Load(d, ray.org_z + i));
    const auto dx = hn::Load(d, ray.dir_x + i), dy = hn::Load(d, ray.dir_y + i), dz = hn::Load(d, ray.dir_z + i);
    const auto middle = hn::Add(hn::Add(hn::Mul(x, dx), hn::Mul(y, dy)), hn::Mul(z, dz));
    // Not |to centre|² − middle²: from afar this is a difference of large numbers.
    const auto px = hn::Sub(x, hn::Mul(middle, dx)), py = hn::Sub(y, hn::Mul(middle, dy)),
               pz = hn::Sub(z, hn::Mul(middle, dz));
    const auto aside = hn::Add(hn::Add(hn::Mul(px, px), hn::Mul(py, py)), hn::Mul(pz, pz));
    const auto square = hn::Sub(hn::Mul(radius, radius), aside);
    const auto half = hn::Sqrt(hn::Max(square, zero));
    const auto entry = hn::Max(hn::Load(d, ray.tnear + i), hn::Sub(middle, half)), exit = hn::Add(middle, half);
    const auto slack = hn::Add(hn::Mul(hn::Set(d, BallSegments::kSlackOfRadius), radius),
                               hn::Mul(hn::Set(d, BallSegments::kSlackOfDistance), entry));
    const auto best_entry = hn::Load(d, query.entry + i), best_exit = hn::Load(d, query.exit + i);
    const auto best_ball = hn::Load(di, query.ball + i);
    const auto valid = hn::RebindMask(d, hn::Ne(hn::LoadU(di, arguments->valid + i), hn::Zero(di)));
    const auto crosses = hn::And(hn::And(valid, hn::Gt(square, zero)), hn::Gt(exit, hn::Add(entry, slack)));
    const auto later =
        hn::Or(hn::Gt(exit, best_exit), hn::And(hn::Eq(exit, best_exit), hn::RebindMask(d, hn::Lt(own, best_ball))));
    const auto first = hn::Or(hn::Lt(entry, best_entry), hn::And(hn::Eq(entry, best_entry), later));
    const auto better = hn::And(crosses, first);
    if (hn::AllFalse(d, better)) continue;
    hn::Store(hn::IfThenElse(better, entry, best_entry), d, query.entry + i);
    hn::Store(hn::IfThenElse(better, exit, best_exit), d, query.exit + i);
    hn::Store(hn::IfThenElse(better, radius, hn::Load(d, query.radius + i)), d, query.radius + i);
    hn::Store(hn::IfThenElse(hn::RebindMask(di, better), own, best_ball), di, query.ball + i);
    hn::Store(hn::IfThenElse(better, entry, hn::Load(d, ray.tfar + i)), d, ray.tfar + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1 {
namespace detail {
HWY_EXPORT(CrossBall);

void cross_ball(const RTCIntersectFunctionNArguments* arguments) { HWY_DYNAMIC_DISPATCH(CrossBall)(arguments); }
}  // namespace detail

using detail::Ball;
using detail::kPacket;

/// Embree's own spheres do not suffice: from inside they report the end of a ball, but not that the origin is inside.
/// So the balls are a user geometry that returns both ends.
struct BallSegments::State {
  std::vector<Ball> balls;
  detail::EmbreeScene embree;
};

namespace {

void ball_bounds(const RTCBoundsFunctionArguments* arguments) {
  const Ball& ball = static_cast<const Ball*>(arguments->geometryUserPtr)[arguments->primID];
  RTCBounds& b = *arguments->bounds_o;
  b.lower_x = ball.x - ball.radius, b.lower_y = ball.y - ball.radius, b.lower_z = ball.z - ball.radius;
  b.upper_x = ball.x + ball.radius, b.upper_y = ball.y + ball.radius, b.upper_z = ball.z + ball.radius;
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
  if (rtcGetDeviceProperty(s.embree.device(), RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) == 0)
    throw Error("the ray caster needs a processor and an Embree with packets of eight rays (AVX)");
  s.embree.build(static_cast<unsigned>(s.balls.size()), s.balls.data(), ball_bounds, detail::cross_ball);
}

void BallSegments::first(std::span<const SegmentQuery> queries, std::span<BallSegment> segments) const {
  constexpr float kEndless = std::numeric_limits<float>::infinity();
  RTCRayHit8 packet{};
  detail::PacketQuery query;
  rtcInitIntersectContext(&query.context);
  query.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t first = 0; first < queries.size(); first += kPacket) {
    const auto count = static_cast<unsigned>(std::min<std::size_t>(kPacket, queries.size() - first));
    alignas(32) int valid[kPacket];
    for (unsigned i = 0; i < kPacket; ++i) {
      const SegmentQuery& q = queries[first + std::min(i, count - 1)];
      valid[i] = i < count ? -1 : 0;
      packet.ray.org_x[i] = q.origin.x, packet.ray.org_y[i] = q.origin.y, packet.ray.org_z[i] = q.origin.z;
      packet.ray.dir_x[i] = q.direction.x, packet.ray.dir_y[i] = q.direction.y, packet.ray.dir_z[i] = q.direction.z;
      packet.ray.tnear[i] = q.from;
      packet.ray.tfar[i] = q.far;
      packet.ray.mask[i] = 0xFFFFFFFFu;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      query.entry[i] = query.exit[i] = kEndless;
      query.ball[i] = -1;
    }
    rtcIntersect8(valid, state_->embree.scene(), &query.context, &packet);
    for (unsigned i = 0; i < count; ++i)
      segments[first + i] = {query.ball[i] >= 0, query.entry[i], query.exit[i], query.radius[i]};
  }
}

}  // namespace sansmesh::inline v1
#endif
