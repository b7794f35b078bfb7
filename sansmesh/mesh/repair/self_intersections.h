// Self-intersections of a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Intersecting pairs of triangles (lower index first, ascending): an edge of one passes through the other, with both
/// ends farther than `tolerance` (length) from its plane. Ignores triangles with a common edge; of triangles with a
/// common vertex, tests only the edges opposite to it. Parallel; about n log n for meshes with few intersections.
std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriangleMesh& mesh, double tolerance);

/// Number of intersecting pairs. Calls found(a, b) for each, concurrently and in any order, without storing them.
std::size_t count_self_intersections(const TriangleMesh& mesh, double tolerance,
                                     const std::function<void(std::uint32_t, std::uint32_t)>& found);

}  // namespace sansmesh::inline v1
