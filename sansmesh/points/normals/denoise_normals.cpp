#include "sansmesh/points/normals/denoise_normals.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSlots = 2048;
constexpr std::size_t kCandidates = 24;
constexpr std::size_t kReach = 4;  ///< ratio of candidates to samples in the blur: twice its radius
constexpr float kClearly = 1.15f;  ///< factor of support that a plane needs to win
constexpr float kAtLeast = 1.5f;   ///< and least difference in samples
constexpr float kAlike = 0.9903f;  ///< cos 8°: candidates this close are left to averaging
constexpr std::size_t kLeastVoters = 24;

/// n or −n, on the side of `reference`.
Vec3f aligned(const Vec3f& n, const Vec3f& reference) { return dot(n, reference) < 0 ? -n : n; }

class NormalDenoiser {
 public:
  NormalDenoiser(const PointSet& points, const NormalDenoisingOptions& options)
      : options_(options), tree_(points.positions), positions_(tree_.positions()), normals_(tree_.size()) {
    for (std::size_t slot = 0; slot < normals_.size(); ++slot) {
      const Vec3f n = points.normals[tree_.order()[slot]];
      normals_[slot] = is_finite(n) ? normalized(n) : Vec3f{};
    }
    const double spacing = options.spacing ? *options.spacing : estimate_spacing(points);
    const double noise = options.noise ? *options.noise : estimate_noise(points);
    blur_ = static_cast<std::size_t>(options.neighbours.value_or(choose_neighbours(spacing, noise)));
    noisy_ = noise > 0.1 * spacing;
    thickness_ = static_cast<float>(1.5 * noise + 0.08 * spacing);
  }

  void vote(Progress& progress) {
    if (!(thickness_ > 0)) return;
    const std::vector<Vec3f> before = normals_;
    const std::size_t voters = std::max(kLeastVoters, noisy_ ? 2 * blur_ : blur_),
                      reach = std::max(kReach * blur_, 2 * kLeastVoters);
    parallel_ranges(0, tree_.size(), kSlots, [&](std::size_t first, std::size_t last) {
      std::vector<Vec3f> offsets;
      std::vector<float> weights;
      tree_.for_each_nearest(reach, first, last, [&](std::uint32_t slot, std::span<const Neighbour> found) {
        const Vec3f own = before[slot];
        if (found.size() < 8 || squared_norm(own) == 0) return;
        const std::span<const Neighbour> near = found.first(std::min(voters, found.size()));
        const float radius = near.back().squared_distance;
        if (!(radius > 0)) return;
        offsets.clear();
        weights.clear();
        for (const Neighbour& n : near) {
          offsets.push_back(positions_[n.index] - positions_[slot]);
          weights.push_back(1 - 0.8f * n.squared_distance / radius);
        }
        Vec3f best = own;
        const float own_support = support(offsets, weights, own);
        float most = std::max(kClearly * own_support, own_support + kAtLeast);
        for (std::size_t c = 0; c < kCandidates; ++c) {
          const Vec3f candidate = aligned(before[found[(c + 1) * (found.size() - 1) / kCandidates].index], own);
          if (squared_norm(candidate) == 0 || dot(candidate, own) > kAlike) continue;
          const float s = support(offsets, weights, candidate);
          if (s > most) most = s, best = candidate;
        }
        normals_[slot] = best;
      });
      progress.advance(last - first);
    });
  }

  void average(Progress& progress) {
    const std::vector<Vec3f> before = normals_;
    const std::size_t count = std::clamp<std::size_t>(blur_ / 2, 12, 60);
    const float angle = static_cast<float>(-0.5 / (options_.angle * options_.angle));
    // The height of a neighbour over the plane indicates another face only if it exceeds that of curvature.
    const float height = thickness_ > 0 ? -0.125f / (thickness_ * thickness_) : 0;
    parallel_ranges(0, tree_.size(), kSlots, [&](std::size_t first, std::size_t last) {
      tree_.for_each_nearest(count, first, last, [&](std::uint32_t slot, std::span<const Neighbour> found) {
        const Vec3f own = before[slot];
        if (found.size() < 3 || squared_norm(own) == 0 || !(found.back().squared_distance > 0)) return;
        const float distance = -2 / found.back().squared_distance;
        // Weighted linear regression over the tangent plane: plain averages are biased towards denser samples.
        Vec3f t, b;
        tangent_frame(own, t, b);
        float s0 = 0, su = 0, sv = 0, suu = 0, suv = 0, svv = 0;
        Vec3f n0, nu, nv;
        for (const Neighbour& n : found) {
          const Vec3f other = aligned(before[n.index], own);
          if (squared_norm(other) == 0) continue;
          const Vec3f d = positions_[n.index] - positions_[slot];
          const float h = dot(other, d);
          const float w = std::exp(distance * n.squared_distance + angle * squared_norm(other - own) + height * h * h);
          const float u = dot(d, t), v = dot(d, b);
          s0 += w, su += w * u, sv += w * v, suu += w * u * u, suv += w * u * v, svv += w * v * v;
          n0 += other * w, nu += other * (w * u), nv += other * (w * v);
        }
        if (!(s0 > 0)) return;
        // Value at the sample: Σ w (1 − α u − β v) n, with the moments of the slopes removed. A small ridge limits the
        // extrapolation of slopes by one-sided neighbours at creases.
        const float ridge = 0.1f * (suu + svv);
        const float a00 = suu + ridge, a11 = svv + ridge, determinant = a00 * a11 - suv * suv;
        if (determinant > 0) {
          const float alpha = (su * a11 - sv * suv) / determinant, beta = (sv * a00 - su * suv) / determinant;
          n0 -= nu * alpha + nv * beta;
        }
        if (dot(n0, own) > 0) normals_[slot] = normalized(n0);
      });
      progress.advance(last - first);
    });
  }

  void store(std::vector<Vec3f>& normals) const {
    for (std::size_t slot = 0; slot < normals_.size(); ++slot) normals[tree_.order()[slot]] = normals_[slot];
  }
  std::size_t size() const { return tree_.size(); }

 private:
  /// Support of a plane with this normal: Geman–McClure weights of the neighbours' heights over it. The sample itself
  /// deviates from the surface by noise, so the plane may be shifted.
  float support(std::span<const Vec3f> offsets, std::span<const float> weights, const Vec3f& normal) const {
    float shift = 0, sum = 0;
    for (int round = 0; round < (noisy_ ? 2 : 1); ++round) {
      const float scale = round == 0 && noisy_ ? 0.5f / thickness_ : 1 / thickness_;
      float moment = 0;
      sum = 0;
      for (std::size_t i = 0; i < offsets.size(); ++i) {
        const float height = dot(offsets[i], normal), h = (height - shift) * scale, t = 1 + h * h;
        const float w = weights[i] / (t * t);
        sum += w;
        moment += w * height;
      }
      if (sum > 0) shift = moment / sum;
    }
    return sum;
  }

  NormalDenoisingOptions options_;
  KdTree tree_;
  std::vector<Vec3f> positions_, normals_;  ///< in tree order
  std::size_t blur_ = 0;
  float thickness_ = 0;
  bool noisy_ = false;
};

}  // namespace

void NormalDenoisingOptions::validate() const {
  if (neighbours) check_range("neighbours", *neighbours, 6, 240);
  check_range("rounds", rounds, 0, 20);
  if (!(angle > 0 && angle <= std::numbers::pi / 2)) throw ArgumentError("`angle` must lie in (0, π/2]");
  if (spacing && !(*spacing >= 0)) throw ArgumentError("`spacing` must not be negative");
  if (noise && !(*noise >= 0)) throw ArgumentError("`noise` must not be negative");
}

void denoise_normals(PointSet& points, const NormalDenoisingOptions& options, Progress& progress) {
  options.validate();
  if (points.normals.size() != points.size()) throw DataError("there are no normals to denoise");
  NormalDenoiser denoiser(points, options);
  const auto rounds = static_cast<std::size_t>(options.rounds);
  progress.begin("denoise normals", denoiser.size() * (rounds + (options.vote ? 1 : 0)));
  if (options.vote) denoiser.vote(progress);
  for (std::size_t round = 0; round < rounds; ++round) denoiser.average(progress);
  denoiser.store(points.normals);
  progress.finish();
}

}  // namespace sansmesh::inline v1
