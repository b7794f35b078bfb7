// Polygons in which the zero set of the piecewise linear interpolant cuts one cell, without tracing its simplices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Closed polygons whose vertices lie on segments between two corners of different sign. Corner index: x + 2y + 4z.
struct CellPolygons {
  using Point = std::array<std::uint8_t, 2>;
  std::vector<Point> points;        ///< vertices of all polygons, consecutively
  std::vector<std::uint32_t> ends;  ///< end of each polygon in `points`
};

/// Traces the polygons, with normals towards the positive corners; `negative` has a bit for each negative corner. The
/// simplices of a cell share the edge between `outer`, a corner of the block, and the opposite corner, the block's
/// centre; on each face they share the diagonal from one of these two. Where signs alternate around a face, that
/// diagonal decides the connection. On faces in `split` (bit 2·axis + side), which simplices of other blocks share,
/// crossing points on the diagonal become polygon vertices.
void trace_cell(unsigned negative, std::size_t outer, unsigned split, CellPolygons& found);

/// Triangulates a polygon in space such that its worst triangle is as well shaped as possible. Indices count from the
/// polygon's first corner.
void best_triangles(std::span<const Vec3> corner, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace sansmesh::inline v1
