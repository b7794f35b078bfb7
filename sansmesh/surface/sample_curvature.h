// Curvature anywhere on a surface of samples, from estimates at these.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/field/curvature_field.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/curvature.h"

namespace sansmesh::inline v1 {

/// The mean of the curvature tensors k₁ d₁d₁ᵀ + k₂ d₂d₂ᵀ of the samples around a place, on the same sheet, with weights
/// that end smoothly: for clouds and vertices of meshes.
class SampleCurvature final : public CurvatureField {
 public:
  /// Estimates the curvatures of all samples (estimate_curvatures), which lie at `place` in the coordinates of what is
  /// asked. Copies what it needs. Throws ArgumentError for bad options, DataError for a cloud without normals.
  SampleCurvature(const PointSet& points, const LocalFrame& frame, const CurvatureOptions& options, Progress& progress);
  /// With the curvatures at hand, as many as points: those of a mesh's vertices.
  SampleCurvature(const PointSet& points, std::span<const PrincipalCurvatures> curvatures, const LocalFrame& frame);
  void evaluate(std::span<const Vec3> x, std::span<const Vec3f> normals,
                std::span<SurfaceCurvature> bends) const override;

 private:
  LocalFrame frame_;
  KdTree tree_;
  std::vector<Vec3f> normals_;  ///< zero where no curvature is known
  std::vector<std::array<float, 6>> tensors_;
};

}  // namespace sansmesh::inline v1
