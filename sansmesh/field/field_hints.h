// Further knowledge of some fields. A ScalarField offers it by a further base class.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Finds the sign of a value faster than the value: polygonisation needs sizes next to the surface only.
class SignField {
 public:
  virtual ~SignField() = default;

  /// Values with the signs of those of ScalarField::evaluate. Where `sized` becomes 1 they approximate these next to
  /// the surface; where it becomes 0 only the sign is known. Lengths must agree. Thread-safe.
  virtual void evaluate_signs(std::span<const Vec3> x, std::span<double> values,
                              std::span<std::uint8_t> sized) const = 0;
};

/// Knows where its zero set may have creases.
class CreaseField {
 public:
  virtual ~CreaseField() = default;

  /// Sets `near` to 1 at points that a crease may be close to, else to 0. Lengths must agree. Thread-safe.
  virtual void find_creases(std::span<const Vec3> x, std::span<std::uint8_t> near) const = 0;
};

}  // namespace sansmesh::inline v1
