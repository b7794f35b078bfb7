// Flat cells made solid: data in a plane or on a surface as a slab.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/gathered_cells.h"

namespace sansmesh::inline v1 {

struct FlatCell {
  std::array<std::uint32_t, 4> corners;  ///< in the list of all points, a ring; the last GridBlock::kNone of triangles
  std::uint32_t row;                     ///< in its block
  std::uint16_t block;                   ///< as the file numbers them
};

/// Replaces the points of `gathered`, which has no cells yet, by two each, half a thickness to both sides, and adds
/// the flat cells as hexahedra and wedges between them. The thickness is the median of all edges of all blocks. The
/// sides are the same ones for all cells that hang together by edges, however their corners are wound; parts that do
/// not hang together have the same sides where they lie in planes. Points at one place are moved the same way. Counts
/// into facts: layer.
void thicken(const std::vector<FlatCell>& cells, bool centers, GatheredCells& gathered, VolumeFacts& facts);

}  // namespace sansmesh::inline v1
