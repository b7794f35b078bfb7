// Query points in volumes for tests.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/cell_geometry.h"

namespace sansmesh::test {

/// Random points inside random cells, at least a hundredth from the faces. For lattices points between the ends.
inline std::vector<Vec3> points_within(const SampledVolume& volume, std::size_t count, unsigned seed = 5) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Vec3> points;
  while (points.size() < count) {
    if (volume.lattice) {
      Vec3 a;
      for (std::size_t k = 0; k < 3; ++k)
        a[k] = volume.lattice->lower[k] + (volume.lattice->upper[k] - volume.lattice->lower[k]) * uniform();
      points.push_back(volume.lattice->from_axes(a));
      continue;
    }
    const std::size_t cell = random() % volume.cells.size();
    const CellShape shape = volume.cells.shapes[cell];
    Vec3 u{0.01 + 0.98 * uniform(), 0.01 + 0.98 * uniform(), 0.01 + 0.98 * uniform()};
    if (shape == CellShape::tetrahedron) u = u / (1.02 + u.x + u.y + u.z);
    if (shape == CellShape::wedge) u = {u.x * (1 - u.y), u.y, u.z};
    std::array<double, 8> weights;
    shape_functions(shape, u, weights);
    Vec3 sum;
    for (std::size_t c = 0; c < volume.cells[cell].size(); ++c)
      sum += volume.corner(volume.cells[cell][c]) * weights[c];
    points.push_back(sum);
  }
  return points;
}

}  // namespace sansmesh::test
