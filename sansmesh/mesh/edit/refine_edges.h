// Bisection of long edges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Repeatedly bisects edges longer than `length` and their triangles, without opening seams, so that a map also acts on
/// the interior of large triangles. Interpolates vertex attributes; parts of triangles keep the attributes of the
/// triangle. Stops before exceeding `most_triangles`; returns whether all edges became short enough. Throws
/// ArgumentError unless length > 0.
bool refine_edges(TriangleMesh& mesh, double length, std::size_t most_triangles = 20000000);

/// One round: bisects the edges selected by `to_split` (called with both vertices, smaller index first, possibly
/// repeatedly; must return the same result each time). Returns the number of added triangles; nothing, without changes,
/// if there would be more than `most_triangles`.
std::optional<std::size_t> split_edges(TriangleMesh& mesh,
                                       const std::function<bool(std::uint32_t, std::uint32_t)>& to_split,
                                       std::size_t most_triangles = 20000000);

}  // namespace sansmesh::inline v1
