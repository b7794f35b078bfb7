// Holes of a mesh, listed and filled.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/mesh/fill_holes.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct HolesResult {
  HoleLoops holes;
  std::size_t triangles = 0;        ///< of the mesh
  std::size_t joined_vertices = 0;  ///< at the same place as another
  /// "stray_border": border that runs around no hole.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Throws DataError for more triangles than can be counted, Cancelled.
HolesResult list_holes(TriangleMesh mesh, Progress& progress);

struct FillResult {
  TriangleMesh mesh;
  FillReport report;
  std::size_t triangles = 0;        ///< of the original
  std::size_t joined_vertices = 0;  ///< of the original, at the same place as another
  /// "stray_border": border that runs around no hole; "no_way_across": holes that cannot be filled; "ends": openings
  /// that stay, since the surface runs into them steeply; "wide": much of what was filled is invented; "islands":
  /// pieces that lie in a filling; "seams": vertices at one place differ otherwise.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// The mesh with its holes filled (fill_holes); vertices at the same place become one before. Throws ArgumentError for
/// bad options, DataError, Cancelled.
FillResult fill(TriangleMesh mesh, const FillOptions& options, Progress& progress);

/// A line for each hole, `most` of them, the largest first, for people.
std::vector<std::string> summary_of(const HoleLoops& holes, std::size_t most);

}  // namespace sansmesh::inline v1
