// A function of space that changes in time: what surfaces that move are cut out of.
#pragma once

#include <span>

#include "sansmesh/box.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// At each moment as ScalarField: negative inside, positive outside, in units of length near its zero set. Who runs in
/// parallel: the field does.
class TimeField {
 public:
  virtual ~TimeField() = default;

  /// Where the field is defined, at all moments; outside it evaluate() still returns finite values.
  virtual Box3 bounds() const = 0;
  /// When it is defined; both ends are finite.
  virtual TimeRange times() const = 0;

  /// Values at position x[i] at the moment t[i], which lies in times(), for every i. All spans have the length of x.
  /// Each answer depends on x[i] and t[i] alone. One call a batch: moments in a row evaluate fastest. Safe from several
  /// threads.
  virtual void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<double> values) const = 0;

  /// What all values within `radius` (length, >= 0) of x[i] during [t[i] − duration, t[i] + duration] lie between, as
  /// far as that is in times(): where it does not hold 0, no surface passes. Infinite ends where nothing is known.
  virtual void ranges(std::span<const Vec3> x, double radius, std::span<const double> t, double duration,
                      std::span<ValueRange> found) const = 0;
};

}  // namespace sansmesh::inline v1
