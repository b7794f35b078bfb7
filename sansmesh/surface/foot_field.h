// A projection made quick: the paraboloids at feet all over its surface, blended.
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

/// Places on a surface and how it bends there; arrays of equal length.
struct SurfaceFeet {
  std::vector<FootPoint> feet;
  std::vector<float> spacing;        ///< of the samples there (length)
  std::vector<std::uint32_t> place;  ///< that each is the foot of, ascending
};

/// The feet of the places, as far as there are any: those that come to rest within two spacings of their place. Arrays
/// of equal length; spacing > 0 (length).
SurfaceFeet find_feet(const Projection& projection, std::span<const Vec3f> places, std::span<const float> spacing);

/// About the signed distance to the surface: at x the mean of the heights over the paraboloids at feet within 1.6
/// spacings of x, under weights (1 − d²/R²)⁴: a partition of unity. Near the surface it differs from the projection it
/// was made from by what that changes within a spacing beyond a parabola. Defined in balls around the feet; feet that
/// face away from the nearest one do not count.
class FootField : public ScalarField {
 public:
  /// Neighbours in space should be neighbours in the arrays. `beyond`: what holds outside of the balls; null: the
  /// diagonal of the box. It must outlive the field. Throws DataError where there is no foot.
  explicit FootField(const SurfaceFeet& feet, const ScalarField* beyond = nullptr);

  Box3 bounds() const override { return bounds_; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override;
  /// The balls of the domain: a spacing and a tenth around each foot.
  BallUnion balls() const;

 private:
  std::vector<detail::Paraboloid> paraboloids_;
  BallTree supports_;
  const ScalarField* beyond_;
  Box3 bounds_;
  double extent_ = 0;  ///< of groups of points (length)
};

}  // namespace sansmesh::inline v1
