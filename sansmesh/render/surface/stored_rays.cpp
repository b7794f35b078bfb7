#include "sansmesh/render/surface/stored_rays.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sansmesh/render/scene/embree_scene.h"
#include "sansmesh/render/surface/ball_segments.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Limit of projections in one ball: the sources report two to three.
constexpr int kMostProjections = 8;

/// The roots of height + slope t + square t² = 0 in ascending order; NaN if there are none.
std::array<double, 2> roots_of(double square, double slope, double height) {
  const double discriminant = slope * slope - 4 * square * height;
  if (discriminant < 0) return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  const double q = slope + std::copysign(std::sqrt(discriminant), slope);
  const double near = -2 * height / q, far = -q / (2 * square);  // far: infinite for planes
  return near < far ? std::array{near, far} : std::array{far, near};
}

/// Height over the local approximation at the foot along x + t · direction, as a polynomial of t.
struct RayHeight {
  double square, slope, height;

  RayHeight(const FootPoint& foot, const Vec3& x, const Vec3& direction) {
    Vec3 t, b;
    tangent_frame(foot.normal, t, b);
    const Vec3 q = x - foot.position;
    const double u = dot(q, t), v = dot(q, b), w = dot(q, foot.normal);
    const double du = dot(direction, t), dv = dot(direction, b), dw = dot(direction, foot.normal);
    square = 0.5 * (foot.xx * du * du + 2 * foot.xy * du * dv + foot.yy * dv * dv);
    slope = foot.xx * u * du + foot.xy * (u * dv + v * du) + foot.yy * v * dv - dw;
    height = 0.5 * (foot.xx * u * u + 2 * foot.xy * u * v + foot.yy * v * v) - w;
  }
};

struct Patch {
  FootPoint foot;
  Vec3 center;
  double radius = 0;
};

struct PatchQuery {
  RTCIntersectContext context;
  Vec3 origin, direction;
  StoredHit best;
};

void patch_bounds(const RTCBoundsFunctionArguments* arguments) {
  const Patch& p = static_cast<const Patch*>(arguments->geometryUserPtr)[arguments->primID];
  RTCBounds& b = *arguments->bounds_o;
  // Beyond the rounding of the centre to single precision.
  const double lost = 1e-6 * (std::abs(p.center.x) + std::abs(p.center.y) + std::abs(p.center.z));
  const auto r = static_cast<float>(p.radius * (1 + 1e-6) + lost);
  const Vec3f c(p.center);
  b.lower_x = c.x - r, b.lower_y = c.y - r, b.lower_z = c.z - r;
  b.upper_x = c.x + r, b.upper_y = c.y + r, b.upper_z = c.z + r;
}

/// Among several at the same distance the first ball counts, independent of Embree's tree.
void cross_patch(const RTCIntersectFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) return;
  auto& query = *reinterpret_cast<PatchQuery*>(arguments->context);
  auto& ray = reinterpret_cast<RTCRayHit*>(arguments->rayhit)->ray;
  const std::uint32_t ball = arguments->primID;
  const Patch& p = static_cast<const Patch*>(arguments->geometryUserPtr)[ball];
  if (!p.foot.defined) return;
  const double middle = dot(p.center - query.origin, query.direction);
  const double aside = squared_norm(p.center - query.origin - query.direction * middle);
  const double square = p.radius * p.radius - aside;
  if (!(square > 0)) return;
  const double half = std::sqrt(square);
  const RayHeight h(p.foot, query.origin + query.direction * middle, query.direction);
  for (const double root : roots_of(h.square, h.slope, h.height)) {
    if (!(std::abs(root) <= half)) continue;
    const auto t = static_cast<float>(middle + root);
    if (!(t > ray.tnear)) continue;
    const bool better = t < ray.tfar || (query.best.found && t == ray.tfar && ball < query.best.ball);
    if (!better) return;
    ray.tfar = t;
    query.best = {true, t, ball};
    return;
  }
}

}  // namespace

struct StoredPolynomials::State {
  std::vector<Patch> patches;
  detail::EmbreeScene embree;
};

StoredPolynomials::StoredPolynomials(StoredPolynomials&&) noexcept = default;
StoredPolynomials& StoredPolynomials::operator=(StoredPolynomials&&) noexcept = default;
StoredPolynomials::~StoredPolynomials() = default;

StoredPolynomials::StoredPolynomials(const Projection& projection, const BallUnion& balls)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  const std::vector<Vec3> centers(balls.centers.begin(), balls.centers.end());
  std::vector<FootPoint> feet(centers.size());
  projection.project(centers, feet);
  s.patches.reserve(centers.size());
  for (std::size_t i = 0; i < centers.size(); ++i)
    s.patches.push_back({feet[i], centers[i], static_cast<double>(balls.radii[i])});
  s.embree.build(static_cast<unsigned>(s.patches.size()), s.patches.data(), patch_bounds, cross_patch);
}

void StoredPolynomials::first(std::span<const CastRay> rays, std::span<StoredHit> hits) const {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const CastRay& r = rays[i];
    PatchQuery query;
    rtcInitIntersectContext(&query.context);
    query.origin = Vec3(r.origin), query.direction = Vec3(r.direction);
    RTCRayHit ray{};
    ray.ray.org_x = r.origin.x, ray.ray.org_y = r.origin.y, ray.ray.org_z = r.origin.z;
    ray.ray.dir_x = r.direction.x, ray.ray.dir_y = r.direction.y, ray.ray.dir_z = r.direction.z;
    ray.ray.tnear = r.near, ray.ray.tfar = r.far;
    ray.ray.mask = 0xFFFFFFFFu;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(state_->embree.scene(), &query.context, &ray);
    hits[i] = query.best;
  }
}

double meet(const FootPoint& foot, const Vec3& x, const Vec3& direction) {
  const RayHeight h(foot, x, direction);
  const double discriminant = h.slope * h.slope - 4 * h.square * h.height;
  if (discriminant < 0) return -dot(x - foot.position, foot.normal) / dot(direction, foot.normal);
  return -2 * h.height / (h.slope + std::copysign(std::sqrt(discriminant), h.slope));
}

StoredCounts cast_from_stored(const Projection& projection, const BallUnion& balls,
                              const StoredPolynomials& polynomials, double tolerance, std::span<const CastRay> rays,
                              std::span<CastHit> hits) {
  struct Walk {
    std::uint32_t ray = 0, ball = 0;
    double at = 0;
    float from = 0;  ///< the next stored polynomial is beyond this distance
    int in_ball = 0, evaluations = 0;
    bool seeks = true;
  };
  std::vector<Walk> walks(rays.size());
  std::vector<CastRay> seeking;
  std::vector<StoredHit> found;
  std::vector<Vec3> starts;
  std::vector<FootPoint> feet;
  StoredCounts counts;
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    walks[i].ray = i;
    walks[i].from = std::max(rays[i].near, 0.0f);
    hits[i] = {};
  }
  const auto on_ray = [&](const Walk& w) { return Vec3(rays[w.ray].origin) + Vec3(rays[w.ray].direction) * w.at; };
  while (!walks.empty()) {
    seeking.clear();
    for (const Walk& w : walks)
      if (w.seeks) seeking.push_back({rays[w.ray].origin, rays[w.ray].direction, w.from, rays[w.ray].far});
    found.resize(seeking.size());
    polynomials.first(seeking, found);
    counts.queries += seeking.size();
    std::size_t next = 0, left = 0;
    starts.clear();
    for (Walk& w : walks) {
      if (w.seeks) {
        const StoredHit& hit = found[next++];
        if (!hit.found) {
          counts.miss_evaluations += static_cast<std::uint64_t>(w.evaluations);
          continue;
        }
        w.at = static_cast<double>(hit.distance), w.ball = hit.ball;
        w.from = hit.distance + BallSegments::slack(hit.distance, balls.radii[hit.ball]);
        w.in_ball = 0, w.seeks = false;
      }
      starts.push_back(on_ray(w));
      walks[left++] = w;
    }
    walks.resize(left);
    feet.resize(left);
    projection.project(starts, feet);
    left = 0;
    for (std::size_t k = 0; k < starts.size(); ++k) {
      Walk& w = walks[k];
      const FootPoint& foot = feet[k];
      const double radius = static_cast<double>(balls.radii[w.ball]);
      ++w.evaluations, ++w.in_ball;
      const Vec3 direction(rays[w.ray].direction);
      const double root = foot.defined ? meet(foot, starts[k], direction) : std::numeric_limits<double>::quiet_NaN();
      if (foot.defined && norm(starts[k] - foot.position) <= tolerance * radius) {
        if (std::abs(root) <= 0.05 * radius) w.at += root;
        hits[w.ray] = {true, static_cast<float>(w.at), on_ray(w), Vec3f(foot.normal), static_cast<float>(radius)};
        counts.hit_evaluations += static_cast<std::uint64_t>(w.evaluations);
        continue;
      }
      w.at += root;
      const bool inside = norm(on_ray(w) - Vec3(balls.centers[w.ball])) <= radius &&
                          w.at >= static_cast<double>(rays[w.ray].near) && w.at <= static_cast<double>(rays[w.ray].far);
      w.seeks = !(inside && w.in_ball < kMostProjections);
      walks[left++] = w;
    }
    walks.resize(left);
  }
  return counts;
}

}  // namespace sansmesh::inline v1::detail
