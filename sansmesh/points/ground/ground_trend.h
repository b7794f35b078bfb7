// Smooth approximate surface of the ground.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/points/ground/ground_grid.h"
#include "sansmesh/points/ground/local_plane.h"

namespace sansmesh::inline v1 {

/// A plane in each square of 2 × 2 cells, through the ground around it.
class GroundTrend {
 public:
  /// Height and slope (rise over run) of the plane at a position.
  struct At {
    double height = 0, slope = 0;
  };

  GroundTrend() = default;
  /// `ground`: 1 for cells whose lowest samples are ground.
  GroundTrend(const PointSet& points, const GroundGrid& grid, const std::vector<std::uint8_t>& ground);

  bool empty() const { return planes_.empty(); }
  At at(double x, double y) const;

 private:
  double square_ = 0, left_ = 0, bottom_ = 0;
  std::size_t columns_ = 0, rows_ = 0;
  std::vector<LocalPlane> planes_;  ///< at the centres of the squares
};

}  // namespace sansmesh::inline v1
