// Shared by tests of cuts.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "sansmesh/deform/cuts/occluder.h"
#include "sansmesh/deform/cuts/planar_occluder.h"

namespace sansmesh::test {

inline Vec3 random_point(std::mt19937& random, double size = 1) {
  std::uniform_real_distribution<double> in(-size, size);
  const double x = in(random), y = in(random), z = in(random);
  return {x, y, z};
}

inline Detour detour(const Occluder& cut, const Vec3& handle, const Vec3& x) {
  Detour found;
  cut.detours(handle, {&x, 1}, {&found, 1});
  return found;
}

inline Gap gap(const Occluder& cut, const Vec3& x, const Vec3& source, const std::array<Vec3, 3>& jacobian) {
  Gap found;
  cut.gaps({&x, 1}, {&source, 1}, {&jacobian, 1}, {&found, 1});
  return found;
}

inline bool blocked(const Occluder& cut, const Vec3& a, const Vec3& b) {
  std::vector<double> found;
  cut.crossings(a, b, found);
  return !found.empty();
}

/// A tilted L with a square hole.
inline const std::vector<std::vector<Vec3>>& l_shape() {
  static const std::vector<std::vector<Vec3>> loops = [] {
    const std::vector<std::vector<std::array<double, 2>>> flat = {
        {{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0}, {0.1, 0}, {0.1, 0.9}, {-0.9, 0.9}},
        {{-0.6, -0.6}, {-0.2, -0.6}, {-0.2, -0.3}, {-0.6, -0.3}}};
    const Vec3 n = normalized(Vec3{0.3, -0.2, 1});
    Vec3 a, b;
    tangent_frame(n, a, b);
    std::vector<std::vector<Vec3>> made;
    for (const auto& loop : flat) {
      made.emplace_back();
      for (const auto& [u, v] : loop) made.back().push_back(Vec3{0.1, 0.05, -0.02} + a * u + b * v);
    }
    return made;
  }();
  return loops;
}

inline std::shared_ptr<const PlanarOccluder> tilted_half_plane() {
  return half_plane({0.1, -0.2, 0.05}, {0.2, 0.4, 1}, {1, 0.3, 0.1});
}

/// The gradient of a depth by differences; none at a kink.
template <class Depth>
std::optional<Vec3> depth_slopes(const Depth& depth, const Vec3& x, double here) {
  Vec3 slopes;
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 step;
    step[k] = 1e-6;
    const double ahead = depth(x + step) - here, behind = here - depth(x - step);
    if (std::abs(ahead - behind) > 1e-9) return std::nullopt;
    slopes[k] = (ahead + behind) / 2e-6;
  }
  return slopes;
}

}  // namespace sansmesh::test
