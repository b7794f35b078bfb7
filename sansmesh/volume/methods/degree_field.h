// Degrees of the polynomials that reconstructions blend, for reports and tests.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Beside VolumeField, of those that are made of polynomials of several degrees: found by dynamic_cast.
class DegreeField {
 public:
  virtual ~DegreeField() = default;

  /// Of the polynomials that the answer at each of x is made of; 0 at points that are not finite. As many entries as x.
  virtual void degrees(std::span<const Vec3> x, std::span<std::uint8_t> found) const = 0;
};

/// VolumeAnswers with the degrees, one a point.
struct PolynomialAnswers {
  std::span<double> values;
  std::span<Vec3> gradients;
  std::span<std::uint8_t> inside, degrees;
};

}  // namespace sansmesh::inline v1
