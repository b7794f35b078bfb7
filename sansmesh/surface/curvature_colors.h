// Curvature as colour.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sansmesh/core/diverging_color.h"
#include "sansmesh/field/color_field.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/curvature.h"

namespace sansmesh::inline v1 {

struct CurvatureColorOptions {
  CurvatureQuantity quantity = CurvatureQuantity::mean;
  /// Absolute value with the full colour (1 / length, for `gaussian` 1 / length²; > 0). Default: the value that one
  /// sample in twenty exceeds.
  std::optional<double> range = {};
  CurvatureOptions curvature = {};
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// The quantity of these curvatures, defined or not.
float curvature_quantity(const PrincipalCurvatures& curvatures, CurvatureQuantity quantity);

/// Red where convex, blue where concave, white where flat. Gaussian curvature: red where both principal curvatures have
/// the same sign, blue at saddles. The curvature at a point is that of the samples around it, on the same sheet as the
/// nearest one; grey where it is undefined.
class CurvatureColors : public ColorField {
 public:
  /// Estimates the curvatures of all samples. Copies the data that it needs. Throws ArgumentError for invalid options,
  /// DataError for a cloud without normals.
  CurvatureColors(const PointSet& points, const CurvatureColorOptions& options, Progress& progress);
  /// Uses known curvatures, as many as points, for example of a mesh's vertices.
  CurvatureColors(const PointSet& points, std::span<const FittedCurvatures> curvatures,
                  const CurvatureColorOptions& options);

  void evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const override;

  /// Curvature with the full colour; 0 for a flat cloud.
  double range() const { return range_; }

 private:
  KdTree tree_;
  std::vector<float> values_;  ///< by sample, in the cloud's order; NaN where undefined
  std::vector<Vec3f> normals_;
  double range_ = 0;
};

}  // namespace sansmesh::inline v1
