// What a linear interpolant cuts out of one cell of a block, without the simplices that the cell consists of.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Closed polygons through points between corners of a cell: corner x + 2y + 4z, each point between two corners of
/// different signs.
struct CellPolygons {
  using Point = std::array<std::uint8_t, 2>;
  std::vector<Point> points;        ///< of one polygon after the other
  std::vector<std::uint32_t> ends;  ///< of each polygon, in `points`
};

/// The polygons whose normals point to the positive corners (bits of `negative`: the others). The simplices of a cell
/// have the edge between `outer`, a corner of its block, and the opposite corner, the middle of the block, and an edge
/// across each face that has one of the two. Where signs alternate around a face, that edge decides what is connected,
/// as it does for simplices. On faces in `split` (bit 2·axis + side), which simplices share, points on these edges
/// belong to the polygon.
void trace_cell(unsigned negative, std::size_t outer, unsigned split, CellPolygons& found);

/// Triangles of a polygon in space, the worst of them as good as can be. Counted from its first corner.
void best_triangles(std::span<const Vec3> corner, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace sansmesh::inline v1
