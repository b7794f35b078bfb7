// Exact Boolean operations on closed triangle meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/data/boolean_expression.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Whether each edge has as many triangles in one direction as in the other: such faces enclose a solid.
bool encloses(const SolidFaces& faces);

/// Boundary of a Boolean expression of solids.
struct BooleanResult {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  /// For each vertex: its solid and vertex there, if it is one of the input.
  struct Source {
    std::uint32_t solid = 0, vertex = 0;
    bool given = false;
  };
  std::vector<Source> sources;
  /// Faces that are parts of triangles of the input, with the outward unit normal.
  struct CutFace {
    std::uint32_t face = 0;
    Vec3 normal;
  };
  std::vector<CutFace> cut_faces;
  std::size_t cut_triangles = 0;  ///< triangles of the input that others meet
  std::size_t seam_vertices = 0;  ///< new vertices
  std::size_t patches = 0;
  bool closed = true;  ///< false, without faces, if self-intersections of the input cannot be resolved
};

/// The result is closed, and manifold: vertices and edges where its parts only touch are duplicated. Triangles that
/// meet no other solid stay as they are. Seams are exact up to the rounding of new vertices to double. Coincident faces
/// are faces of both solids: a common one remains in a union if both solids are on the same side of it.
/// Points are inside of a solid where its winding number is positive. Intersections of a solid with itself stay, unless
/// seams meet them or parts of a solid overlap; then all of that solid are resolved. Solids satisfy encloses().
/// Deterministic for any number of threads. Throws Cancelled.
BooleanResult combine_solids(std::span<const SolidFaces> solids, const BooleanExpression& expression,
                             Progress& progress);

}  // namespace sansmesh::inline v1
