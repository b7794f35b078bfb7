// Jobs on meshes: holes filled, noise taken off, fewer triangles.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/repair_options.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Holes of a mesh.
struct SANSMESH_API HolesResult {
  HoleLoops holes;                  ///< their borders
  std::size_t triangles = 0;        ///< of the mesh
  std::size_t joined_vertices = 0;  ///< at the same place as another
  /// "stray_border": border that runs around no hole.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Finds the holes; vertices at the same place become one before. Throws DataError for more triangles than can be
/// counted, Cancelled.
SANSMESH_API HolesResult list_holes(TriangleMesh mesh, Progress& progress);

/// Mesh with holes filled.
struct SANSMESH_API FillResult {
  TriangleMesh mesh;                ///< the original with its fillings
  FillReport report;                ///< what became of each hole
  std::size_t triangles = 0;        ///< of the original
  std::size_t joined_vertices = 0;  ///< of the original, at the same place as another
  /// "stray_border": border that runs around no hole; "no_way_across": holes that cannot be filled; "ends": openings
  /// that stay, since the surface runs into them steeply; "wide": much of what was filled is invented; "islands":
  /// pieces that lie in a filling; "seams": vertices at one place differ otherwise.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// The mesh with its holes filled; vertices at the same place become one before. Throws ArgumentError for
/// bad options, DataError, Cancelled.
SANSMESH_API FillResult fill(TriangleMesh mesh, const FillOptions& options, Progress& progress);

/// Smoothed mesh.
struct SmoothResult {
  TriangleMesh mesh;    ///< with the vertices moved
  SmoothReport report;  ///< how far they moved
  /// "shortened": `shorter_than` would take more rounds than there may be; "moved_far": more than noise is gone.
  std::vector<Note> notes;
};

/// The mesh by Taubin's filter, or with `creases` by bilateral normals (docs/methods/mesh-repair.md); its triangles
/// stay. Throws ArgumentError for bad options, Cancelled.
SANSMESH_API SmoothResult smooth(TriangleMesh mesh, const SmoothOptions& options, Progress& progress);

/// How far to go: by one of `triangles`, `ratio` and `error`; half of the triangles by default.
struct SANSMESH_API SimplifyOptions {
  std::optional<std::size_t> triangles = {};  ///< down to so many, 4 or more
  std::optional<double> ratio = {};           ///< down to this share of the triangles, between 0 and 1
  /// As few triangles as this distance from the original allows (root mean square at each vertex; length, > 0).
  std::optional<double> error = {};
  /// Least shape 4√3 A / Σ l² (area A, edges l) of the triangles made, 0..0.9: 0 any, 0.3 angles of 10°, 0.56 of 20°.
  /// Default: 0.3; less where such triangles are too many, or far off and worse ones much nearer.
  std::optional<double> triangle_shape = {};

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Numbers of a run of simplify().
struct SANSMESH_API SimplifyReport {
  std::size_t vertices = 0;         ///< of the original
  std::size_t triangles = 0;        ///< of the original
  std::size_t joined_vertices = 0;  ///< of the original, at the same place as another
  SurfaceDistance distance;         ///< from the original, and back
  double least_shape = 0;           ///< as asked of the triangles made
  /// How far off the best shapes are (length), where worse ones are nearer and were taken.
  std::optional<double> farthest_by_shape;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Mesh of fewer triangles.
struct SimplifyResult {
  TriangleMesh mesh;      ///< the simplified one
  SimplifyReport report;  ///< how far it is from the original
  /// "seams": vertices at one place differ otherwise; "more_triangles": fewer cannot be had; "far_off": more than a
  /// hundredth of the diagonal.
  std::vector<Note> notes;
};

/// The mesh of fewer triangles by collapses of edges (docs/methods/polygonisation.md): borders, creases and topology
/// stay; colours and attributes of vertices that merge are averaged. Throws ArgumentError for bad options, Cancelled.
SANSMESH_API SimplifyResult simplify(TriangleMesh mesh, const SimplifyOptions& options, Progress& progress);

/// How far vertices moved, in how many rounds, and what that did to area and volume, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const SmoothReport& report);
/// How many holes there are, and a line for each, `most` of them, the largest first.
SANSMESH_API std::vector<std::string> summary_of(const HoleLoops& holes, std::size_t most);
/// The same, and what became of them.
SANSMESH_API std::vector<std::string> summary_of(const FillResult& made, std::size_t most);
/// How many triangles there were and are, and how far off these are, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const SimplifyResult& made);

}  // namespace sansmesh::inline v1
