// The cells of any volume, lattices too, one by one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"

namespace sansmesh::inline v1 {

inline std::size_t cell_count(const SampledVolume& volume) {
  if (!volume.lattice) return volume.cells.size();
  std::size_t count = 1;
  for (const auto& axis : volume.lattice->axes) count *= axis.size() - 1;
  return count;
}

/// The number of the k-th cell, k < cell_count(): of lattices as in VolumePlace.
inline std::size_t nth_cell(const SampledVolume& volume, std::size_t k) {
  if (!volume.lattice) return k;
  const auto& axes = volume.lattice->axes;
  const std::size_t nx = axes[0].size(), ny = axes[1].size();
  return k % (nx - 1) + nx * (k / (nx - 1) % (ny - 1) + ny * (k / ((nx - 1) * (ny - 1))));
}

/// A cell and its corners, at no place in it.
inline VolumePlace place_of_cell(const SampledVolume& volume, std::size_t cell) {
  VolumePlace place;
  place.cell = static_cast<std::uint32_t>(cell);
  if (volume.lattice) {
    const auto along = static_cast<std::uint32_t>(volume.lattice->axes[0].size());
    const auto across = along * static_cast<std::uint32_t>(volume.lattice->axes[1].size());
    const std::uint32_t ring[] = {0, 1, along + 1, along};
    place.corner_count = 8;
    for (std::size_t v = 0; v < 8; ++v) place.corners[v] = place.cell + ring[v % 4] + (v < 4 ? 0 : across);
    return place;
  }
  const auto corners = volume.cells[cell];
  place.corner_count = static_cast<std::uint8_t>(corners.size());
  std::copy(corners.begin(), corners.end(), place.corners.begin());
  return place;
}

}  // namespace sansmesh::inline v1
