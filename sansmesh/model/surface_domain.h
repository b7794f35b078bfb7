// Where the surface of samples that was not made for a mesh is cut off: where the samples end, and where trimming was
// asked for.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/points/coverage.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

/// Negative where there is surface, as PolygonizeOptions::domain wants it. A surface that bounds no solid ends where
/// its samples cease to cover it (Coverage). One that bounds a solid does so along the borders of holes of more than
/// twelve spacings only, and elsewhere four spacings from all samples: at edges and tips and where single samples are
/// far from others it stays closed.
class SurfaceDomain : public ScalarField {
 public:
  /// Of points on the surface, the zero set of a field, with their normals; they stand for the samples. Lengths in the
  /// unit of the field; coordinates are about 1 large. `spacing`: of all of them. `fill`: holes up to so wide are
  /// closed (Coverage). `trim`: no surface farther than this from any sample. `solid`: whether it bounds one, where
  /// that is known; else the winding number behind the samples tells. `whole`: that of a solid ends nowhere but where
  /// it is trimmed.
  SurfaceDomain(const ScalarField& field, const PointSet& feet, double spacing, std::optional<double> fill,
                std::optional<double> trim, std::optional<bool> solid = {}, bool whole = false);

  /// Whether the samples end anywhere, so that the surface is open.
  bool ends() const { return !borders_.empty(); }
  /// Whether it bounds a solid.
  bool solid() const { return far_ > 0; }

  Box3 bounds() const override { return coverage_.bounds(); }
  /// No gradients: asked for, they are zero.
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  /// Divides the blocks along its borders (refine_along of function_domain.h).
  void refine(BlockTree& blocks, int deepest) const;

 private:
  /// Whether there is surface of a solid although the samples do not cover it.
  bool stays(const Vec3f& x) const;

  Coverage coverage_;
  KdTree samples_;
  std::vector<Coverage::Border> borders_;
  KdTree border_samples_;
  double far_ = 0;  ///< of a solid: where it ends in any case; else 0
  std::optional<double> trim_;
};

}  // namespace sansmesh::inline v1
