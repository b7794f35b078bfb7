// A map of space: where what is seen at a place comes from. The interface between what deforms (handles, tetrahedra
// that move, maps on lattices) and what is deformed (fields, volumes, meshes), none of which knows the other.
#pragma once

#include <span>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/vec.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// What is wanted at a batch of points; spans that are empty are not wanted.
struct MapAnswers {
  std::span<Vec3> positions;      ///< T(x), where what is at x comes from
  std::span<Jacobian> jacobians;  ///< [k] = ∂T/∂x_k; its determinant is negative where space is folded
  /// Above 0 in a gap that a cut has opened, where nothing comes from anywhere, below 0 elsewhere; near the faces of
  /// the gap about the distance from them, and continuous there. −infinity where no cut is near.
  std::span<double> gaps;
  std::span<Vec3> gap_gradients;  ///< of `gaps`; zero where these are infinite
};

/// Positions x after the deformation to positions T(x) before it (backward), or the other way round (forward): its
/// maker says which.
class SANSMESH_API SpaceMap {
 public:
  virtual ~SpaceMap() = default;

  /// All that is wanted at all of x. Where the map is not defined (outside of tetrahedra) positions are NaN. Each
  /// answer depends on its point alone, not on the rest of the batch nor on threads. Sizes must agree. Safe from
  /// several threads. The map itself runs in parallel, as ScalarField does: whoever asks hands over all points that it
  /// has.
  virtual void map(std::span<const Vec3> x, const MapAnswers& wanted) const = 0;

  /// Whether there may be gaps anywhere: if not, nobody needs to ask for them.
  virtual bool has_gaps() const { return false; }

  /// A box for each of `boxes` that holds T of all its points, as far as that is known without looking: else infinite,
  /// as it is unless this is overridden. As many entries as boxes. Safe from several threads.
  virtual void images(std::span<const Box3> boxes, std::span<Box3> found) const;
};

}  // namespace sansmesh::inline v1
