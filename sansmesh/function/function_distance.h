// A fitted function as a distance everywhere: what offsets and shells need.
#pragma once

#include <memory>

#include "sansmesh/csg/solid.h"
#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The signed distance to the zero set of a function, in the coordinates of its input. The function itself is a
/// distance only within about a support of its zero set; farther away it is something smooth with the right sign, at
/// best. Here it is the exact distance to a mesh of it, finer than mesh_function makes it and with edges along its
/// creases (crease_edges.h), so that offsets are rounded around convex creases and sharp within. Sheets of the function
/// far from any sample, which its mesh does not have, are not here either.
///
/// Pieces are those of the mesh (MeshField). Continuous; the gradient jumps where there are several closest points, as
/// that of every distance. Next to an open surface the side is that of the function itself.
class FunctionDistance : public PiecewiseField {
 public:
  /// Makes the mesh, as mesh_function does with all components. Throws DataError if the function has no surface.
  FunctionDistance(std::shared_ptr<const FittedFunction> function, Progress& progress);
  ~FunctionDistance() override;

  /// Of a closed surface its own; else those of the function. Values are distances outside, too.
  Box3 bounds() const override;
  /// The surface ends nowhere: it bounds a solid.
  bool closed() const;
  std::uint32_t pieces() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override;
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override;
  /// 1 if the surface is closed. Where it is open the sign may change far from it.
  std::optional<double> slope_bound() const override;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

/// A function as a solid that is the distance to its surface. What is open is taken as all that lies behind it, as far
/// as the function's box reaches. Throws DataError if the function has no surface.
Solid function_distance_solid(std::shared_ptr<const FittedFunction> function, Progress& progress);

}  // namespace sansmesh::inline v1
