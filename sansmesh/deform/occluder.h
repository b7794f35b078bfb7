// Cuts: surfaces that a deformation does not reach through.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// How much longer the way from a handle to a place is for going around an occluder.
struct Detour {
  double extra = 0;  ///< length of the way less the distance, >= 0; 0 where the one sees the other
  Vec3 gradient;     ///< of `extra` by the place; zero where it is 0
};

/// Whether what is at one place comes from another across an occluder.
struct Gap {
  double depth = 0;  ///< above 0 where it does; near the faces of the gap about the distance from them
  Vec3 gradient;     ///< by the place
};

class Occluder {
 public:
  virtual ~Occluder() = default;

  /// Of all ways around from `handle` to each of x. Continuous in x but across the occluder itself, and where x leaves
  /// its shadow it falls to 0. As many entries as x. Safe from several threads.
  virtual void detours(const Vec3& handle, std::span<const Vec3> x, std::span<Detour> found) const = 0;

  /// For places x whose matter comes from `sources`, with the derivatives of these by x ([k] = ∂source/∂x_k; empty
  /// where no gradients are wanted). −infinity where neither is near the occluder. As many entries as x. Safe from
  /// several threads.
  virtual void gaps(std::span<const Vec3> x, std::span<const Vec3> sources,
                    std::span<const std::array<Vec3, 3>> jacobians, std::span<Gap> found) const = 0;

  /// Where the segment from a to b crosses the occluder: appends shares of its length, 0..1, increasing. Safe from
  /// several threads.
  virtual void crossings(const Vec3& a, const Vec3& b, std::vector<double>& found) const = 0;

  /// Where the border of the occluder passes through the triangle (a, b, c): appends these points. Safe from several
  /// threads.
  virtual void border_points(const Vec3& a, const Vec3& b, const Vec3& c, std::vector<Vec3>& found) const = 0;
};

}  // namespace sansmesh::inline v1
