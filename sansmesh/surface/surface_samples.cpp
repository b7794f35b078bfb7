#include "sansmesh/surface/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/points/statistics/noise.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kNeighbours = 16;
constexpr std::size_t kFewest = 9;

/// Noise over spacing above which normals are smoothed once, and above which twice.
constexpr double kSomeNoise = 0.1, kMuchNoise = 0.4;

/// Evenness of even samples, and of random ones.
constexpr double kEven = 0.85, kRandom = 0.5;

/// Lower bound, because distances between duplicates vanish.
constexpr double kLeastSpacing = 0.05;

}  // namespace

SurfaceSamples prepare_samples(const PointSet& points, Progress& progress, std::optional<double> noise) {
  if (!points.has_normals()) throw DataError("the samples have no normals: estimate and orient them first");
  progress.begin("prepare samples");
  std::vector<std::uint32_t> good;
  std::vector<Vec3f> positions;
  good.reserve(points.size()), positions.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_finite(points.positions[i]) || !is_finite(points.normals[i]) || points.normals[i] == Vec3f{}) continue;
    good.push_back(static_cast<std::uint32_t>(i));
    positions.push_back(points.positions[i]);
  }
  if (good.size() < kFewest)
    throw DataError("only " + std::to_string(good.size()) + " samples have a position and a normal: at least " +
                    std::to_string(kFewest) + " are needed");

  SurfaceSamples s;
  {
    const KdTree order(positions);
    const std::size_t n = good.size();
    s.positions.resize(n), s.normals.resize(n), s.source.resize(n);
    parallel_for(0, n, 16384, [&](std::size_t slot) {
      const std::uint32_t i = order.order()[slot];
      s.positions[slot] = positions[i];
      s.source[slot] = good[i];
      s.normals[slot] = normalized(points.normals[good[i]]);
    });
  }
  s.tree = KdTree(s.positions);
  const std::size_t k = std::min(kNeighbours + 1, s.size());
  std::vector<float> raw(s.size()), smooth(s.size()), nearest(s.size());
  std::vector<std::uint32_t> around(s.size() * k);
  s.tree.for_each_nearest(k, [&](std::uint32_t slot, std::span<const Neighbour> found) {
    const std::uint32_t i = s.tree.order()[slot];
    const double d2 = static_cast<double>(found.back().squared_distance);
    raw[i] = static_cast<float>(std::sqrt(std::numbers::pi * d2 / static_cast<double>(k - 1)));
    nearest[i] = std::sqrt(found[1].squared_distance);
    for (std::size_t j = 0; j < k; ++j) around[i * k + j] = s.tree.order()[found[j].index];
  });
  smooth = raw;
  s.median_spacing = static_cast<double>(median(smooth));
  if (!(s.median_spacing > 0)) throw DataError("most samples coincide: there is no surface");
  s.evenness = static_cast<double>(median(nearest)) / s.median_spacing;
  const auto least = static_cast<float>(kLeastSpacing * s.median_spacing);
  for (float& r : raw) r = std::max(r, least);
  parallel_for(0, s.size(), 4096, [&](std::size_t i) {
    float sum = 0;
    for (std::size_t j = 0; j < k; ++j) sum += raw[around[i * k + j]];
    smooth[i] = sum / static_cast<float>(k);
  });
  s.spacing = std::move(smooth);
  s.noise = noise ? *noise : estimate_noise(points);
  progress.finish();
  return s;
}

void smooth_normals(SurfaceSamples& samples, double smoothing, int rounds) {
  std::vector<Vec3f> next(samples.size());
  for (int round = 0; round < rounds; ++round) {
    parallel_ranges(0, samples.size(), 1024, [&](std::size_t first, std::size_t last) {
      std::vector<Neighbour> near;
      for (std::size_t i = first; i < last; ++i) {
        const float radius = 2 * static_cast<float>(smoothing) * samples.spacing[i];
        samples.tree.within(samples.positions[i], radius, near);
        Vec3f sum;
        for (const Neighbour& j : near) {
          const float t = 1 - j.squared_distance / (radius * radius);
          const Vec3f& n = samples.normals[j.index];
          sum += t * t * t * t * std::max(0.0f, dot(samples.normals[i], n)) * n;
        }
        next[i] = squared_norm(sum) > 0 ? normalized(sum) : samples.normals[i];
      }
    });
    samples.normals.swap(next);
  }
}

void smooth_noisy_normals(SurfaceSamples& samples, double smoothing) {
  const double ratio = samples.noise / samples.median_spacing;
  if (ratio > kSomeNoise) smooth_normals(samples, smoothing, ratio > kMuchNoise ? 2 : 1);
}

void move_to_means(SurfaceSamples& samples, double smoothing) {
  std::vector<Vec3f> next(samples.size());
  parallel_ranges(0, samples.size(), 1024, [&](std::size_t first, std::size_t last) {
    std::vector<Neighbour> near;
    for (std::size_t i = first; i < last; ++i) {
      const float radius = 2 * static_cast<float>(smoothing) * samples.spacing[i];
      const Vec3f& n = samples.normals[i];
      samples.tree.within(samples.positions[i], radius, near);
      float height = 0, total = 0;
      for (const Neighbour& j : near) {
        const float t = 1 - j.squared_distance / (radius * radius);
        const float w = t * t * t * t * std::max(0.0f, dot(n, samples.normals[j.index]));
        height += w * dot(n, samples.positions[j.index] - samples.positions[i]);
        total += w;
      }
      next[i] = samples.positions[i] + (total > 0 ? height / total : 0) * n;
    }
  });
  samples.positions.swap(next);
}

void move_noisy_to_means(SurfaceSamples& samples, double smoothing) {
  if (samples.noise > kSomeNoise * samples.median_spacing) move_to_means(samples, smoothing);
}

double unevenness(const SurfaceSamples& samples) {
  return std::clamp((kEven - samples.evenness) / (kEven - kRandom), 0.0, 1.0);
}

double default_reach(const SurfaceSamples& samples) {
  return std::min(1.2 + 0.8 * unevenness(samples) + 1.5 * samples.noise / samples.median_spacing, 3.0);
}

}  // namespace sansmesh::inline v1
