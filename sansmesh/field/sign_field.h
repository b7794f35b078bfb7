// Interface of fields that find the sign of a value faster than the value.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A ScalarField offers it by a second base class. Polygonisation needs the sizes of values next to the surface only.
class SignField {
 public:
  virtual ~SignField() = default;

  /// Values with the signs of those of ScalarField::evaluate. Where `sized` becomes 1 they approximate these next to
  /// the surface; where it becomes 0 only the sign is known. Lengths must agree. Thread-safe.
  virtual void evaluate_signs(std::span<const Vec3> x, std::span<double> values,
                              std::span<std::uint8_t> sized) const = 0;
};

}  // namespace sansmesh::inline v1
