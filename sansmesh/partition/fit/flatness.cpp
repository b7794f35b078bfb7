#include "sansmesh/partition/fit/flatness.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sansmesh::inline v1 {
namespace {

constexpr float kBottomless = std::numeric_limits<float>::infinity();
constexpr float kSecondSheet = 0.2f;  ///< least share of the samples in a block on another sheet
/// Mean gap along a crease of 20° or more, in units of the block's edge; proportional to smaller angles.
constexpr float kChamfer = 0.02f, kChamferAngle = 0.35f;

/// A triangle of edge e on a surface of curvature κ leaves a gap of κ e²/8. A plane fitted to a disc of radius R leaves
/// an rms of 0.097 κ R² with the weights (1 − t²)², plus the noise. Only half of the noise is subtracted, because its
/// estimate is not exact enough to conclude that a plane residual that is mostly noise is flat. h: edge of the block.
float gap_of(const Trial& t, float noise, float radius, float h) {
  if (t.plane() < 0) return kBottomless;
  const float bent = std::sqrt(std::max(0.0f, t.plane() - 0.5f * noise));
  return bent / (0.097f * radius * radius) * h * h / 32;
}

}  // namespace

float flatness_gap(const BlockFitter& fitter, const ScaleChoice& choice, int level, std::uint32_t cell) {
  const Trial& t = choice.trials[static_cast<std::size_t>(level)][cell];
  if (t.dropped > kSecondSheet) return kBottomless;
  // Samples that face away are a second sheet, or a surface that bends by more than a right angle.
  const float noise = t.noise >= 0 ? t.noise : static_cast<float>(choice.variance);
  const float radius = fitter.fit_radius(level);
  return gap_of(t, noise, t.reach * radius, fitter.block_edge(level)) + 0.2f * t.dropped * radius;
}

void mark_crease(const std::vector<std::vector<std::uint64_t>>& code, std::vector<std::vector<float>>& gap, float edge,
                 int level, std::uint64_t block, float least_cosine) {
  const float chamfer = kChamfer * std::min(1.0f, std::acos(std::clamp(least_cosine, -1.0f, 1.0f)) / kChamferAngle);
  for (int l = 0; l < static_cast<int>(code.size()); ++l) {
    const auto& codes = code[static_cast<std::size_t>(l)];
    auto& gaps = gap[static_cast<std::size_t>(l)];
    const std::uint64_t low = l <= level ? block >> (3 * (level - l)) : block << (3 * (l - level));
    const std::uint64_t high = l <= level ? low : low + (std::uint64_t{1} << (3 * (l - level))) - 1;
    for (auto it = std::lower_bound(codes.begin(), codes.end(), low); it != codes.end() && *it <= high; ++it) {
      float& g = gaps[static_cast<std::size_t>(it - codes.begin())];
      g = std::max(g, chamfer * edge / static_cast<float>(1u << l));
    }
  }
}

}  // namespace sansmesh::inline v1
