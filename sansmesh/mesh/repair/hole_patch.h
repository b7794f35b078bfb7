// Triangulates the filling of one hole.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Vertices are numbered along the loop; new vertices follow.
using PatchTriangle = std::array<std::uint32_t, 3>;

/// Boundary of a hole. Vertex i of the loop is at x[i].
struct HoleRim {
  std::span<const Vec3> x;
  std::span<const Vec3> beside;  ///< opposite corner of the mesh triangle at edge (i, i + 1)
  /// Whether the mesh has an edge between two vertices of the loop that are not adjacent in it.
  std::function<bool(std::uint32_t, std::uint32_t)> joined;
};

/// Triangulation with the fewest edges that the mesh already has, then the least maximal angle between neighbours, and
/// among these of least area. Dynamic programming in n³ steps for up to kWholeLoop vertices; of longer loops, vertices
/// are clipped before, flat triangles and short edges first.
std::vector<PatchTriangle> triangulate_hole(const HoleRim& rim);
inline constexpr std::size_t kWholeLoop = 240;

/// Splits edges between vertices of the loop that the mesh already has, at new vertices appended to x and `scale`.
void split_existing_edges(std::vector<PatchTriangle>& triangles, std::vector<Vec3>& x, std::vector<double>& scale,
                          const std::function<bool(std::uint32_t, std::uint32_t)>& joined);

/// Subdivides triangles larger than the edges around the hole, and flips edges, until they have that size. Appends new
/// positions to x, whose first vertices are the loop's; `scale`, extended likewise, is the mean edge length of the mesh
/// at each vertex. Adds at most `most` vertices.
void refine_patch(std::vector<PatchTriangle>& triangles, std::vector<Vec3>& x, std::vector<double>& scale,
                  std::size_t loop, std::size_t most, const std::function<bool(std::uint32_t, std::uint32_t)>& joined);

/// Moves the vertices from `loop` on to minimise the squared Laplacian over all vertices of the patch. `outside` are
/// triangles around the hole; their vertices beyond those of the patch have fixed positions `around`. Returns whether
/// the system could be solved.
bool fair_patch(std::span<const PatchTriangle> triangles, std::span<const PatchTriangle> outside,
                std::span<const Vec3> around, std::size_t loop, std::vector<Vec3>& x);

}  // namespace sansmesh::inline v1::detail
