// Domain of a surface of samples: the surface is clipped where its samples end and where trimming is requested.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/points/statistics/coverage.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

/// Negative where the surface exists (PolygonizeOptions::domain). An open surface ends where its samples no longer
/// cover it (Coverage). A surface that bounds a solid ends only along the borders of holes wider than twelve spacings,
/// and four spacings from all samples: it stays closed at edges, at tips and around isolated samples.
class SurfaceDomain : public ScalarField {
 public:
  /// `feet` are points on the surface (the zero set of a field) with their normals; they represent the samples. Lengths
  /// in the unit of the field; coordinates are of order 1. `spacing`: mean spacing of the feet. `fill`: holes up to
  /// this width are closed (Coverage). `trim`: largest distance of the surface from a sample. `solid`: whether it
  /// bounds a solid, if known; else the winding number behind the samples decides. `whole`: a solid's surface ends only
  /// where it is trimmed.
  SurfaceDomain(const ScalarField& field, const PointSet& feet, double spacing, std::optional<double> fill,
                std::optional<double> trim, std::optional<bool> solid = {}, bool whole = false);

  /// Whether the samples end somewhere, so that the surface is open.
  bool ends() const { return !borders_.empty(); }
  /// Whether it bounds a solid.
  bool solid() const { return far_ > 0; }

  Box3 bounds() const override { return coverage_.bounds(); }
  /// Gradients, if requested, are zero.
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  /// Refines the blocks along the borders (refine_along of function_domain.h).
  void refine(BlockTree& blocks, int deepest) const;

 private:
  /// Whether the surface of a solid exists at x although no samples cover it.
  bool stays(const Vec3f& x) const;

  Coverage coverage_;
  KdTree samples_;
  std::vector<Coverage::Border> borders_;
  KdTree border_samples_;
  double far_ = 0;  ///< solids: distance from all samples at which the surface always ends; else 0
  std::optional<double> trim_;
};

}  // namespace sansmesh::inline v1
