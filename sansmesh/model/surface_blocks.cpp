#include "sansmesh/model/surface_blocks.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "sansmesh/search/ball_tree.h"
#include "sansmesh/triangulation/divide_blocks.h"

namespace sansmesh::inline v1 {
namespace {

/// Balls that require fine blocks: this fraction of the radius within which the surface is defined.
constexpr double kBlockReach = 0.4;
/// Edge of a block over the local spacing, for coarseness 1; and over the width of the weight functions if these are
/// wider: the surface has no finer features.
constexpr double kBlockEdge = 1.4, kThinBlockEdge = 1.2;
constexpr int kDeepest = 13;
/// Margin around a block, in edges, within which its flatness is tested.
constexpr double kFlatMargin = 0.25;
/// Least cosine between a normal around a flat block and their mean: a single sheet without folds.
constexpr double kAlike = 0.87;
/// Cosine between normals on the two sides of a wall, at most.
constexpr float kOpposite = -0.85f;
/// A surface of curvature κ leaves a gap of κe²/8 at the middle of triangles of edge e, and rises by κR²/2 within R =
/// 1.1 e, block and margin: 4.8 times that. The mean gap is two thirds of the largest, and half of this where triangles
/// straddle the surface.
constexpr double kHeightOverGap = 14;
/// Largest ratio of a flat block to the local finest ones, so that the region between samples is still visited.
constexpr double kLargest = 16;

/// Tests where large triangles suffice.
struct Flatness {
  const PointSet& feet;
  double most;

  /// Whether the samples are on both sides of a wall: whether any normal opposes that which deviates most from the
  /// first, which may be on the rim.
  bool two_sided(std::span<const std::uint32_t> samples) const {
    const auto cosine = [&](std::uint32_t i, std::uint32_t j) { return dot(feet.normals[i], feet.normals[j]); };
    const std::uint32_t first = samples.front();
    const std::uint32_t side = *std::min_element(samples.begin(), samples.end(), [&](std::uint32_t i, std::uint32_t j) {
      return cosine(i, first) < cosine(j, first);
    });
    return std::any_of(samples.begin(), samples.end(), [&](std::uint32_t i) { return cosine(i, side) < kOpposite; });
  }

  /// Whether triangles of this edge length are accurate enough for these samples.
  bool holds(std::span<const std::uint32_t> samples) const {
    Vec3 normal, middle;
    for (const std::uint32_t i : samples) normal += Vec3(feet.normals[i]), middle += Vec3(feet.positions[i]);
    normal = normalized(normal);
    middle = middle / static_cast<double>(samples.size());
    double least = 0, largest = 0;
    for (const std::uint32_t i : samples) {
      if (dot(Vec3(feet.normals[i]), normal) < kAlike) return false;
      const double height = dot(Vec3(feet.positions[i]) - middle, normal);
      least = std::min(least, height), largest = std::max(largest, height);
      if (largest - least > kHeightOverGap * most) return false;
    }
    return true;
  }
};

}  // namespace

BlockTree surface_blocks(const SurfaceSupport& surface, double coarseness, const std::optional<FlatSurface>& flat) {
  const BallUnion& balls = surface.balls;
  const std::span<const float> spacing = surface.spacings;
  const std::optional<Flatness> flatness = flat ? std::optional(Flatness{flat->feet, flat->error}) : std::nullopt;
  std::vector<float> radii = balls.radii;
  for (float& r : radii) r *= static_cast<float>(kBlockReach);
  // For the partition, the supports determine the resolution: about four blocks across each.
  const auto spacing_at = [&](std::uint32_t i) {
    return static_cast<double>(spacing.empty() ? balls.radii[i] / 4 : spacing[i]);
  };
  const BallTree near(balls.centers, radii);
  const Box3& box = surface.bounds;
  const Vec3 size = box.size();
  const double edge = 1.02 * std::max({size.x, size.y, size.z});
  const Vec3 middle = box.center();
  BlockTree tree(middle - Vec3{edge, edge, edge} * 0.5, edge);
  const auto divides = [&](std::size_t block, std::vector<std::uint32_t>& touched) {
    const double e = tree.block_edge(block);
    const auto touching = [&](double margin) {
      const double half = (0.5 + margin) * e;
      const Vec3 center = tree.block_center(block), h{half, half, half};
      near.touching({Vec3f(center - h), Vec3f(center + h)}, touched);
    };
    touching(0);
    if (touched.empty()) return false;
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : touched) least = std::min(least, spacing_at(i));
    const double finest = kBlockEdge * std::max(1.0, flat ? surface.smoothing : 0) * coarseness * least;
    if (!flat) return e > finest;
    if (e > kLargest * finest) return true;
    touching(kFlatMargin);
    // Smoothing leaves no finer features along the surface, but does not thicken walls. Sharp edges of wedges are
    // placed better with triangles no finer than the samples.
    if (e <= finest) return e > kThinBlockEdge * coarseness * least && !surface.sharp && flatness->two_sided(touched);
    return !flatness->holds(touched);
  };
  divide_blocks(tree, kDeepest, divides);
  return tree;
}

}  // namespace sansmesh::inline v1
