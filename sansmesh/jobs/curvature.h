// Principal curvatures at the samples of a cloud or the vertices of a mesh.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/surface/curvature_colors.h"

namespace sansmesh::inline v1 {

struct CurvatureMapOptions {
  CurvatureColorOptions::Quantity color_by = CurvatureColorOptions::Quantity::mean;  ///< what the colours show
  /// The value that gets the full colour (1 / length, of `gaussian` 1 / length²; > 0). Default: that exceeded by one
  /// sample in twenty.
  std::optional<double> color_range = {};
  CurvatureOptions estimation = {};  ///< its noise is estimated where it is not given

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct CurvatureReport {
  CurvatureColorOptions::Quantity color_by = CurvatureColorOptions::Quantity::mean;  ///< as used
  bool mesh = false;                    ///< the curvatures are those of a mesh's vertices
  double noise = 0;                     ///< length
  std::size_t undefined = 0;            ///< samples without enough neighbours: zero
  double q05 = 0, median = 0, q95 = 0;  ///< of the quantity that is shown
  double color_range = 0;               ///< the value that gets the full colour
  bool beyond_range = false;            ///< some are larger

  static const ReportSchema& schema();
};

struct CurvatureResult {
  /// With the normals that were used, the attributes k1, k2, mean_curvature, gaussian_curvature, curvedness,
  /// shape_index and d1x to d2z (directions), and with colours: red where convex, blue where concave, grey where not
  /// defined. Of a mesh all vertices in their order, and its triangles.
  PointSet points;
  CurvatureReport report;
  /// "preparation": what there is to say of the samples.
  std::vector<Note> notes;
};

/// Per length of the input, positive where the surface is convex. Throws ArgumentError for bad options, DataError where
/// the points cannot be used (prepare_cloud), Cancelled.
CurvatureResult curvature(PointSet points, const CurvatureMapOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
