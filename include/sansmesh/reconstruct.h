// Reconstruction of a mesh from samples in one call.
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

/// Options of preparation, fit and meshing.
struct SANSMESH_API ReconstructOptions {
  CloudPreparation cloud = {};  ///< preparation of the samples
  FitOptions fit = {};          ///< fit of the adaptive partition of unity
  MeshOptions mesh = {};        ///< meshing of the surface
  /// Surfaces other than the adaptive partition of unity use only `error` and `depth` of `fit`. They end where they
  /// leave their domain of definition, so they are open where the samples have borders.
  SurfaceOptions surface = {.method = std::string(kPartitionSurface)};

  /// Whether the surface is not the adaptive partition of unity.
  bool other_surface() const { return surface.method != kPartitionSurface; }
  /// Option rows of its parts. Some fields of `fit` and of `surface` have the same name (`error`, `depth`, `smooth`).
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Report of reconstruct().
struct SANSMESH_API ReconstructReport : MeshReport {
  double spacing = 0;                   ///< √(area / samples): edge of the square that one sample represents (length)
  double noise = 0;                     ///< estimated standard deviation of the samples from the surface (length)
  bool estimated_normals = false;       ///< the input had no normals, or they were not used
  std::optional<OrientBy> oriented_by;  ///< origin of the signs of normals; empty: the input
  std::string alignment;          ///< registration of scans as text; empty if not requested (CloudPreparation::align)
  std::size_t fits = 0;           ///< local approximations of the function; 0 for other surfaces
  int fit_depth = 0;              ///< deepest level of their tree; 0 for other surfaces
  FitsOfDegree fits_of_degree{};  ///< how many of them have degree 0, 1, …, kMaxDegree
  std::optional<PaperReport> paper;  ///< FitMethod::paper: construction of its blocks
  double open_share = 0;  ///< share (0..1) of the function's surface that bounds no solid; 0 for other surfaces
  /// Mean winding number just behind the samples, which determines `open_share`: 1 for a closed surface, ½ for a plane.
  /// 1 for other surfaces.
  double mean_winding_number = 1;

  static const ReportSchema& schema();  ///< report rows
};

/// Mesh of samples.
struct ReconstructResult {
  TriangleMesh mesh;         ///< mesh in the coordinates of the input
  ReconstructReport report;  ///< how it was made
  /// On the preparation of the samples, options that could not be satisfied, parts that were left out
  /// ("parts_left_out") and samples without a surface ("lost_samples").
  std::vector<Note> notes;
};

/// Reconstructs a manifold mesh from points, closed where the surface bounds a solid. Normals are estimated or oriented
/// if necessary. Throws DataError if the points cannot be reconstructed (fewer than 9, all coincident, collinear or
/// coplanar), ArgumentError for bad options, Cancelled.
SANSMESH_API ReconstructResult reconstruct(PointSet points, const ReconstructOptions& options, Progress& progress);

/// Steps of the reconstruction, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const ReconstructReport& report, const ReconstructOptions& options);

}  // namespace sansmesh::inline v1
