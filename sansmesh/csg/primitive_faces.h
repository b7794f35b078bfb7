// Faces of primitives.
#pragma once

#include <cstddef>

#include "sansmesh/data/boolean_expression.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Polygons with this number of sides do not reach the error.
constexpr std::size_t kMostSides = 1 << 14;

/// Sides of a regular polygon in a circle of this radius, whose mean distance from the circle is `error`; a multiple
/// of 4.
std::size_t sides_of_circle(double radius, double error);
/// Edges along a quarter of a great circle of a ball, for triangles with this mean distance from it.
std::size_t edges_of_quarter(double radius, double error);

/// Vertices are slightly outside of the primitive, so that sections have its area (balls its volume): for equal errors
/// there are less than half as many triangles as with vertices on the surface.
SolidFaces ball_faces(const Vec3& center, double radius, std::size_t edges);
SolidFaces box_faces(const Vec3& lower, const Vec3& upper);
/// Radii `bottom` and `top`, of which one may be 0, at −half_height and half_height along the unit vector `axis`.
SolidFaces frustum_faces(const Vec3& center, const Vec3& axis, double bottom, double top, double half_height,
                         std::size_t sides);
SolidFaces ring_faces(const Vec3& center, const Vec3& axis, double ring, double tube, std::size_t sides_of_ring,
                      std::size_t sides_of_tube);
SolidFaces rod_faces(const Vec3& from, const Vec3& to, double radius, std::size_t sides);
/// The part of the half-space ⟨x, normal⟩ ≤ offset in a box that contains the ball; no faces if there is none.
SolidFaces half_space_faces(const Vec3& normal, double offset, const Vec3& center, double radius);

}  // namespace sansmesh::inline v1
