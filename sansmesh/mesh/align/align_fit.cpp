#include "sansmesh/mesh/align/align_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1::detail {
namespace {

using Seven = Eigen::Matrix<double, 7, 1>;
using SevenSquared = Eigen::Matrix<double, 7, 7>;

constexpr double kLikeNormals = 0.5;  // cosine
constexpr double kReachOverMedian = 5;
constexpr double kFastestNarrowing = 0.55;
constexpr double kFitDamping = 1e-5;
constexpr double kMostTurn = 0.5;  // radians per step
constexpr double kEverywhere = 1e18;
/// Number of steps without this relative improvement after which the fit ends.
constexpr int kIdleSteps = 12;
constexpr double kNearer = 1e-3;

struct Pair {
  Vec3 at, foot, normal;
  double distance = -1;  // negative: no match
};

template <class Surface>
void find_pairs(const OrientedPoints& moving, const Surface& fixed, const Similarity& pose, double reach, bool signs,
                std::vector<Pair>& pairs) {
  pairs.resize(moving.size());
  parallel_for(0, moving.size(), 128, [&](std::size_t i) {
    Pair& p = pairs[i];
    p.distance = -1;
    p.at = pose(moving.x[i]);
    Foot foot;
    if (!fixed.closest(p.at, reach, foot) || foot.beyond) return;
    const Vec3 n = pose.rotate(moving.n[i]);
    if (!alike_normals(n, foot.normal, signs)) return;
    const double distance = norm(p.at - foot.point);
    if (!(distance <= reach)) return;
    p.foot = foot.point;
    // The mean of both normals makes the step correct to second order.
    p.normal = normalized(foot.normal + (dot(n, foot.normal) < 0 ? -n : n));
    p.distance = distance;
  });
}

/// Distance that contains most samples, regardless of matches.
template <class Surface>
double distance_of_most(const OrientedPoints& moving, const Surface& fixed, const Similarity& pose) {
  std::vector<double> distances(moving.size());
  parallel_for(0, moving.size(), 128, [&](std::size_t i) {
    Foot foot;
    const Vec3 at = pose(moving.x[i]);
    distances[i] = fixed.closest(at, kEverywhere, foot) ? norm(at - foot.point) : 0;
  });
  return distances.empty() ? 0 : nth_smallest(distances, distances.size() * 4 / 5);
}

/// Moves the pose; returns the rms motion of the pairs without undetermined motions, since sliding along the surface
/// does not reduce distances.
double take_fit_step(const std::vector<Pair>& pairs, double reach, bool scale, Similarity& pose,
                     std::vector<double>& determined) {
  const Eigen::Index unknowns = scale ? 7 : 6;
  Vec3 center;
  double count = 0, weights = 0;
  for (const Pair& p : pairs)
    if (p.distance >= 0) center += p.at, count += 1;
  if (count < 6) return 0;
  center = center / count;
  double radius = 0;
  for (const Pair& p : pairs)
    if (p.distance >= 0) radius += squared_norm(p.at - center);
  radius = std::max(std::sqrt(radius / count), 1e-12);
  SevenSquared a = SevenSquared::Zero(), mass = SevenSquared::Zero();
  Seven b = Seven::Zero();
  for (const Pair& p : pairs) {
    if (p.distance < 0) continue;
    const double height = dot(p.at - p.foot, p.normal), w = tukey_weight(p.distance / reach);
    const Vec3 d = (p.at - center) / radius, turn = cross(d, p.normal);
    Seven row;
    row << p.normal.x, p.normal.y, p.normal.z, turn.x, turn.y, turn.z, dot(d, p.normal);
    a.noalias() += w * row * row.transpose();
    b -= w * height * row;
    weights += w;
    // Displacement of the points by a unit motion.
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 axis;
      axis[k] = 1;
      const Vec3 t = cross(d, axis);
      Seven motion;
      motion << axis.x, axis.y, axis.z, t.x, t.y, t.z, dot(d, axis);
      mass.noalias() += w * motion * motion.transpose();
    }
  }
  if (!(weights > 0)) return 0;
  a /= weights, b /= weights, mass /= weights;
  const Eigen::MatrixXd m =
      mass.topLeftCorner(unknowns, unknowns) + 1e-9 * Eigen::MatrixXd::Identity(unknowns, unknowns);
  Eigen::MatrixXd whole = a.topLeftCorner(unknowns, unknowns);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(whole, m);
  determined.assign(eigen.eigenvalues().data(), eigen.eigenvalues().data() + unknowns);
  whole += kFitDamping * m;
  const Eigen::VectorXd x = whole.ldlt().solve(b.head(unknowns));
  if (!x.allFinite()) return 0;
  Vec3 turn = Vec3{x[3], x[4], x[5]} / radius;
  if (norm(turn) > kMostTurn) turn = turn * (kMostTurn / norm(turn));
  const double factor = scale ? std::clamp(std::exp(x[6] / radius), 0.5, 2.0) : 1;
  pose = pose.moved(center, turn, factor, {x[0], x[1], x[2]});
  const Eigen::VectorXd motions = eigen.eigenvectors().transpose() * (m * x);
  double squares = 0;
  for (Eigen::Index k = 0; k < unknowns; ++k)
    if (eigen.eigenvalues()[k] >= kDeterminedShare) squares += motions[k] * motions[k];
  return std::sqrt(squares);
}

}  // namespace

bool alike_normals(const Vec3& a, const Vec3& b, bool signs) {
  if (squared_norm(a) == 0 || squared_norm(b) == 0) return true;
  const double c = dot(a, b);
  return (signs ? c : std::abs(c)) >= kLikeNormals;
}

template <class Surface>
FitResult fit_pose(const OrientedPoints& moving, const Surface& fixed, const Similarity& start,
                   const PoseFitOptions& options) {
  FitResult result;
  result.pose = start;
  double reach = options.reach > 0 ? options.reach : 1.5 * distance_of_most(moving, fixed, start);
  reach = std::max(reach, options.least_reach);
  std::vector<Pair> pairs;
  std::vector<double> distances;
  double nearest = std::numeric_limits<double>::infinity();
  int idle = 0;
  for (int i = 0; i < options.iterations; ++i) {
    find_pairs(moving, fixed, result.pose, reach, options.signs, pairs);
    distances.clear();
    for (const Pair& p : pairs)
      if (p.distance >= 0) distances.push_back(p.distance);
    if (distances.size() < 6) break;
    // Adapts the width to the distances in both directions.
    const double middle = median(distances);
    const double wanted = std::max(options.least_reach, kReachOverMedian * middle);
    const double step = take_fit_step(pairs, reach, options.scale, result.pose, result.determined);
    ++result.iterations;
    const bool narrow = reach <= 1.02 * wanted || reach <= options.least_reach;
    reach = std::max({std::min(reach, wanted), options.least_reach, kFastestNarrowing * reach});
    idle = narrow && !(middle < nearest * (1 - kNearer)) ? idle + 1 : 0;
    if (narrow) nearest = std::min(nearest, middle);
    if (narrow && (step < options.last_step || idle >= kIdleSteps)) break;
  }
  result.reach = reach;
  return result;
}
template FitResult fit_pose(const OrientedPoints&, const SampleSurface&, const Similarity&, const PoseFitOptions&);
template FitResult fit_pose(const OrientedPoints&, const WholeSurface&, const Similarity&, const PoseFitOptions&);

namespace {

/// Overlap of samples with a surface: the mean of (1 − (distance / reach)²)², 0 for samples off the surface.
template <class Surface>
double overlap_with(const OrientedPoints& moving, const Surface& fixed, const Similarity& pose, double reach,
                    bool signs) {
  if (moving.size() == 0) return 0;
  const double sum = parallel_reduce(
      moving.size(), 128, 0.0,
      [&](std::size_t first, std::size_t last) {
        double part = 0;
        Foot foot;
        for (std::size_t i = first; i < last; ++i) {
          const Vec3 at = pose(moving.x[i]);
          if (!fixed.closest(at, 2 * reach, foot) || foot.beyond) continue;
          if (!alike_normals(pose.rotate(moving.n[i]), foot.normal, signs)) continue;
          part += tukey_weight(norm(at - foot.point) / reach);
        }
        return part;
      },
      [](double x, double y) { return x + y; });
  return sum / static_cast<double>(moving.size());
}

}  // namespace

template <class Surface>
double mutual_overlap(const OrientedPoints& moving, const Surface& fixed_surface, const OrientedPoints& fixed,
                      const Surface& moving_surface, const Similarity& pose, double reach, bool signs) {
  return (overlap_with(moving, fixed_surface, pose, reach, signs) +
          overlap_with(fixed, moving_surface, pose.inverse(), reach / pose.scale, signs)) /
         2;
}
template double mutual_overlap(const OrientedPoints&, const SampleSurface&, const OrientedPoints&, const SampleSurface&,
                               const Similarity&, double, bool);
template double mutual_overlap(const OrientedPoints&, const WholeSurface&, const OrientedPoints&, const WholeSurface&,
                               const Similarity&, double, bool);

std::vector<std::optional<double>> distances_to(const OrientedPoints& moving, const WholeSurface& fixed,
                                                const Similarity& pose, double reach, bool signs, bool any) {
  std::vector<std::optional<double>> all(moving.size());
  parallel_for(0, moving.size(), 128, [&](std::size_t i) {
    Foot foot;
    const Vec3 at = pose(moving.x[i]);
    if (!fixed.closest(at, any ? kEverywhere : reach, foot)) return;
    if (!any && (foot.beyond || !alike_normals(pose.rotate(moving.n[i]), foot.normal, signs))) return;
    all[i] = norm(at - foot.point);
  });
  return all;
}

}  // namespace sansmesh::inline v1::detail
