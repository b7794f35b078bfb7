// Jobs that repair meshes: hole filling, smoothing, simplification.
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
  std::size_t triangles = 0;        ///< triangles of the mesh
  std::size_t joined_vertices = 0;  ///< vertices merged with a coincident one
  /// "stray_border": border edges that enclose no hole.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< report rows
};

/// Finds the holes after merging coincident vertices. Throws DataError for too many triangles, Cancelled.
SANSMESH_API HolesResult list_holes(TriangleMesh mesh, Progress& progress);

/// Mesh with holes filled.
struct SANSMESH_API FillResult {
  TriangleMesh mesh;                ///< mesh with its fillings
  FillReport report;                ///< outcome for each hole
  std::size_t triangles = 0;        ///< triangles of the original
  std::size_t joined_vertices = 0;  ///< vertices of the original merged with a coincident one
  /// "stray_border": border edges that enclose no hole; "no_way_across": holes that cannot be filled; "ends": openings
  /// left open, since the surface approaches them steeply; "wide": large parts of fillings have no data; "islands":
  /// components inside a filling; "seams": coincident vertices with different attributes.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< report rows
};

/// Fills the holes of a mesh after merging coincident vertices. Throws ArgumentError for bad options, DataError,
/// Cancelled.
SANSMESH_API FillResult fill(TriangleMesh mesh, const FillOptions& options, Progress& progress);

/// Smoothed mesh.
struct SmoothResult {
  TriangleMesh mesh;    ///< mesh with moved vertices
  SmoothReport report;  ///< how far they moved
  /// "shortened": `shorter_than` would need more rounds than allowed; "moved_far": more than noise was removed.
  std::vector<Note> notes;
};

/// Smooths a mesh by Taubin's filter, or with `creases` by bilateral normals (docs/methods/mesh-repair.md); its
/// triangles stay the same. Throws ArgumentError for bad options, Cancelled.
SANSMESH_API SmoothResult smooth(TriangleMesh mesh, const SmoothOptions& options, Progress& progress);

/// Target of the simplification: one of `triangles`, `ratio` and `error`; default: half of the triangles.
struct SANSMESH_API SimplifyOptions {
  std::optional<std::size_t> triangles = {};  ///< number of triangles, 4 or more
  std::optional<double> ratio = {};           ///< share of the triangles, between 0 and 1
  /// Fewest triangles within this distance of the original (root mean square at each vertex; length, > 0).
  std::optional<double> error = {};
  /// Least shape 4√3 A / Σ l² (area A, edges l) of new triangles, 0..0.9: 0 allows any, 0.3 means angles of 10°, 0.56
  /// of 20°; beside worse triangles they may be as bad. Default: 0.01, 0 if such triangles are too many; 0.3 for an
  /// error.
  std::optional<double> triangle_shape = {};

  static const OptionSchema& schema();  ///< option rows, one per field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Report of simplify().
struct SANSMESH_API SimplifyReport {
  std::size_t vertices = 0;         ///< vertices of the original
  std::size_t triangles = 0;        ///< triangles of the original
  std::size_t joined_vertices = 0;  ///< vertices of the original merged with a coincident one
  SurfaceDistance distance;         ///< between the original and the result, in both directions
  double least_shape = 0;           ///< least shape required of new triangles

  static const ReportSchema& schema();  ///< report rows
};

/// Mesh of fewer triangles.
struct SimplifyResult {
  TriangleMesh mesh;      ///< simplified mesh
  SimplifyReport report;  ///< distance from the original
  /// "seams": coincident vertices with different attributes; "more_triangles": the requested number cannot be reached;
  /// "far_off": more than one hundredth of the diagonal.
  std::vector<Note> notes;
};

/// Simplifies a mesh by edge collapses (docs/methods/polygonisation.md), which preserve borders, creases and topology;
/// colours and attributes of merged vertices are averaged. Throws ArgumentError for bad options, Cancelled.
SANSMESH_API SimplifyResult simplify(TriangleMesh mesh, const SimplifyOptions& options, Progress& progress);

/// Distances, rounds, and changes of area and volume, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const SmoothReport& report);
/// Number of holes, and one line for each of the `most` largest.
SANSMESH_API std::vector<std::string> summary_of(const HoleLoops& holes, std::size_t most);
/// Holes and their outcomes.
SANSMESH_API std::vector<std::string> summary_of(const FillResult& made, std::size_t most);
/// Numbers of triangles and distances, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const SimplifyResult& made);

}  // namespace sansmesh::inline v1
