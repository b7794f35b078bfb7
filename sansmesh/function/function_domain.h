// Domain of the surface of a fitted function: it ends where open sheets run out of samples, and at the trimming
// distance.
#pragma once

#include <optional>
#include <span>

#include "sansmesh/function/fitted_function.h"
#include "sansmesh/partition/far/global_sign.h"
#include "sansmesh/points/statistics/coverage.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

/// Divides the blocks along borders until these are no wider than the border, at most to level `deepest`.
void refine_along(std::span<const Coverage::Border> borders, BlockTree& blocks, int deepest);

/// Negative where there is surface, as PolygonizeOptions::domain requires; in the coordinates of the function's field.
/// The membranes that close the holes of closed sheets belong to the surface even without samples.
class FunctionDomain : public ScalarField {
 public:
  /// Lengths in the unit of the field. `fill`: holes of open sheets up to this width are closed (Coverage). `trim`: no
  /// surface farther than this from any sample, on all sheets. If samples were not kept, the feet of the supports
  /// replace them.
  FunctionDomain(const FittedFunction& function, std::optional<double> fill, std::optional<double> trim);

  /// Whether there are open sheets, or a surface to trim.
  static bool needed(const FittedFunction& function, std::optional<double> trim);

  Box3 bounds() const override { return coverage_.bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  /// Divides the blocks along its borders (refine_along).
  void refine(BlockTree& blocks, int deepest) const;

 private:
  Coverage coverage_;
  std::optional<double> trim_;
  KdTree open_, closed_;  ///< feet of the supports
  GlobalSign solid_;      ///< winding number of the closed ones, if there are both
  Vec3 origin_;
  KdTree samples_;  ///< for trimming only
};

}  // namespace sansmesh::inline v1
