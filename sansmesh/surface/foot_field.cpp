#include "sansmesh/surface/foot_field.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Radii over the spacing of the supports of the weights and of the balls of the domain. Points at most a spacing
/// apart, in a layer two spacings thick, leave no gap between balls.
constexpr float kFootSupport = 1.6f, kFootReach = 1.1f;
/// Largest curvature of paraboloids, that of a sphere of one spacing: the rims of others would fold back.
constexpr double kMostBent = 1;
/// A foot is at rest if a step is shorter than kAtRest, and belongs to a point within kBelongs, both in spacings.
constexpr double kAtRest = 0.005, kBelongs = 2;
constexpr int kMostSteps = 6;
constexpr float kOneSheet = 0.7072f;  // cosine to the mean normal above which any two normals differ by less than 90°
constexpr std::size_t kPointsAtOnce = 4096;

/// Copies `near` relative to the group's centre; returns whether some face away from others.
bool gather_near(const std::vector<detail::Paraboloid>& all, const std::vector<std::uint32_t>& near,
                 const detail::PointGroup& group, std::vector<detail::Paraboloid>& chosen) {
  chosen.resize(near.size());
  Vec3f mean;
  for (std::size_t k = 0; k < near.size(); ++k) {
    detail::Paraboloid& c = chosen[k];
    c = all[near[k]];
    c.x -= group.center.x, c.y -= group.center.y, c.z -= group.center.z;
    mean += {c.nx, c.ny, c.nz};
  }
  const float limit = kOneSheet * norm(mean);
  return std::any_of(chosen.begin(), chosen.end(), [&](const detail::Paraboloid& c) {
    return !(c.nx * mean.x + c.ny * mean.y + c.nz * mean.z > limit);
  });
}

}  // namespace

SurfaceFeet find_feet(const Projection& projection, std::span<const Vec3f> points, std::span<const float> spacing) {
  constexpr std::size_t kChunk = 16384;
  SurfaceFeet found;
  std::vector<Vec3> from;
  std::vector<FootPoint> feet;
  std::vector<std::uint32_t> open, next;
  std::vector<Vec3> moving;
  std::vector<FootPoint> moved;
  for (std::size_t first = 0; first < points.size(); first += kChunk) {
    const std::size_t n = std::min(kChunk, points.size() - first);
    from.resize(n), feet.assign(n, {}), open.resize(n);
    for (std::size_t i = 0; i < n; ++i) from[i] = Vec3(points[first + i]), open[i] = static_cast<std::uint32_t>(i);
    for (int step = 0; step < kMostSteps && !open.empty(); ++step) {
      moving.clear();
      for (const std::uint32_t i : open) moving.push_back(from[i]);
      moved.resize(moving.size());
      projection.project(moving, moved);
      next.clear();
      for (std::size_t k = 0; k < open.size(); ++k) {
        const std::uint32_t i = open[k];
        const double s = static_cast<double>(spacing[first + i]);
        FootPoint& foot = feet[i] = moved[k];
        if (!foot.defined) continue;
        // Moves along the normal only: next to edges the projection moves points along the surface without end.
        const double height = dot(from[i] - foot.position, foot.normal);
        from[i] -= foot.normal * height;
        foot.position = from[i];
        foot.defined = std::abs(height) <= kAtRest * s && norm(from[i] - Vec3(points[first + i])) <= kBelongs * s;
        if (std::abs(height) > kAtRest * s && norm(from[i] - Vec3(points[first + i])) <= kBelongs * s)
          next.push_back(i);
      }
      open.swap(next);
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (!feet[i].defined) continue;
      found.feet.push_back(feet[i]);
      found.spacing.push_back(spacing[first + i]);
      found.start.push_back(static_cast<std::uint32_t>(first + i));
    }
  }
  return found;
}

FootField::FootField(const SurfaceFeet& feet, const ScalarField* beyond)
    : paraboloids_(feet.feet.size()), beyond_(beyond) {
  if (feet.feet.empty()) throw DataError("no point of the surface was found");
  std::vector<Vec3f> centers(feet.feet.size());
  std::vector<float> supports(feet.feet.size());
  Box3f box;
  for (std::size_t i = 0; i < feet.feet.size(); ++i) {
    const FootPoint& foot = feet.feet[i];
    const float s = feet.spacing[i], support = s * kFootSupport, reach = s * kFootReach;
    centers[i] = Vec3f(foot.position), supports[i] = support;
    const double bent = std::max(std::abs(foot.xx), std::abs(foot.yy)) + std::abs(foot.xy);
    const double half = 0.5 * std::min(1.0, kMostBent / (bent * static_cast<double>(s)));
    Vec3 t, b;
    tangent_frame(foot.normal, t, b);
    const auto entry = [&](int r, int c) {
      return static_cast<float>(
          half * (foot.xx * t[r] * t[c] + foot.xy * (t[r] * b[c] + b[r] * t[c]) + foot.yy * b[r] * b[c]));
    };
    const Vec3f n(foot.normal), p = centers[i];
    paraboloids_[i] = {p.x,         p.y,         p.z,         1 / (support * support),
                       n.x,         n.y,         n.z,         1 / (reach * reach),
                       entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1),
                       entry(1, 2), entry(2, 2)};
    box.extend(p - Vec3f{reach, reach, reach});
    box.extend(p + Vec3f{reach, reach, reach});
  }
  supports_ = BallTree(centers, supports);
  bounds_ = {Vec3(box.lower), Vec3(box.upper)};
  extent_ = static_cast<double>(median(supports));
}

void FootField::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  evaluate_in_domain(x, values, gradients, {});
}

void FootField::evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                                   std::span<std::uint8_t> inside) const {
  const double far = bounds_.diagonal();
  std::vector<std::uint8_t> own;
  if (inside.empty() && beyond_ != nullptr) {
    own.resize(x.size());
    inside = own;
  }
  const std::size_t batches = (x.size() + kPointsAtOnce - 1) / kPointsAtOnce;
  parallel_for(0, batches, 1, [&](std::size_t b) {
    std::vector<std::uint32_t> near;
    std::vector<detail::Paraboloid> chosen;
    detail::GroupHeights out;
    const std::size_t first = b * kPointsAtOnce, n = std::min(kPointsAtOnce, x.size() - first);
    for (std::size_t i = first; i < first + n; ++i) {
      values[i] = far;
      if (!gradients.empty()) gradients[i] = {0, 0, 1};
      if (!inside.empty()) inside[i] = 0;
    }
    detail::for_each_group(x.subspan(first, n), extent_, [&](const detail::PointGroup& group, const Box3f& box) {
      supports_.touching(box, near);
      if (near.empty()) return;
      const bool mixed = gather_near(paraboloids_, near, group, chosen);
      detail::blend_paraboloids(chosen, group, mixed, out);
      for (std::size_t k = 0; k < group.count; ++k) {
        if (!(out.inside[k] > 0)) continue;
        const std::size_t i = first + group.slot[k];
        values[i] = static_cast<double>(out.value[k]);
        if (!gradients.empty()) gradients[i] = Vec3(Vec3f{out.x[k], out.y[k], out.z[k]});
        if (!inside.empty()) inside[i] = 1;
      }
    });
  });
  if (beyond_ != nullptr) detail::fill_undefined(*beyond_, x, inside, values, gradients);
}

BallUnion FootField::balls() const {
  BallUnion balls;
  balls.centers.reserve(paraboloids_.size());
  balls.radii.reserve(paraboloids_.size());
  for (const detail::Paraboloid& p : paraboloids_) {
    balls.centers.push_back({p.x, p.y, p.z});
    balls.radii.push_back(1 / std::sqrt(p.inverse_reach));
  }
  return balls;
}

}  // namespace sansmesh::inline v1
