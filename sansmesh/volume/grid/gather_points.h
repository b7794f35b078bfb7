// Scattered points with the cells that they have not got.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/gathered_cells.h"

namespace sansmesh::inline v1 {

/// The visible and finite points of all scattered blocks, neighbours near each other in an order that depends on their
/// places and values alone, with the cells of their Delaunay tetrahedralisation; `first` is what join_coincident
/// returns (points nearer to each other than 1e-9 of the whole are one). Counts into facts: hidden, not_finite. Throws
/// DataError where no points are left, and as delaunay_tetrahedra.
GatheredCells gather_scattered(const GridData& data, const std::vector<std::size_t>& order, VolumeFacts& facts,
                               std::vector<std::uint32_t>& first);

}  // namespace sansmesh::inline v1
