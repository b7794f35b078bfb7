// Sample patterns of a pixel's rays: even patterns on discs and around directions, a different subset for each pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Radius in pixels of the filter that smooths noisy light.
constexpr int kSmooth = 2;

struct Spot {
  float x = 0, y = 0;
};

/// Points of the unit disc; each consecutive range is evenly spread: the additive recurrence by the plastic number
/// (Roberts 2018).
std::vector<Spot> spread_over_disc(int count);

/// Subset of the pattern for each pixel of the 5 × 5 square over which the picture is smoothed. The square contains the
/// whole pattern at any position, so that no grain is left.
constexpr int kParts = (2 * kSmooth + 1) * (2 * kSmooth + 1);
inline int pattern_part(int x, int y) {
  x += 5 * kSmooth, y += 5 * kSmooth;  // coordinates of the rim are negative
  return 5 * ((x + 2 * y) % 5) + (2 * x + y) % 5;
}

/// Directions around a unit vector.
struct Around {
  Vec3f n, t, b;
  explicit Around(const Vec3f& axis) : n(axis) { tangent_frame(n, t, b); }
  /// Points spread evenly over the disc give cosine-distributed directions.
  Vec3f operator()(const Spot& p) const {
    return p.x * t + p.y * b + std::sqrt(std::max(0.0f, 1 - p.x * p.x - p.y * p.y)) * n;
  }
};

}  // namespace sansmesh::inline v1
