// Steps from the cut of pieces in a lattice to a mesh on the pieces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/polygonize/pieces/piece_cut.h"
#include "sansmesh/polygonize/pieces/piece_mesh.h"
#include "sansmesh/polygonize/pieces/piece_surface_options.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Pairs of intersecting triangles.
using Crossings = std::vector<std::array<std::uint32_t, 2>>;

/// A mesh of pieces on its way from the cut to the surface.
class PieceMesher {
 public:
  PieceMesher(const PieceExpression& field, const PieceSurfaceOptions& options, double scale)
      : field_(field), options_(options), scale_(scale) {}

  CutPieces mesh;

  /// Triangles on a blend that equals one of its pieces there are assigned to that piece.
  void name_pieces();

  /// Moves vertices of intersecting triangles back to their positions before placement; only triangles marked by
  /// `near`, or all.
  void take_back(const CutPieces& linear, const Vec3& origin, double tolerance, const std::vector<std::uint8_t>* near);

  /// Vertices close to another sheet, where placement may move a vertex beyond that sheet.
  std::vector<std::uint8_t> narrow() const;

  /// Forbids changes next to intersecting triangles of another mesh of the same surface; returns those vertices.
  std::vector<std::uint8_t> keep_around(const TriangleMesh& other, const Crossings& crossing, double factor);

  /// Fewer and better triangles.
  void improve(const Vec3& origin, Progress& progress);

  /// Undoes improvements around intersecting triangles only. Vertices within `rings` of the originals of these
  /// triangles return to their state in `placed`, or if already there, in `linear`. The rest keeps its improvements: as
  /// these merge vertices, the mesh is that of `placed` with merged vertices identified.
  void restore(const Crossings& crossing, const CutPieces& placed, const CutPieces& linear, int rings);

  /// Balances the mesh where there is room.
  TriangleMesh finished(const Vec3& origin, bool careful);

  std::vector<Vec3f> normals() const;

  /// Moves each vertex onto its pieces.
  void place_vertices();

  /// Normal of each triangle's piece at its centroid and, on request, the distance to it.
  std::vector<Vec3> normals_of_triangles(std::vector<double>* distance = nullptr) const;

  /// Propagates the distance of other sheets to neighbouring vertices.
  void spread_room();

 private:
  /// The pieces of vertices from those of the surrounding triangles.
  void recall();
  /// Largest curvature of its pieces.
  double curvature_bound_of(const CutPieces::Vertex& v) const;
  void simplify(const Vec3& origin, Progress& progress);
  /// As place_vertices(), but vertices stay where a triangle would turn.
  void place_again();
  PieceMesh piece_mesh() const;
  /// Mesh of the triangles that have one of the vertices `near`, or of all.
  TriangleMesh as_mesh(const Vec3& origin, const std::vector<std::uint8_t>* near) const;

  const PieceExpression& field_;
  const PieceSurfaceOptions& options_;
  double scale_;
  /// Per vertex before improvements: its index in the mesh, or that of the vertex that absorbed it.
  std::vector<std::uint32_t> becomes_;
};

}  // namespace sansmesh::inline v1
