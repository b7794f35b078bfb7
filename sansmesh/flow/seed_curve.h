// Seed curves: polylines parametrised by arc length.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct SeedCurve {
  std::vector<Vec3> points;  ///< at least two, for a closed curve three; straight between them
  bool closed = false;       ///< connects the last point to the first

  double length() const;
  /// The point at arc length s from the first point; s is clamped to 0..length(), or wrapped on a closed curve.
  Vec3 at(double s) const;
  /// Points at several arc lengths, in time logarithmic in the number of points.
  std::vector<Vec3> at(std::span<const double> s) const;
  /// Throws ArgumentError unless there are enough points, all finite, and a positive length.
  void validate() const;
};

}  // namespace sansmesh::inline v1
