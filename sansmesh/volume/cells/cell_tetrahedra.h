// Consistent subdivision of cells into tetrahedra and of quadrilaterals into triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1::detail {

/// Appends the faces of a cell as triangles, counter-clockwise from outside, as corner numbers (0..7) of the cell.
/// Quadrilaterals are split along the diagonal at the corner of smallest point number, equally on both sides.
void face_triangles(CellShape shape, std::span<const std::uint32_t> corners,
                    std::vector<std::array<std::uint8_t, 3>>& out);

/// Appends tetrahedra that fill the cell, as point numbers: from its corner of smallest number to the triangles of the
/// faces without it (pulling triangulation).
void cell_tetrahedra(CellShape shape, std::span<const std::uint32_t> corners,
                     std::vector<std::array<std::uint32_t, 4>>& out);

/// A volume (samples at cell corners, no lattice) split into tetrahedra, without those of zero volume. Only positions
/// and cells of the result are set.
struct TetrahedralVolume {
  std::shared_ptr<const SampledVolume> volume;
  std::vector<std::uint32_t> cell_of;  ///< source cell of each tetrahedron; empty if all cells are tetrahedra
};
TetrahedralVolume tetrahedra_of(const std::shared_ptr<const SampledVolume>& volume);

}  // namespace sansmesh::inline v1::detail
