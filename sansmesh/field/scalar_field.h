// A field that can be evaluated anywhere: the one interface between methods (which make fields from samples) and
// consumers (polygonisers, renderers, evaluators), none of which knows the other.
#pragma once

#include <span>

#include "sansmesh/core/box.h"
#include "sansmesh/core/vec.h"

namespace sansmesh {

/// A scalar function on space. Implicit surfaces are negative inside, positive outside, and near their zero set
/// measured in units of length (the gradient has norm about 1).
class ScalarField {
 public:
  virtual ~ScalarField() = default;

  /// Where the field is defined; outside it evaluate() still returns finite values.
  virtual Box3 bounds() const = 0;

  /// Values, and if `gradients` is not empty gradients, at all of x. One call a batch: neighbouring points in
  /// neighbouring slots evaluate fastest. Sizes must agree (gradients may be empty). Safe from several threads.
  virtual void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const = 0;
};

}  // namespace sansmesh
