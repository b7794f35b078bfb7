// Triangulates regions bounded by planar curves.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct PlanarFill {
  std::vector<std::array<double, 2>> points;  ///< given points, loop by loop, then added interior points
  std::vector<Triangle> triangles;            ///< counter-clockwise
};

/// Triangulates the region bounded by closed curves that do not intersect: outer curves run counter-clockwise, holes
/// clockwise, each without a repeated first point. Ear clipping, then edge flips until the triangulation is Delaunay.
/// Bisects inner edges longer than `length`, except near long boundary edges, which stay unchanged. Ignores curves with
/// fewer than three points, and holes outside all outer curves. The time is quadratic in the number of points of a
/// curve.
///
/// Also bisects inner edges of any length between two points whose entry in `apart` (one per given point, or none) is
/// not 0: two sheets that share these points then share no edge.
PlanarFill fill_planar(const std::vector<std::vector<std::array<double, 2>>>& loops, double length,
                       std::span<const std::uint8_t> apart = {});

}  // namespace sansmesh::inline v1
