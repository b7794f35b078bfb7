// Extrudes flat cells: data in a plane or on a surface become a slab.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/gathered_cells.h"

namespace sansmesh::inline v1 {

struct FlatCell {
  std::array<std::uint32_t, 4>
      corners;          ///< in the list of all points, a ring; the last is GridBlock::kNone for triangles
  std::uint32_t row;    ///< row in its block
  std::uint16_t block;  ///< block number in the file
};

/// Replaces each point of `gathered`, which has no cells yet, by two, offset by half the thickness to both sides, and
/// adds the flat cells as hexahedra and wedges between them. The thickness is the median edge length over all blocks.
/// Cells connected by edges have consistent sides for any orientation of their corners; unconnected parts have
/// the same sides if they are planar. Coincident points are moved equally. Adds to facts: layer.
void thicken(const std::vector<FlatCell>& cells, bool centers, GatheredCells& gathered, VolumeFacts& facts);

}  // namespace sansmesh::inline v1
