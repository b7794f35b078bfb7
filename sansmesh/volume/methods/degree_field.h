// Degrees of the polynomials in a reconstruction, for reports and tests.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Second interface of fields built from polynomials of several degrees; obtained by dynamic_cast.
class DegreeField {
 public:
  virtual ~DegreeField() = default;

  /// The degree of the polynomials at each x; 0 at non-finite points. As many entries as x.
  virtual void degrees(std::span<const Vec3> x, std::span<std::uint8_t> found) const = 0;
};

/// VolumeFieldValues with the degrees, one per point; with a `level`, as LevelField.
struct PolynomialValues {
  std::span<double> values;
  std::span<Vec3> gradients;
  std::span<std::uint8_t> inside, degrees;
  const double* level = nullptr;
};

}  // namespace sansmesh::inline v1
