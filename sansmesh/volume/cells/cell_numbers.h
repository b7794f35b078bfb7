// Enumerates the cells of any volume, lattices included.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/cell_corners.h"
#include "sansmesh/volume/cells/volume_locator.h"

namespace sansmesh::inline v1 {

inline std::size_t cell_count(const SampledVolume& volume) {
  if (!volume.lattice) return volume.cells.size();
  std::size_t count = 1;
  for (const auto& axis : volume.lattice->axes) count *= axis.size() - 1;
  return count;
}

/// The index of the k-th cell, k < cell_count(); for lattices as in CellLocation.
inline std::size_t nth_cell(const SampledVolume& volume, std::size_t k) {
  if (!volume.lattice) return k;
  const auto& axes = volume.lattice->axes;
  const std::size_t nx = axes[0].size(), ny = axes[1].size();
  return k % (nx - 1) + nx * (k / (nx - 1) % (ny - 1) + ny * (k / ((nx - 1) * (ny - 1))));
}

/// A cell with its corners, without a point in it.
inline CellLocation location_of_cell(const SampledVolume& volume, std::size_t cell) {
  CellLocation location;
  location.cell = static_cast<std::uint32_t>(cell);
  if (volume.lattice) {
    location.corner_count = 8;
    location.corners = corners_of_lattice_cell(*volume.lattice, cell);
    return location;
  }
  const auto corners = volume.cells[cell];
  location.corner_count = static_cast<std::uint8_t>(corners.size());
  std::copy(corners.begin(), corners.end(), location.corners.begin());
  return location;
}

}  // namespace sansmesh::inline v1
