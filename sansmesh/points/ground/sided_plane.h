// Planes of heights beside steps and edges of the ground.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "sansmesh/points/ground/local_plane.h"

namespace sansmesh::inline v1 {

/// Fits planes at points of which some are near a step or an edge: there, samples on one side are better than all.
class SidedPlanes {
 public:
  /// `unit`: spacing of the samples (length).
  explicit SidedPlanes(double unit) : unit_(unit) {}

  /// Height at 0 of the plane through all values; the more their deviation exceeds `least` (> 0), the more of
  /// that of the half plane with the least deviation, if it is below a third of that of all.
  double height(std::span<const PlaneValue> values, double least);
  /// Deviation of the values from the plane through all of them.
  double deviation(std::span<const PlaneValue> values);

 private:
  double deviation_from(const LocalPlane& plane, std::span<const PlaneValue> values);

  double unit_;
  std::vector<PlaneValue> side_;
  std::vector<double> scratch_;
  std::vector<std::pair<double, double>> squares_;  ///< squared distances with their weights
};

}  // namespace sansmesh::inline v1
