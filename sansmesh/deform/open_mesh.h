// Meshes opened along cuts, so that a deformation can part them.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/deform/occluder.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct OpenMeshOptions {
  /// Triangles that a cut passes in a less simple way than from one place of their border to another, or from one to
  /// the cut's own border, are cut in four up to so often, 0..12.
  int refinements = 6;
  /// Whether closed meshes become closed again, by faces along what half-planes and polygons cut of them. Normals of
  /// vertices are then left out: at the edges of these faces there are two.
  bool close = false;
  /// Edges within these faces are at most so long; > 0. Default: three times the mean length of the mesh's edges.
  std::optional<double> face_edges = {};

  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct OpenMeshReport {
  std::size_t edges = 0;     ///< along which the mesh was opened
  std::size_t doubled = 0;   ///< vertices that were added for them
  std::size_t faces = 0;     ///< triangles of cut faces, both sides together
  std::size_t unopened = 0;  ///< triangles that a cut crosses in too complicated a way, after all refinements
  std::size_t unclosed = 0;  ///< cuts that left something open: meshes as cuts, open meshes

  static const ReportSchema& schema();
};

/// Splits the edges that a cut crosses, and the triangles at them, and doubles the vertices on the cut but for those at
/// its border, where the slit ends: what belongs to one side of the cut is no longer connected with the other. Vertices
/// within a thousandth of an edge from the cut are moved onto it. One cut after the other. Nothing moves: the copies
/// lie in the same place, and carry as an attribute named kCutSide from where they are to be deformed (deform_mesh).
/// The origin moves near where the mesh is farther from it than it is large. Within a triangle the cut is taken as
/// straight. Clouds need none of this: each point is on one side or on the other.
TriangleMesh open_along_cuts(TriangleMesh mesh, std::span<const std::shared_ptr<const Occluder>> cuts,
                             const OpenMeshOptions& options = {}, OpenMeshReport* report = nullptr);

}  // namespace sansmesh::inline v1
