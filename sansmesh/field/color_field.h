// Colour anywhere on a surface, from whatever is worth showing: the samples' own colours, curvature, distances.
#pragma once

#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Spreads large batches over threads itself, as a ScalarField does.
class ColorField {
 public:
  virtual ~ColorField() = default;
  /// sRGB components 0..1 at points on or next to the surface. Sizes must agree. Safe from several threads.
  virtual void evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const = 0;
};

}  // namespace sansmesh::inline v1
