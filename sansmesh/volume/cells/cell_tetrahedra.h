// Cells cut into tetrahedra, quadrilaterals into triangles, in the same way on both sides of a face.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1::detail {

/// Appends the faces of a cell as triangles, counter-clockwise from outside; quadrilaterals are cut along the diagonal
/// that ends at the corner of least number. As numbers of corners (0..7) of the cell.
void face_triangles(CellShape shape, std::span<const std::uint32_t> corners,
                    std::vector<std::array<std::uint8_t, 3>>& out);

/// Appends tetrahedra that make up the cell: from its corner of least number to the triangles of the faces without it
/// (the pulling triangulation). As numbers of points.
void cell_tetrahedra(CellShape shape, std::span<const std::uint32_t> corners,
                     std::vector<std::array<std::uint32_t, 4>>& out);

/// A volume whose samples are the corners of its cells (no lattice), cut into tetrahedra; those without volume are left
/// out. Of the result only positions and cells are set.
struct TetrahedralVolume {
  std::shared_ptr<const SampledVolume> volume;
  std::vector<std::uint32_t> cell_of;  ///< the cell that a tetrahedron is of; empty where all are tetrahedra
};
TetrahedralVolume tetrahedra_of(const std::shared_ptr<const SampledVolume>& volume);

}  // namespace sansmesh::inline v1::detail
