// Curvature as colour.
#pragma once

#include <cstdint>
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
  using Quantity = CurvatureQuantity;
  Quantity quantity = Quantity::mean;
  /// The absolute value (1 / length, for `gaussian` 1 / length²; > 0) that gets the full colour. Default: that exceeded
  /// by one sample in twenty.
  std::optional<double> range = {};
  CurvatureOptions curvature = {};
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// The quantity of these curvatures, defined or not.
float curvature_quantity(const PrincipalCurvatures& curvatures, CurvatureColorOptions::Quantity quantity);

/// Red where convex, blue where concave, white where flat. For Gaussian curvature red where both bend to the same side,
/// blue at saddles. The curvature of a place is that of the samples around it, on the same sheet as the nearest one;
/// where it is nowhere defined the colour is grey.
class CurvatureColors : public ColorField {
 public:
  /// Estimates the curvatures of all samples. Copies what it needs. Throws ArgumentError for bad options, DataError for
  /// a cloud without normals.
  CurvatureColors(const PointSet& points, const CurvatureColorOptions& options, Progress& progress);
  /// With the curvatures at hand, as many as points: those of a mesh's vertices.
  CurvatureColors(const PointSet& points, std::span<const PrincipalCurvatures> curvatures,
                  const CurvatureColorOptions& options);

  void evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const override;

  /// The curvature with the full colour; 0 for a flat cloud.
  double range() const { return range_; }

 private:
  KdTree tree_;
  std::vector<float> values_;  ///< of the samples in the cloud's order; NaN where not defined
  std::vector<Vec3f> normals_;
  double range_ = 0;
};

}  // namespace sansmesh::inline v1
