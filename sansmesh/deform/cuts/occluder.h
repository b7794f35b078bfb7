// Cuts: surfaces that block the influence of handles.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Extra length of the path from a handle to a point around an occluder.
struct Detour {
  double extra = 0;  ///< length of the path minus the distance, >= 0; 0 where the handle is visible
  Vec3 gradient;     ///< gradient of `extra` with respect to the point; zero where it is 0
};

/// Whether a point and its source are separated by an occluder.
struct Gap {
  double depth = 0;  ///< above 0 where separated; near the faces of the gap approximately the distance from them
  Vec3 gradient;     ///< gradient of `depth` with respect to the point
};

class Occluder {
 public:
  virtual ~Occluder() = default;

  /// Detours from `handle` to each x, over all paths around the occluder. Continuous in x except across the occluder
  /// itself; falls to 0 where x leaves its shadow. As many entries as x. Thread-safe.
  virtual void detours(const Vec3& handle, std::span<const Vec3> x, std::span<Detour> found) const = 0;

  /// Gaps at points x with their `sources` and the derivatives of these with respect to x ([k] = ∂source/∂x_k; empty if
  /// no gradients are needed). −infinity where neither is near the occluder. As many entries as x. Thread-safe.
  virtual void gaps(std::span<const Vec3> x, std::span<const Vec3> sources,
                    std::span<const std::array<Vec3, 3>> jacobians, std::span<Gap> found) const = 0;

  /// Appends the parameters, 0..1 and increasing, at which the segment from a to b crosses the occluder. Thread-safe.
  virtual void crossings(const Vec3& a, const Vec3& b, std::vector<double>& found) const = 0;

  /// Appends the points at which the border of the occluder crosses the triangle (a, b, c). Thread-safe.
  virtual void border_points(const Vec3& a, const Vec3& b, const Vec3& c, std::vector<Vec3>& found) const = 0;
};

}  // namespace sansmesh::inline v1
