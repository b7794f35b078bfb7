// Interface of colours at surface points, for example from samples, curvatures or distances.
#pragma once

#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Distributes large batches over threads, as ScalarField does.
class ColorField {
 public:
  virtual ~ColorField() = default;
  /// Computes sRGB components 0..1 at points on or near the surface. Sizes must agree. Thread-safe.
  virtual void evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const = 0;
};

}  // namespace sansmesh::inline v1
