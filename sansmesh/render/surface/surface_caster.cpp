#include "sansmesh/render/surface/surface_caster.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/render/surface/ball_segments.h"
#include "sansmesh/render/surface/ray_walk.h"
#include "sansmesh/render/surface/stored_rays.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kBatch = 1024;  // rays advanced together: their state fits into the cache

/// Memory of a batch, reused by later ones.
struct Scratch {
  std::vector<RayWalk> walks;
  std::vector<std::uint32_t> active, asking, values, roots;
  std::vector<SegmentQuery> queries;
  std::vector<BallSegment> segments;
  std::vector<Vec3> positions, gradients;
  std::vector<double> numbers;
  std::vector<std::uint8_t> inside;
  std::vector<FootPoint> feet;
};

Vec3 point_on_ray(const CastRay& ray, double t) { return Vec3(ray.origin) + Vec3(ray.direction) * t; }

BallUnion usable(const BallUnion& balls) {
  if (balls.centers.size() != balls.radii.size())
    throw ArgumentError("balls: " + std::to_string(balls.centers.size()) + " centres, but " +
                        std::to_string(balls.radii.size()) + " radii");
  BallUnion kept;
  kept.centers.reserve(balls.centers.size());
  kept.radii.reserve(balls.radii.size());
  for (std::size_t i = 0; i < balls.centers.size(); ++i) {
    if (!is_finite(balls.centers[i]) || !std::isfinite(balls.radii[i]) || !(balls.radii[i] > 0)) continue;
    kept.centers.push_back(balls.centers[i]);
    kept.radii.push_back(balls.radii[i]);
  }
  if (kept.centers.empty()) throw DataError("no finite ball with a positive radius");
  return kept;
}

}  // namespace

void SurfaceCastOptions::validate() const {
  check_range("tolerance", tolerance, 1e-6, 0.1);
  check_range("smallest_step", smallest_step, 1e-3, 1);
  check_range("largest_step", largest_step, smallest_step, 1);
  check_range("jump", jump, 0, 1);
}

struct SurfaceCaster::State {
  State(const ScalarField* f, const Projection* p, const BallUnion& b, const SurfaceCastOptions& options)
      : field(f),
        projection(p),
        balls(usable(b)),
        segments(balls),
        normals(options.normals),
        tolerance(options.tolerance),
        rules{options.tolerance, options.smallest_step, options.largest_step, options.jump, p != nullptr} {
    if (options.stored && projection == nullptr) throw ArgumentError("`stored` needs a projection");
    if (options.stored) polynomials.emplace(*projection, balls);
  }

  void cast(std::span<const CastRay> rays, std::span<CastHit> hits, Scratch& scratch) const;
  void cast_stored(std::span<const CastRay> rays, std::span<CastHit> hits, Scratch& scratch) const;
  void answer_queries(std::span<const CastRay> rays, Scratch& scratch, std::uint64_t& queries) const;
  void refine_normals(std::span<CastHit> found, Scratch& scratch) const;
  void sample_field(std::span<const CastRay> rays, Scratch& scratch) const;
  void sample_projection(std::span<const CastRay> rays, Scratch& scratch) const;

  /// A thread that waits inside the field may start another batch, so scratch memory belongs to batches, not to
  /// threads.
  std::unique_ptr<Scratch> borrow() const {
    const std::lock_guard lock(mutex);
    if (spare.empty()) return std::make_unique<Scratch>();
    std::unique_ptr<Scratch> scratch = std::move(spare.back());
    spare.pop_back();
    return scratch;
  }
  void give_back(std::unique_ptr<Scratch> scratch) const {
    const std::lock_guard lock(mutex);
    spare.push_back(std::move(scratch));
  }

  const ScalarField* field;
  const Projection* projection;
  BallUnion balls;
  BallSegments segments;
  const NormalField* normals;
  double tolerance;
  WalkRules rules;
  std::optional<detail::StoredPolynomials> polynomials;
  mutable std::mutex mutex;
  mutable std::vector<std::unique_ptr<Scratch>> spare;
  mutable std::atomic<std::uint64_t> rays{0}, hits{0}, hit_evaluations{0}, miss_evaluations{0}, ball_queries{0};
};

SurfaceCaster::SurfaceCaster(SurfaceCaster&&) noexcept = default;
SurfaceCaster& SurfaceCaster::operator=(SurfaceCaster&&) noexcept = default;
SurfaceCaster::~SurfaceCaster() = default;

SurfaceCaster::SurfaceCaster(const ScalarField& field, const BallUnion& balls, const SurfaceCastOptions& options) {
  options.validate();
  state_ = std::make_unique<State>(&field, nullptr, balls, options);
}

SurfaceCaster::SurfaceCaster(const Projection& projection, const BallUnion& balls, const SurfaceCastOptions& options) {
  options.validate();
  state_ = std::make_unique<State>(nullptr, &projection, balls, options);
}

const BallUnion& SurfaceCaster::balls() const { return state_->balls; }

CastCounts SurfaceCaster::counts() const {
  return {state_->rays, state_->hits, state_->hit_evaluations, state_->miss_evaluations, state_->ball_queries};
}

void SurfaceCaster::cast(std::span<const CastRay> rays, std::span<CastHit> hits) const {
  if (rays.size() != hits.size()) throw ArgumentError("cast: as many hits as rays are needed");
  const std::size_t batches = (rays.size() + kBatch - 1) / kBatch;
  parallel_for(0, batches, 1, [&](std::size_t batch) {
    const std::size_t first = batch * kBatch, count = std::min(kBatch, rays.size() - first);
    std::unique_ptr<Scratch> scratch = state_->borrow();
    state_->cast(rays.subspan(first, count), hits.subspan(first, count), *scratch);
    state_->give_back(std::move(scratch));
  });
}

void SurfaceCaster::State::cast(std::span<const CastRay> batch, std::span<CastHit> found, Scratch& s) const {
  if (polynomials) return cast_stored(batch, found, s);
  s.walks.resize(batch.size());
  s.active.resize(batch.size());
  for (std::uint32_t i = 0; i < batch.size(); ++i) {
    s.walks[i] = RayWalk(std::max(batch[i].near, 0.0f), batch[i].far);
    s.active[i] = i;
  }
  std::uint64_t queries = 0;
  while (true) {
    answer_queries(batch, s, queries);
    // Neighbouring pixels stay neighbours.
    s.values.clear();
    s.roots.clear();
    std::size_t left = 0;
    for (const std::uint32_t i : s.active) {
      const RayWalk::Request request = s.walks[i].request();
      if (request == RayWalk::Request::nothing) continue;
      s.active[left++] = i;
      (request == RayWalk::Request::root && projection == nullptr ? s.roots : s.values).push_back(i);
    }
    s.active.resize(left);
    if (left == 0) break;
    if (projection != nullptr)
      sample_projection(batch, s);
    else
      sample_field(batch, s);
  }

  std::uint64_t hit_count = 0, for_hits = 0, for_misses = 0;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const RayWalk& walk = s.walks[i];
    found[i] = {};
    if (walk.hit()) {
      const double t = walk.distance();
      found[i] = {true, static_cast<float>(t), point_on_ray(batch[i], t), walk.normal(),
                  static_cast<float>(walk.radius())};
    }
    hit_count += walk.hit();
    (walk.hit() ? for_hits : for_misses) += static_cast<std::uint64_t>(walk.evaluations());
  }
  if (normals != nullptr) refine_normals(found, s);
  rays.fetch_add(batch.size(), std::memory_order_relaxed);
  hits.fetch_add(hit_count, std::memory_order_relaxed);
  hit_evaluations.fetch_add(for_hits, std::memory_order_relaxed);
  miss_evaluations.fetch_add(for_misses, std::memory_order_relaxed);
  ball_queries.fetch_add(queries, std::memory_order_relaxed);
}

void SurfaceCaster::State::cast_stored(std::span<const CastRay> batch, std::span<CastHit> found, Scratch& s) const {
  const detail::StoredCounts counts =
      detail::cast_from_stored(*projection, balls, *polynomials, tolerance, batch, found);
  if (normals != nullptr) refine_normals(found, s);
  const auto hit_count = std::count_if(found.begin(), found.end(), [](const CastHit& hit) { return hit.hit; });
  rays.fetch_add(batch.size(), std::memory_order_relaxed);
  hits.fetch_add(static_cast<std::uint64_t>(hit_count), std::memory_order_relaxed);
  hit_evaluations.fetch_add(counts.hit_evaluations, std::memory_order_relaxed);
  miss_evaluations.fetch_add(counts.miss_evaluations, std::memory_order_relaxed);
  ball_queries.fetch_add(counts.queries, std::memory_order_relaxed);
}

void SurfaceCaster::State::refine_normals(std::span<CastHit> found, Scratch& s) const {
  s.positions.clear();
  s.gradients.clear();
  for (const CastHit& hit : found) {
    if (!hit.hit) continue;
    s.positions.push_back(hit.position);
    s.gradients.emplace_back(hit.normal);
  }
  normals->refine(s.positions, s.gradients);
  std::size_t k = 0;
  for (CastHit& hit : found)
    if (hit.hit) hit.normal = Vec3f(s.gradients[k++]);
}

void SurfaceCaster::State::answer_queries(std::span<const CastRay> batch, Scratch& s, std::uint64_t& queries) const {
  s.asking.clear();
  for (const std::uint32_t i : s.active)
    if (s.walks[i].request() == RayWalk::Request::segment) s.asking.push_back(i);
  while (!s.asking.empty()) {
    s.queries.clear();
    for (const std::uint32_t i : s.asking) {
      const RayWalk& walk = s.walks[i];
      s.queries.push_back(
          {batch[i].origin, batch[i].direction, static_cast<float>(walk.end()), static_cast<float>(walk.far())});
    }
    s.segments.resize(s.asking.size());
    segments.first(s.queries, s.segments);
    queries += s.asking.size();
    std::size_t left = 0;
    for (std::size_t k = 0; k < s.asking.size(); ++k) {
      const std::uint32_t i = s.asking[k];
      s.walks[i].enter(s.segments[k], rules);
      if (s.walks[i].request() == RayWalk::Request::segment) s.asking[left++] = i;
    }
    s.asking.resize(left);
  }
}

void SurfaceCaster::State::sample_field(std::span<const CastRay> batch, Scratch& s) const {
  for (const bool with_gradient : {false, true}) {
    const std::vector<std::uint32_t>& who = with_gradient ? s.roots : s.values;
    if (who.empty()) continue;
    s.positions.clear();
    for (const std::uint32_t i : who) s.positions.push_back(point_on_ray(batch[i], s.walks[i].at()));
    s.numbers.resize(who.size());
    s.inside.resize(who.size());
    s.gradients.resize(with_gradient ? who.size() : 0);
    field->evaluate_in_domain(s.positions, s.numbers, s.gradients, s.inside);
    for (std::size_t k = 0; k < who.size(); ++k) {
      WalkSample sample;
      sample.inside = s.inside[k] != 0;
      sample.value = s.numbers[k];
      if (with_gradient) {
        const Vec3& gradient = s.gradients[k];
        const double along = dot(gradient, Vec3(batch[who[k]].direction)), length = norm(gradient);
        sample.normal = Vec3f(normalized(gradient));
        sample.root = -sample.value / along;
        sample.slant = std::abs(along) / length;
        sample.steepness = length;
      }
      s.walks[who[k]].take(sample, rules);
    }
  }
}

void SurfaceCaster::State::sample_projection(std::span<const CastRay> batch, Scratch& s) const {
  s.positions.clear();
  for (const std::uint32_t i : s.values) s.positions.push_back(point_on_ray(batch[i], s.walks[i].at()));
  s.feet.resize(s.values.size());
  projection->project(s.positions, s.feet);
  for (std::size_t k = 0; k < s.values.size(); ++k) {
    const FootPoint& foot = s.feet[k];
    WalkSample sample;
    sample.inside = foot.defined;
    if (foot.defined) {
      const Vec3 direction(batch[s.values[k]].direction), offset = s.positions[k] - foot.position;
      sample.value = dot(offset, foot.normal);
      sample.residual = norm(offset);
      sample.root = detail::meet(foot, s.positions[k], direction);
      sample.slant = std::abs(dot(direction, foot.normal));
      sample.normal = Vec3f(foot.normal);
    }
    s.walks[s.values[k]].take(sample, rules);
  }
}

void SurfaceCaster::surface_points(std::span<Vec3f> positions, std::span<Vec3f> normals) const {
  const State& s = *state_;
  const std::size_t count = s.balls.centers.size();
  if (positions.size() != count || normals.size() != count)
    throw ArgumentError("surface_points: as many positions and normals as balls are needed");
  constexpr int kSteps = 3;
  parallel_ranges(0, count, 4096, [&](std::size_t first, std::size_t last) {
    const std::size_t n = last - first;
    std::vector<Vec3> at(n), gradients(n);
    std::vector<double> values(n);
    std::vector<std::uint8_t> inside(n);
    std::vector<FootPoint> found(n);
    for (std::size_t i = 0; i < n; ++i) at[i] = Vec3(s.balls.centers[first + i]);
    for (int step = 0; step < kSteps; ++step) {
      if (s.projection != nullptr) {
        s.projection->project(at, found);
        for (std::size_t i = 0; i < n; ++i) {
          inside[i] = found[i].defined;
          if (found[i].defined) at[i] = found[i].position, gradients[i] = found[i].normal;
        }
        continue;
      }
      s.field->evaluate_in_domain(at, values, gradients, inside);
      for (std::size_t i = 0; i < n; ++i) {
        const double square = squared_norm(gradients[i]);
        if (square > 0 && step + 1 < kSteps) at[i] -= gradients[i] * (values[i] / square);
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 center(s.balls.centers[first + i]);
      const bool arrived = inside[i] != 0 && norm(at[i] - center) <= static_cast<double>(s.balls.radii[first + i]);
      positions[first + i] = arrived ? Vec3f(at[i]) : s.balls.centers[first + i];
      normals[first + i] = arrived ? Vec3f(normalized(gradients[i])) : Vec3f{};
    }
  });
}

namespace {

constexpr ReportRow kCastCountsRows[] = {
    reported<&CastCounts::rays>({.name = "cast", .text = "Rays cast"}),
    reported<&CastCounts::hits>({.name = "hit", .text = "Rays that hit the surface"}),
    reported<[](const CastCounts& r) { return r.hit_evaluations + r.miss_evaluations; }>(
        {.name = "evaluations", .text = "Evaluations of the surface for these"})};

}  // namespace

const ReportSchema& CastCounts::schema() {
  static constexpr ReportSchema schema{kCastCountsRows};
  return schema;
}

}  // namespace sansmesh::inline v1
