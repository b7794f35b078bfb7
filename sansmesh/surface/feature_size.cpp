#include "sansmesh/surface/feature_size.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/box.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kRounds = 30;
constexpr float kContact = 2;  // nearer contacts (in spacings) are noise, not another part of the surface
constexpr std::size_t kFeatureNeighbours = 12;
constexpr int kSpreads = 4;

float shrink_ball(const SurfaceSamples& s, std::size_t i, float sign, float largest) {
  const Vec3f p = s.positions[i], n = s.normals[i] * sign;
  float radius = largest;
  for (int round = 0; round < kRounds; ++round) {
    const Vec3f center = p + n * radius;
    std::array<Neighbour, 2> found;
    const std::size_t count = s.tree.nearest(center, found);
    std::size_t k = 0;
    while (k < count && found[k].index == i) ++k;
    if (k == count || found[k].squared_distance >= radius * radius * (1 - 1e-4f)) break;
    const Vec3f d = s.positions[found[k].index] - p;
    const float depth = dot(d, n);
    if (!(depth > 0) || squared_norm(d) < kContact * kContact * s.spacing[i] * s.spacing[i]) break;
    radius = squared_norm(d) / (2 * depth);
  }
  return radius;
}

}  // namespace

std::vector<float> estimate_feature_size(const SurfaceSamples& samples, Progress& progress) {
  Box3f box;
  for (const Vec3f& p : samples.positions) box.extend(p);
  const float largest = 0.5f * box.diagonal();
  const std::size_t n = samples.size();
  std::vector<float> size(n), next(n);
  progress.begin("feature size", n);
  parallel_ranges(0, n, 2048, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      size[i] = std::min(shrink_ball(samples, i, 1, largest), shrink_ball(samples, i, -1, largest));
    progress.advance(last - first);
  });
  // A ball that missed its contact is too large: the size at x is at most that at y plus ‖x − y‖.
  for (int round = 0; round < kSpreads; ++round) {
    samples.tree.for_each_nearest(kFeatureNeighbours, [&](std::uint32_t slot, std::span<const Neighbour> found) {
      const std::uint32_t i = samples.tree.order()[slot];
      float least = size[i];
      for (const Neighbour& f : found)
        least = std::min(least, size[samples.tree.order()[f.index]] + std::sqrt(f.squared_distance));
      next[i] = least;
    });
    size.swap(next);
  }
  progress.finish();
  return size;
}

}  // namespace sansmesh::inline v1
