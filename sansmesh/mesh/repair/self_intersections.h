// Where a mesh cuts through itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Pairs of triangles (the lower number first, in ascending order) of which an edge of one goes through the other, with
/// its ends farther than `tolerance` (length) from that one's plane. Triangles that share an edge are not looked at, of
/// those that share a vertex only the edges opposite to it. Parallel; about n log n for meshes without too many.
std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriangleMesh& mesh, double tolerance);

/// How many these are. Calls found(a, b) for each, from several threads at once and in no order; keeps none.
std::size_t count_self_intersections(const TriangleMesh& mesh, double tolerance,
                                     const std::function<void(std::uint32_t, std::uint32_t)>& found);

}  // namespace sansmesh::inline v1
