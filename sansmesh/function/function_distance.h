// Distance to the zero set of a fitted function, for offsets and shells.
#pragma once

#include <memory>

#include "sansmesh/csg/solid.h"
#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Signed distance to the zero set of a function, in the coordinates of its input. The function itself approximates a
/// distance only within about a support of its zero set; farther away at best its sign is right. This is the exact
/// distance to a mesh of it, finer than that of mesh_function and with edges along its creases (crease_edges.h), so
/// that offsets are rounded around convex creases and sharp within. Sheets of the function far from any sample, which
/// its mesh does not have, are missing here too.
///
/// Pieces are those of the mesh (MeshField). Continuous; the gradient jumps where there are several closest points, as
/// for every distance. Next to an open surface the side is that of the function itself.
class FunctionDistance : public PiecewiseField {
 public:
  /// Makes the mesh, like mesh_function with all components. Throws DataError if the function has no surface.
  FunctionDistance(std::shared_ptr<const FittedFunction> function, Progress& progress);

  /// Bounds of the surface if it is closed, else those of the function. Values are distances outside, too.
  Box3 bounds() const override;
  /// Whether the surface bounds a solid.
  bool closed() const;
  std::uint32_t pieces() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override;
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override;
  /// 1 if the surface is closed. Far from an open surface the sign may change.
  std::optional<double> slope_bound() const override;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

/// A function as a solid whose field is the distance to its surface. An open surface bounds everything behind it,
/// within the function's box. Throws DataError if the function has no surface.
Solid function_distance_solid(std::shared_ptr<const FittedFunction> function, Progress& progress);

}  // namespace sansmesh::inline v1
