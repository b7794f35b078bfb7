// Fast approximation of a projection: blended paraboloids at foot points on its surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/surface/foot_kernels.h"

namespace sansmesh::inline v1 {

/// Foot points of a surface with their second derivatives; arrays of equal length.
struct SurfaceFeet {
  std::vector<FootPoint> feet;
  std::vector<float> spacing;        ///< spacing of the samples there (length)
  std::vector<std::uint32_t> start;  ///< index of the starting point of each foot, ascending
};

/// Feet of the given points. A point has a foot if the projection comes to rest within two spacings of it. Arrays of
/// equal length; spacing > 0 (length).
SurfaceFeet find_feet(const Projection& projection, std::span<const Vec3f> points, std::span<const float> spacing);

/// Approximate signed distance to the surface: the mean of the heights of x over the paraboloids at feet within 1.6
/// spacings of x, with weights (1 − d²/R²)⁴ (a partition of unity). Near the surface it differs from the projection by
/// the terms beyond second order within a spacing. Defined in balls around the feet; feet that face away from the
/// nearest one are ignored.
class FootField : public ScalarField {
 public:
  /// Neighbours in space should be neighbours in the arrays. `beyond` is the field outside of the balls, which must
  /// outlive this one; null: the diagonal of the box. Throws DataError if there is no foot.
  explicit FootField(const SurfaceFeet& feet, const ScalarField* beyond = nullptr);

  Box3 bounds() const override { return bounds_; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override;
  /// Balls of the domain: 1.1 spacings around each foot.
  BallUnion balls() const;

 private:
  std::vector<detail::Paraboloid> paraboloids_;
  BallTree supports_;
  const ScalarField* beyond_;
  Box3 bounds_;
  double extent_ = 0;  ///< largest size of a group of points (length)
};

}  // namespace sansmesh::inline v1
