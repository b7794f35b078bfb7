// Triangles that fill curves in a plane.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sansmesh/data/triangle_mesh.h"

namespace sansmesh {

struct PlanarFill {
  std::vector<std::array<double, 2>> points;  ///< those given, loop after loop, and then those added inside
  std::vector<Triangle> triangles;            ///< counter-clockwise
};

/// What closed curves bound: outer ones run counter-clockwise, holes clockwise, each without its first point repeated.
/// They must not cross each other. Ears are clipped, then edges turned until they are Delaunay, and inner ones longer
/// than `length` cut in half, except where long edges of the curves are near: these stay as they are. Curves without
/// three points, and holes within no outer curve, are left out. Time grows with the square of the number of points of a
/// curve.
PlanarFill fill_planar(const std::vector<std::vector<std::array<double, 2>>>& loops, double length);

}  // namespace sansmesh
