// From samples to a mesh in one call.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/cloud_options.h"
#include "sansmesh/fit_options.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/note.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/surface_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// What to do to the samples, how to fit and how to mesh.
struct SANSMESH_API ReconstructOptions {
  CloudPreparation cloud = {};  ///< done to the samples first
  FitOptions fit = {};          ///< of the adaptive partition of unity
  MeshOptions mesh = {};        ///< of the surface's mesh
  /// Another surface than the adaptive partition of unity uses none of `fit` but what it has itself (`error`, `depth`).
  /// It is cut where it leaves its domain of definition: not closed where the samples have borders.
  SurfaceOptions surface = {.method = std::string(kPartitionSurface)};

  /// Whether it is another surface than the adaptive partition of unity.
  bool other_surface() const { return surface.method != kPartitionSurface; }
  /// The rows of its parts. Some fields of `fit` and of `surface` have the same name (`error`, `depth`, `smooth`).
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Numbers of a run of reconstruct().
struct SANSMESH_API ReconstructReport : MeshReport {
  double spacing = 0;                   ///< √(area / samples): edge of the square that one sample stands for (length)
  double noise = 0;                     ///< estimated standard deviation of the samples off the surface (length)
  bool estimated_normals = false;       ///< there were none, or they were not wanted
  std::optional<OrientBy> oriented_by;  ///< from what the normals got their signs; nothing: from the input
  std::string alignment;  ///< what was done to scans, in words; empty where nothing was asked for (CloudUse::align)
  std::size_t fits = 0;   ///< local approximations of the function; 0 for other surfaces
  int fit_depth = 0;      ///< deepest level of their tree; 0 for other surfaces
  FitsOfDegree fits_of_degree{};     ///< how many of them have degree 0, 1, …, kMaxDegree
  std::optional<PaperReport> paper;  ///< of FitMethod::paper: how its blocks came to be
  double open_share = 0;  ///< share (0..1) of the function's surface that bounds no solid; 0 for other surfaces
  /// Mean winding number just behind the samples, from which that was decided: 1 if the surface is closed, ½ of a
  /// plane. 1 for other surfaces.
  double behind = 1;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Mesh of samples.
struct ReconstructResult {
  TriangleMesh mesh;         ///< in the coordinates of the input
  ReconstructReport report;  ///< how it was made
  /// "preparation": of the samples; "mesh": what could not be as it was asked for, or samples that have no surface.
  std::vector<Note> notes;
};

/// Points (normals are estimated or oriented if need be) → manifold mesh, closed where the surface bounds a solid.
/// Throws DataError where the points cannot be reconstructed (fewer than 9, all coincident, collinear or in a plane),
/// ArgumentError for bad options, Cancelled.
SANSMESH_API ReconstructResult reconstruct(PointSet points, const ReconstructOptions& options, Progress& progress);

/// How the surface was made, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const ReconstructReport& report, const ReconstructOptions& options);

}  // namespace sansmesh::inline v1
