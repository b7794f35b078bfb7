// Map of space for deformations: the interface between deformations (handles, moving tetrahedra, displacement lattices)
// and deformed objects (fields, volumes, meshes).
#pragma once

#include <span>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/query.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Requested results of a batch of points; empty spans are not computed.
struct MappedPoints {
  std::span<Vec3> positions;      ///< T(x), the source position of x
  std::span<Jacobian> jacobians;  ///< [k] = ∂T/∂x_k; negative determinant where space is folded
  /// Positive inside a gap opened by a cut, where no source exists, negative elsewhere; near the faces of a gap it is
  /// continuous and approximates the distance from them. −infinity far from all cuts.
  std::span<double> gaps;
  std::span<Vec3> gap_gradients;  ///< gradients of `gaps`; zero where these are infinite
};

/// Map between positions before and after a deformation: x after to T(x) before (backward map) or the reverse (forward
/// map), as its source defines.
class SANSMESH_API SpaceMap {
 public:
  /// Allows ownership through a SpaceMap pointer.
  virtual ~SpaceMap() = default;

  /// Evaluates the requested results at all of x. Positions are NaN where the map is undefined (outside of tetrahedra).
  /// Each result depends on its point only, not on the batch or on threads. Sizes must agree. Thread-safe. The map runs
  /// in parallel, as ScalarField does: pass all points in one call.
  virtual void map(std::span<const Vec3> x, const MappedPoints& wanted) const = 0;

  /// Same, through the common interface of fields: values are positions, and `inside` marks where the map is defined
  /// and has no gap. Throws ArgumentError if sizes differ.
  void query(const QueryPoints& at, const VectorFieldValues& wanted) const;

  /// Whether there may be gaps anywhere; if not, they need not be requested.
  virtual bool has_gaps() const { return false; }

  /// Returns for each box a box that contains its image under T, using only bounds known without evaluation. The
  /// default is infinite. As many entries as boxes. Thread-safe.
  virtual void images(std::span<const Box3> boxes, std::span<Box3> found) const;
};

}  // namespace sansmesh::inline v1
