// Long edges cut in half.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Cuts edges longer than `length` in half, again and again, together with the triangles at them, without opening
/// seams: so that a map reaches the middle of large triangles. Attributes of vertices are interpolated, those of
/// triangles go to their parts. Stops before there are more than `most_triangles`; returns whether all edges became
/// short enough. Throws ArgumentError unless length > 0.
bool refine_edges(TriangleMesh& mesh, double length, std::size_t most_triangles = 20000000);

/// One round of it: cuts the edges in half that `to_split` chooses (asked for the two vertices, the smaller number
/// first, several times, the same answer each time). Returns by how many the triangles became more, nothing, and
/// leaves the mesh as it is, if there would be more than `most_triangles`.
std::optional<std::size_t> split_edges(TriangleMesh& mesh,
                                       const std::function<bool(std::uint32_t, std::uint32_t)>& to_split,
                                       std::size_t most_triangles = 20000000);

}  // namespace sansmesh::inline v1
