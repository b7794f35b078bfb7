// Shapes and corners of the cells of any volume, lattices included.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sansmesh/cell_list.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

inline CellShape shape_of_cell(const SampledVolume& volume, std::size_t cell) {
  return volume.lattice ? CellShape::hexahedron : volume.cells.shapes[cell];
}

/// Position of a cell corner as numbered in CellLocation.
inline Vec3 corner_position(const SampledVolume& volume, std::uint32_t corner) {
  return volume.lattice ? volume.lattice->position(corner) : volume.corner(corner);
}

/// The samples of a lattice at the corners of the cell from sample `first` on, in VTK's order of hexahedra.
inline std::array<std::uint32_t, 8> corners_of_lattice_cell(const Lattice& lattice, std::size_t first) {
  const auto at = static_cast<std::uint32_t>(first), row = static_cast<std::uint32_t>(lattice.axes[0].size());
  const std::uint32_t slab = row * static_cast<std::uint32_t>(lattice.axes[1].size());
  return {at, at + 1, at + row + 1, at + row, at + slab, at + slab + 1, at + slab + row + 1, at + slab + row};
}

}  // namespace sansmesh::inline v1
