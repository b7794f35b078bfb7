// Interface of surface normals that are more accurate than the gradients of the defining field.
#pragma once

#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Distributes large batches over threads, as ScalarField does.
class NormalField {
 public:
  virtual ~NormalField() = default;
  /// Replaces unit normals at points on or near the surface by more accurate ones; leaves them unchanged where it has
  /// none. Sizes must agree. Thread-safe.
  virtual void refine(std::span<const Vec3> x, std::span<Vec3> normals) const = 0;
};

}  // namespace sansmesh::inline v1
