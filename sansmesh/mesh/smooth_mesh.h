// Noise taken off a mesh, its volume kept.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct SmoothOptions {
  /// Pairs of steps, 1..10000; with `creases` rounds over the normals. Default: what `length` asks for; else 10, with
  /// `creases` 8.
  std::optional<int> iterations = {};
  /// How far a step goes towards the mean of the neighbours, above 0, up to 0.65: longer steps blow up waves of two
  /// edges.
  double strength = 0.6;
  /// Details of this wavelength become half as high, shorter ones vanish, ones of twice the length and more hardly
  /// change (length, > 0). Not with `iterations` or `creases`.
  std::optional<double> length = {};
  /// Keep creases: means of the normals of triangles, then vertices that follow them.
  bool creases = false;
  /// With `creases`: triangles whose normals differ by much more than this do not blur (degrees, 1..90). Default: from
  /// the noise of the normals.
  std::optional<double> crease_angle = {};
  /// Vertices of borders move along with the two beside them on the border; otherwise they stay.
  bool borders = false;

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What became of it, over the vertices that triangles use. Lengths in the unit of the mesh.
struct SmoothReport {
  std::size_t vertices = 0;  ///< used by a triangle; those at the same place count once
  std::size_t fixed = 0;     ///< of these stayed: on borders, or where edges have three triangles or more
  double mean_edge = 0;      ///< before
  double rms_move = 0, largest_move = 0;
  int iterations = 0;       ///< as used
  double crease_angle = 0;  ///< as used, degrees
  bool shortened = false;   ///< `length` would have taken more iterations than there may be
  double area_before = 0, area_after = 0;
  /// Where the mesh is closed and oriented.
  std::optional<double> volume_before, volume_after;

  static const ReportSchema& schema();
};

/// Taubin's filter [taubin1995]: steps to the mean of the neighbours (weights: cotangents, clamped to be positive) and
/// a little farther back, in turn, which take off what is shorter than some edges and let longer waves pass, so that
/// the mesh does not shrink; if it is closed, vertices then move along the normals, those of a component all by the
/// same distance, until each component has its volume again. With `creases` bilateral means of the normals of triangles
/// [zheng2011], to which vertices are fitted [sun2007]. Vertices at the same place stay together. Normals of vertices
/// are made anew if there were any. The same for any number of threads.
SmoothReport smooth_mesh(TriangleMesh& mesh, const SmoothOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
