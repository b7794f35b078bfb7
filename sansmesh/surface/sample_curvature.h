// Curvatures at points of a surface, interpolated from estimates at samples.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/field/curvature_field.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/curvature.h"

namespace sansmesh::inline v1 {

/// Mean of the curvature tensors k₁ d₁d₁ᵀ + k₂ d₂d₂ᵀ of the samples around a point, on the same sheet, with smooth
/// weights of compact support: for clouds and vertices of meshes.
class SampleCurvature final : public CurvatureField {
 public:
  /// Estimates the curvatures of all samples (estimate_curvatures). `frame` is the local frame of the query points.
  /// Copies the data that it needs. Throws ArgumentError for invalid options, DataError for a cloud without normals.
  SampleCurvature(const PointSet& points, const LocalFrame& frame, const CurvatureOptions& options, Progress& progress);
  /// Uses known curvatures, as many as points, for example of a mesh's vertices.
  SampleCurvature(const PointSet& points, std::span<const FittedCurvatures> curvatures, const LocalFrame& frame);
  void evaluate(std::span<const Vec3> x, std::span<const Vec3f> normals,
                std::span<PrincipalCurvatures> curvatures) const override;

 private:
  LocalFrame frame_;
  KdTree tree_;
  std::vector<Vec3f> normals_;  ///< zero where the curvature is undefined
  std::vector<std::array<float, 6>> tensors_;
};

}  // namespace sansmesh::inline v1
