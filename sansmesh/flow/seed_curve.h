// Curves that particles start on: polylines by arc length.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct SeedCurve {
  std::vector<Vec3> points;  ///< at least two, of a closed curve three; straight between them
  bool closed = false;       ///< from the last point back to the first

  double length() const;
  /// The place at the length s from the first point; s is kept within 0..length(), or wrapped around a closed curve.
  Vec3 at(double s) const;
  /// Those at many lengths, in time logarithmic in the number of points.
  std::vector<Vec3> at(std::span<const double> s) const;
  /// Throws ArgumentError unless there are enough points, all finite, with a length.
  void validate() const;
};

}  // namespace sansmesh::inline v1
