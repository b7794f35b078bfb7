// Scalar field that changes with time, for moving surfaces.
#pragma once

#include <span>

#include "sansmesh/box.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// ScalarField at each time: negative inside, positive outside, in units of length near its zero set. Parallelism is
/// the field's task.
class TimeField {
 public:
  virtual ~TimeField() = default;

  /// Domain of the field at all times; outside it, evaluate() still returns finite values.
  virtual Box3 bounds() const = 0;
  /// Times of definition; both ends are finite.
  virtual TimeRange times() const = 0;

  /// Evaluates position x[i] at time t[i], which is in times(), for every i. All spans have the length of x. Each
  /// result depends on x[i] and t[i] only. One call per batch, fastest if points of one time are adjacent. Thread-safe.
  virtual void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<double> values) const = 0;

  /// Bounds the values within `radius` (length, >= 0) of x[i] during [t[i] − duration, t[i] + duration] ∩ times(): if
  /// the interval does not contain 0, no surface passes. Infinite ends if nothing is known.
  virtual void ranges(std::span<const Vec3> x, double radius, std::span<const double> t, double duration,
                      std::span<ValueRange> found) const = 0;
};

}  // namespace sansmesh::inline v1
