// Volumes of assembled cells, and comparison of assembled volumes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/cell_geometry.h"
#include "sansmesh/volume/cells/volume_locator.h"

namespace sansmesh::test {

inline double volume_of_cells(const SampledVolume& volume) {
  if (volume.lattice) {
    double product = 1;
    for (std::size_t k = 0; k < 3; ++k) product *= volume.lattice->upper[k] - volume.lattice->lower[k];
    return product;
  }
  double sum = 0;
  std::array<Vec3, 8> x;
  for (std::size_t c = 0; c < volume.cells.size(); ++c) {
    const auto corners = volume.cells[c];
    for (std::size_t k = 0; k < corners.size(); ++k) x[k] = volume.corner(corners[k]);
    sum += cell_volume(volume.cells.shapes[c], std::span(x).first(corners.size()));
  }
  return sum;
}

/// For overlapping cells: the share of random points of the box that are inside.
inline double volume_by_chance(const SampledVolume& volume) {
  const Box3 box = volume.bounds();
  std::mt19937 random(3);
  std::vector<Vec3> x(50000);
  for (Vec3& p : x)
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = box.lower[k] + box.size()[k] * static_cast<double>(random()) / 4294967296.0;
  std::vector<CellLocation> locations(x.size());
  VolumeLocator(volume).locate(x, locations);
  const auto inside = std::count_if(locations.begin(), locations.end(), [](const CellLocation& p) { return p.inside; });
  return box.size().x * box.size().y * box.size().z * static_cast<double>(inside) / static_cast<double>(x.size());
}

inline bool same_but_for_blocks(const SampledVolume& a, const SampledVolume& b) {
  return a.positions == b.positions && a.corners == b.corners && a.cells.shapes == b.cells.shapes &&
         a.cells.corners == b.cells.corners && a.cells.first == b.cells.first && a.cell_sample == b.cell_sample &&
         a.stars.entries == b.stars.entries && a.stars.first == b.stars.first && a.part == b.part &&
         a.level == b.level && a.attributes == b.attributes;
}

}  // namespace sansmesh::test
