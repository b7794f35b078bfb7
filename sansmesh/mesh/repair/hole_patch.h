// The triangles that fill one hole.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Vertices are numbered along the loop; new ones follow.
using PatchTriangle = std::array<std::uint32_t, 3>;

/// What is known of the surroundings of a hole. Vertex i of the loop is at x[i].
struct HoleRim {
  std::span<const Vec3> x;
  std::span<const Vec3> beside;  ///< of the edge from i to i + 1: the corner opposite in the border's triangle
  /// Whether the mesh has an edge between two vertices of the loop that are not neighbours in it.
  std::function<bool(std::uint32_t, std::uint32_t)> joined;
};

/// Triangles whose largest angle to a neighbour is least, and among these the ones of least area: by dynamic
/// programming, in n³ steps, up to kWholeLoop vertices; of longer loops first over some vertices, then over the parts
/// between these. Empty where every way needs an edge that the mesh has already.
std::vector<PatchTriangle> triangulate_hole(const HoleRim& rim);
inline constexpr std::size_t kWholeLoop = 240;

/// Splits triangles that are larger than the edges around the hole, and turns edges, until they are of that size. New
/// positions are appended to x, whose first vertices are the loop's; `scale`: of each vertex the mean length of the
/// mesh's edges there, appended too. At most `most` vertices are added.
void refine_patch(std::vector<PatchTriangle>& triangles, std::vector<Vec3>& x, std::vector<double>& scale,
                  std::size_t loop, std::size_t most, const std::function<bool(std::uint32_t, std::uint32_t)>& joined);

/// Moves the vertices from `loop` on to where the squares of the Laplacian are least over all vertices of the patch:
/// `outside` are triangles around the hole, whose vertices beyond those of the patch lie at `around` and stay. Returns
/// whether the equations could be solved.
bool fair_patch(std::span<const PatchTriangle> triangles, std::span<const PatchTriangle> outside,
                std::span<const Vec3> around, std::size_t loop, std::vector<Vec3>& x);

}  // namespace sansmesh::inline v1::detail
