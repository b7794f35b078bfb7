#include "sansmesh/mesh/align/align_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/align/align_fit.h"
#include "sansmesh/points/registration/point_features.h"
#include "sansmesh/points/sampling/subsample.h"
#include "sansmesh/points/shape/principal_axes.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kWantedSamples = 2500;  // samples of the smaller surface
constexpr double kMostSamples = 12000;   // samples of the larger surface
constexpr std::size_t kRotations = 480;
constexpr std::size_t kOfScore = 250, kOfFit = 900;
constexpr double kFeatureReach = 5, kNormalBlur = 2;  // in spacings
constexpr std::size_t kMostMatches = 1200;
constexpr double kPairTolerance = 1.5;  // tolerance of lengths, in spacings
constexpr double kPairAngle = 0.35;     // tolerance of angles between normals, radians
constexpr double kMatchReach = 2;       // in spacings
constexpr double kLeastPair = 4;        // least distance of a pair, in spacings
constexpr std::size_t kMostPairs = 200000, kPosesOfMatch = 12;
constexpr double kCoarseReach = 3, kFineReach = 1.5;  // for scores, in spacings
constexpr std::size_t kKeptOfPairs = 60, kKeptOfRotations = 40, kKept = 14;

/// Evenly spaced rotations on a spiral in the space of quaternions (Alexa 2022, "Super-Fibonacci spirals").
Similarity spiral_rotation(std::size_t k, std::size_t count) {
  const double phi = std::numbers::sqrt2, psi = 1.533751168755204288118041;
  const double s = static_cast<double>(k) + 0.5, t = s / static_cast<double>(count), d = 2 * std::numbers::pi * s;
  const double r = std::sqrt(t), q = std::sqrt(1 - t), alpha = d / phi, beta = d / psi;
  const double x = r * std::sin(alpha), y = r * std::cos(alpha), z = q * std::sin(beta), w = q * std::cos(beta);
  return {{Vec3{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
           Vec3{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
           Vec3{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}},
          1,
          {}};
}

/// The four rotations that align the principal axes of both surfaces.
std::vector<Similarity> principal_rotations(const OrientedPoints& moving, const OrientedPoints& fixed) {
  const auto axes_of = [](const OrientedPoints& p) {
    const std::vector<Vec3f> x(p.x.begin(), p.x.end());
    return principal_axes(moments(x).covariance);
  };
  const PrincipalAxes a = axes_of(moving), b = axes_of(fixed);
  std::vector<Similarity> all;
  for (int flips = 0; flips < 4; ++flips) {
    const Vec3 u = b.axes[0] * (flips & 1 ? -1.0 : 1.0), v = b.axes[1] * (flips & 2 ? -1.0 : 1.0), w = cross(u, v);
    const Vec3 last = cross(a.axes[0], a.axes[1]);
    Similarity p;
    for (std::size_t k = 0; k < 3; ++k) p.columns[k] = u * a.axes[0][k] + v * a.axes[1][k] + w * last[k];
    all.push_back(p);
  }
  return all;
}

struct Match {
  std::uint32_t moving, fixed;
};

/// Pairs of samples with mutually nearest features.
std::vector<Match> match_features(const std::vector<PointFeature>& moving, const std::vector<PointFeature>& fixed) {
  const auto nearest = [](const std::vector<PointFeature>& of, const std::vector<PointFeature>& in) {
    std::vector<std::pair<std::uint32_t, float>> best(of.size());
    parallel_for(0, of.size(), 16, [&](std::size_t i) {
      float least = std::numeric_limits<float>::infinity();
      for (std::size_t j = 0; j < in.size(); ++j) {
        // Several sums in parallel, so that the compiler vectorises them in a fixed order.
        std::array<float, 11> sum{};
        for (std::size_t k = 0; k < 33; k += 11)
          for (std::size_t l = 0; l < 11; ++l) {
            const float d = of[i][k + l] - in[j][k + l];
            sum[l] += d * d;
          }
        float all = 0;
        for (const float s : sum) all += s;
        if (all < least) least = all, best[i] = {static_cast<std::uint32_t>(j), all};
      }
    });
    return best;
  };
  if (moving.empty() || fixed.empty()) return {};
  const auto there = nearest(moving, fixed), back = nearest(fixed, moving);
  std::vector<std::pair<float, Match>> mutual;
  for (std::uint32_t i = 0; i < there.size(); ++i)
    if (back[there[i].first].first == i) mutual.emplace_back(there[i].second, Match{i, there[i].first});
  std::vector<Match> matches;
  for (const std::uint32_t k : evenly_spaced(mutual.size(), kMostMatches)) matches.push_back(mutual[k].second);
  return matches;
}

/// Right-handed orthonormal axes from the line between two points and their normals.
bool frame_of(const Vec3& d, const Vec3& n, Vec3 (&axes)[3]) {
  axes[0] = normalized(d);
  const Vec3 across = n - axes[0] * dot(n, axes[0]);
  if (norm(across) < 0.3) return false;
  axes[1] = normalized(across);
  axes[2] = cross(axes[0], axes[1]);
  return true;
}

double angle_of(const Vec3& a, const Vec3& b) { return std::acos(std::clamp(dot(a, b), -1.0, 1.0)); }

/// Poses from pairs of matches with equal distances and relative orientations on both surfaces, scored by the number of
/// other matches that agree.
std::vector<FoundPose> poses_of_matches(const OrientedPoints& moving, const OrientedPoints& fixed,
                                        const std::vector<Match>& matches, double spacing, bool scale) {
  const std::size_t n = matches.size();
  if (n < 3) return {};
  // All pairs, or a fixed selection at equal steps.
  const std::uint64_t all = static_cast<std::uint64_t>(n) * (n - 1) / 2;
  const std::uint64_t every = std::max<std::uint64_t>(1, all / (4 * kMostPairs));
  std::vector<std::vector<FoundPose>> of_first(n);
  parallel_for(0, n, 4, [&](std::size_t i) {
    const Match& a = matches[i];
    for (std::size_t j = i + 1 + i % every; j < n; j += every) {
      const Match& b = matches[j];
      const Vec3 d = moving.x[b.moving] - moving.x[a.moving], e = fixed.x[b.fixed] - fixed.x[a.fixed];
      const double length = norm(d), other = norm(e);
      if (length < kLeastPair * spacing || other < kLeastPair * spacing) continue;
      const double factor = other / length;
      if (scale ? factor < 0.1 || factor > 10 : std::abs(length - other) > kPairTolerance * spacing) continue;
      const Vec3 &na = moving.n[a.moving], &nb = moving.n[b.moving], &ma = fixed.n[a.fixed], &mb = fixed.n[b.fixed];
      if (std::abs(angle_of(na, nb) - angle_of(ma, mb)) > kPairAngle) continue;
      const Vec3 along = d / length, along_other = e / other;
      if (std::abs(angle_of(na, along) - angle_of(ma, along_other)) > kPairAngle ||
          std::abs(angle_of(nb, along) - angle_of(mb, along_other)) > kPairAngle)
        continue;
      Vec3 from[3], to[3];
      if (!frame_of(d, na + nb, from) || !frame_of(e, ma + mb, to)) continue;
      FoundPose found;
      Similarity& p = found.pose;
      for (std::size_t k = 0; k < 3; ++k) p.columns[k] = to[0] * from[0][k] + to[1] * from[1][k] + to[2] * from[2][k];
      p.scale = scale ? factor : 1;
      p.translation =
          (fixed.x[a.fixed] + fixed.x[b.fixed]) / 2 - p.rotate((moving.x[a.moving] + moving.x[b.moving]) / 2) * p.scale;
      const double reach = kMatchReach * spacing;
      for (const Match& m : matches) {
        if (squared_norm(p(moving.x[m.moving]) - fixed.x[m.fixed]) > reach * reach) continue;
        if (dot(p.rotate(moving.n[m.moving]), fixed.n[m.fixed]) > 0.7) found.score += 1;
      }
      if (found.score >= 3) of_first[i].push_back(found);
      if (of_first[i].size() >= kPosesOfMatch) break;
    }
    // Poses from the same match hardly differ.
    std::stable_sort(of_first[i].begin(), of_first[i].end());
    if (of_first[i].size() > 4) of_first[i].resize(4);
  });
  std::vector<FoundPose> found;
  for (const auto& part : of_first) found.insert(found.end(), part.begin(), part.end());
  std::stable_sort(found.begin(), found.end());
  return found;
}

void keep_different(std::vector<FoundPose>& found, const AlignSide& moving, double angle, double distance,
                    std::size_t most) {
  std::stable_sort(found.begin(), found.end());
  std::vector<FoundPose> kept;
  for (const FoundPose& f : found) {
    if (kept.size() >= most) break;
    if (std::none_of(kept.begin(), kept.end(),
                     [&](const FoundPose& k) { return nearly_same(k.pose, f.pose, moving, angle, distance); }))
      kept.push_back(f);
  }
  found = std::move(kept);
}

}  // namespace

bool nearly_same(const Similarity& a, const Similarity& b, const AlignSide& moving, double angle, double distance) {
  return angle_between(a, b) < angle && norm(a(moving.centroid) - b(moving.centroid)) < distance &&
         std::abs(std::log(a.scale / b.scale)) < 0.1;
}

SearchSamples search_samples(const AlignSide& moving, const AlignSide& fixed) {
  SearchSamples samples;
  const double small = std::min(moving.area, fixed.area), large = std::max(moving.area, fixed.area);
  samples.spacing = std::sqrt(std::max({small / kWantedSamples, large / kMostSamples, 1e-8}) * 1.3);
  samples.moving = even_samples(moving, samples.spacing, kNormalBlur * samples.spacing);
  samples.fixed = even_samples(fixed, samples.spacing, kNormalBlur * samples.spacing);
  samples.signs = moving.has_sides && fixed.has_sides;
  return samples;
}

std::vector<FoundPose> search_poses(const AlignSide& moving, const AlignSide& fixed, const SearchSamples& samples,
                                    bool scale, Progress& progress) {
  const double spacing = samples.spacing;
  const SampleSurface target(samples.fixed, spacing), source(samples.moving, spacing);
  const OrientedPoints few_moving = samples.moving.some(kOfScore), few_fixed = samples.fixed.some(kOfScore);
  const OrientedPoints many_moving = samples.moving.some(kOfFit), many_fixed = samples.fixed.some(kOfFit);
  std::vector<FoundPose> found;

  progress.begin("try rotations", kRotations);
  {
    std::vector<FoundPose> turned(kRotations + 4);
    const std::vector<Similarity> principal = principal_rotations(samples.moving, samples.fixed);
    PoseFitOptions fit;
    fit.iterations = 8;
    fit.least_reach = kCoarseReach * spacing;
    fit.signs = samples.signs;
    parallel_for(0, turned.size(), 1, [&](std::size_t k) {
      Similarity p = k < kRotations ? spiral_rotation(k, kRotations) : principal[k - kRotations];
      p.scale = scale ? fixed.radius / moving.radius : 1;
      p.translation = fixed.centroid - p.rotate(moving.centroid) * p.scale;
      FoundPose& f = turned[k];
      f.pose = fit_pose(few_moving, target, p, fit).pose;
      f.score = mutual_overlap(few_moving, target, few_fixed, source, f.pose, kCoarseReach * spacing, samples.signs);
      progress.advance();
    });
    keep_different(turned, moving, 0.2, 4 * spacing, kKeptOfRotations);
    found = std::move(turned);
  }

  progress.begin("match features");
  for (const double sign : {1.0, -1.0}) {
    if (sign < 0 && samples.signs) break;  // the sides are known
    OrientedPoints flipped = samples.moving;
    for (Vec3& n : flipped.n) n = n * sign;
    const std::vector<Match> matches =
        match_features(point_features(flipped.x, flipped.n, kFeatureReach * spacing),
                       point_features(samples.fixed.x, samples.fixed.n, kFeatureReach * spacing));
    std::vector<FoundPose> of_pairs = poses_of_matches(flipped, samples.fixed, matches, spacing, scale);
    keep_different(of_pairs, moving, 0.1, 2 * spacing, kKeptOfPairs);
    found.insert(found.end(), of_pairs.begin(), of_pairs.end());
  }

  progress.begin("refine poses", found.size());
  PoseFitOptions fit;
  fit.iterations = 25;
  fit.reach = 2 * kCoarseReach * spacing;
  fit.least_reach = kFineReach * spacing;
  fit.scale = scale;
  fit.signs = samples.signs;
  fit.last_step = 1e-3 * spacing;
  parallel_for(0, found.size(), 1, [&](std::size_t k) {
    FoundPose& f = found[k];
    f.pose = fit_pose(many_moving, target, f.pose, fit).pose;
    f.score = mutual_overlap(many_moving, target, many_fixed, source, f.pose, kFineReach * spacing, samples.signs);
    progress.advance();
  });
  keep_different(found, moving, 0.1, 2 * spacing, kKept);
  return found;
}

}  // namespace sansmesh::inline v1::detail
