// Directions of a surface that are better than the gradient of the field that defines it.
#pragma once

#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Spreads large batches over threads itself, as a ScalarField does.
class NormalField {
 public:
  virtual ~NormalField() = default;
  /// Replaces unit normals at points on or next to the surface by better ones. Where there is nothing to say they stay.
  /// Sizes must agree. Safe from several threads.
  virtual void refine(std::span<const Vec3> x, std::span<Vec3> normals) const = 0;
};

}  // namespace sansmesh::inline v1
