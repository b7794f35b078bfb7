// Small volumes for tests of jobs.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "sansmesh/volumes.h"
#include "volume/volume_grids.h"

namespace sansmesh::test {

/// Adds the positions as vectors "where"; all arrays are at points.
inline GridData with_vectors(GridData data) {
  GridBlock& block = data.blocks[0];
  std::vector<double> where;
  for (std::size_t i = 0; i < block_point_count(block); ++i) {
    const Vec3 x = block_point(block, i);
    where.insert(where.end(), {x.x, x.y, x.z});
  }
  block.point_arrays.set("where", std::move(where), 3);
  block.cell_arrays = {};
  return data;
}

inline VolumeModel model_of(GridData data, const VolumeModelOptions& options = {}) {
  return {std::move(data), "made.vti", options};
}

/// 1 in a ball of radius 0.3 about the centre of the unit cube, 0 outside, with a transition of about two samples
/// of 21.
inline double soft_ball(const Vec3& x) { return 0.5 * std::erfc((norm(x - Vec3{0.5, 0.5, 0.5}) - 0.3) * 20); }

}  // namespace sansmesh::test
