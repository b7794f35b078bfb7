// Cuts handles of a mesh open and caps both ends.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/mesh/repair/handle_loops.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Disc that closes one end of a cut handle.
struct HandleCap {
  std::vector<std::uint32_t> rim;   ///< vertices of the mesh along its border
  std::vector<Vec3> fresh;          ///< positions of further vertices, relative to the mesh's origin
  std::vector<Triangle> triangles;  ///< corners: numbers in `rim`, followed by those of `fresh`
  Vec3 position(const TriangleMesh& mesh, std::uint32_t corner) const {
    return corner < rim.size() ? Vec3(mesh.vertices[rim[corner]]) : fresh[corner - rim.size()];
  }
};

/// Replacement of a band around a handle by two caps.
struct HandleCut {
  std::vector<std::uint32_t> band;  ///< triangles that the cut removes, ascending
  std::array<HandleCap, 2> caps;
};

/// The cut along `loop` that removes the triangles within about `width` (length) of it, or of the triangles at the loop
/// if `width` is 0. The caps continue the surface beyond the band smoothly. Together they have at most as many vertices
/// and triangles as the band. Nothing if the band is no ring of triangles with two separate borders inside the mesh, or
/// if a cap cannot be triangulated.
std::optional<HandleCut> cut_handle(const TriangleMesh& mesh, const HandleClasses& classes, const HandleLoop& loop,
                                    double width);

/// Whether a cap intersects the other one or one of the triangles `around`. Ignores those of the band.
bool caps_intersect(const TriangleMesh& mesh, const HandleCut& cut, std::span<const std::uint32_t> around);

/// Applies cuts whose bands have no common vertices. New vertices are copies of a vertex of the rim, with their own
/// position and normal. Removes the vertices that are no longer used. The mesh must not have attributes of triangles.
void apply_cuts(TriangleMesh& mesh, std::span<const HandleCut> cuts);

}  // namespace sansmesh::inline v1
