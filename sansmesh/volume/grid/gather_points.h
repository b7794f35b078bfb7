// Gathers scattered points and tetrahedralises them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/gathered_cells.h"

namespace sansmesh::inline v1 {

/// The visible and finite points of all scattered blocks, with their Delaunay tetrahedralisation. Neighbours are close
/// in memory; the order depends only on positions and values. `first` receives the result of join_coincident (points
/// within 1e-9 of the extent coincide). Adds to facts: hidden, not_finite. Throws DataError if no points remain, and as
/// delaunay_tetrahedra.
GatheredCells gather_scattered(const GridData& data, const std::vector<std::size_t>& order, VolumeFacts& facts,
                               std::vector<std::uint32_t>& first);

}  // namespace sansmesh::inline v1
