// Where the rays of a pixel go: even patterns on discs and around directions, another part of them for each pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Pixels to each side over which light that few rays make noisy is smoothed.
constexpr int kSmooth = 2;

struct Spot {
  float x = 0, y = 0;
};

/// Points of the unit disc, evenly spread from any one on: the additive recurrence by the plastic number (Roberts
/// 2018).
std::vector<Spot> spread_over_disc(int count);

/// Another part of the pattern for each pixel of a 5 × 5 square, over which the picture is smoothed: wherever that
/// window lies, it holds the whole pattern, and hence no grain is left.
constexpr int kParts = (2 * kSmooth + 1) * (2 * kSmooth + 1);
inline int pattern_part(int x, int y) {
  x += 5 * kSmooth, y += 5 * kSmooth;  // the rim lies at negative places
  return 5 * ((x + 2 * y) % 5) + (2 * x + y) % 5;
}

/// Directions around a unit vector.
struct Around {
  Vec3f n, t, b;
  explicit Around(const Vec3f& axis) : n(axis) { tangent_frame(n, t, b); }
  /// Spots spread evenly over the disc give directions distributed like the cosine.
  Vec3f operator()(const Spot& p) const {
    return p.x * t + p.y * b + std::sqrt(std::max(0.0f, 1 - p.x * p.x - p.y * p.y)) * n;
  }
};

}  // namespace sansmesh::inline v1
