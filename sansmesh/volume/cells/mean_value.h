// Mean value coordinates in polyhedra with triangular faces (floater2005, ju2005).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Weights of the corners at x, and their gradients unless `slopes` is empty. Triangles index corners,
/// counter-clockwise from outside, and bound the polyhedron, convex or not. Weights sum to 1 and reproduce linear
/// functions; on a triangle they are its barycentric coordinates; in a tetrahedron they are those of the tetrahedron.
/// At most 8 corners. Very close to faces the gradient is evaluated a ten-thousandth of the way towards the centre of
/// the polyhedron.
void mean_value_weights(std::span<const Vec3> corners, std::span<const std::array<std::uint8_t, 3>> triangles,
                        const Vec3& x, std::span<double> weights, std::span<Vec3> slopes);

}  // namespace sansmesh::inline v1::detail
