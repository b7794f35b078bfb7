// A fitted function as a distance everywhere: what offsets and shells need.
#pragma once

#include <memory>

#include "sansmesh/core/progress.h"
#include "sansmesh/field/scalar_field.h"
#include "sansmesh/function/surface_function.h"

namespace sansmesh {

/// The signed distance to the zero set of a function, in the coordinates of its input. The function itself is a
/// distance only within about a support of its zero set; farther away it is something smooth with the right sign, at
/// best. Here the value is the function's within one spacing of its samples, the distance to its mesh beyond two, and
/// changes over smoothly between. Where both disagree by more than a spacing, it is the mesh's: sheets of the function
/// far from any sample, which its mesh does not have, are not here either.
///
/// Continuous; the gradient jumps where there are several closest points, as that of every distance.
class FunctionDistance : public ScalarField {
 public:
  /// Makes the mesh, as mesh_function does with all components. Throws DataError if the function has no surface.
  FunctionDistance(std::shared_ptr<const SurfaceFunction> function, Progress& progress);
  ~FunctionDistance() override;

  /// Those of the function; values are distances outside, too.
  Box3 bounds() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  /// Values lie between the distance to the mesh and those of the function; where the side is another
  /// than the mesh's they may not.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace sansmesh
