// Triangles that fill curves in a plane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct PlanarFill {
  std::vector<std::array<double, 2>> points;  ///< those given, loop after loop, and then those added inside
  std::vector<Triangle> triangles;            ///< counter-clockwise
};

/// What closed curves bound: outer ones run counter-clockwise, holes clockwise, each without its first point repeated.
/// They must not cross each other. Ears are clipped, then edges turned until they are Delaunay, and inner ones longer
/// than `length` cut in half, except where long edges of the curves are near: these stay as they are. Curves without
/// three points, and holes within no outer curve, are left out. Time grows with the square of the number of points of a
/// curve.
///
/// Inner edges between two of the points whose entry in `apart` (one for each that is given, or none) is not 0 are cut
/// in half, however short: so that two sheets that share these points share no edge.
PlanarFill fill_planar(const std::vector<std::vector<std::array<double, 2>>>& loops, double length,
                       std::span<const std::uint8_t> apart = {});

}  // namespace sansmesh::inline v1
