// Fewer triangles for the same surface, and how far these are off.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// How far to go: by one of `triangles`, `ratio` and `error`; half of the triangles by default.
struct SimplifyOptions {
  std::optional<std::size_t> triangles = {};  ///< down to so many, 4 or more
  std::optional<double> ratio = {};           ///< down to this share of the triangles, between 0 and 1
  /// As few triangles as this distance from the original allows (root mean square at each vertex; length, > 0).
  std::optional<double> error = {};
  /// Least shape 4√3 A / Σ l² (area A, edges l) of the triangles made, 0..0.9: 0 any, 0.3 angles of 10°, 0.56 of 20°.
  /// Default: 0.3; less where such triangles are too many, or far off and worse ones much nearer.
  std::optional<double> triangle_shape = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SimplifyReport {
  std::size_t vertices = 0, triangles = 0;  ///< of the original
  std::size_t joined_vertices = 0;          ///< of the original, at the same place as another
  SurfaceDistance distance;                 ///< from the original, and back
  double least_shape = 0;                   ///< as asked of the triangles made
  /// How far off the best shapes are (length), where worse ones are nearer and were taken.
  std::optional<double> farthest_by_shape;

  static const ReportSchema& schema();
};

struct SimplifyResult {
  TriangleMesh mesh;
  SimplifyReport report;
  /// "seams": vertices at one place differ otherwise; "more_triangles": fewer cannot be had; "far_off": more than a
  /// hundredth of the diagonal.
  std::vector<Note> notes;
};

/// The mesh of fewer triangles by collapses of edges (mesh/simplify.h): borders, creases and topology stay; colours and
/// attributes of vertices that merge are averaged. Throws ArgumentError for bad options, Cancelled.
SimplifyResult simplify(TriangleMesh mesh, const SimplifyOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
