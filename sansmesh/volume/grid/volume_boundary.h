// Boundary surface of a volume, convex or not, where rays enter and leave.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/polyline_set.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Faces with only one cell, as outward triangles with shared vertices. Faces between cells of different size (AMR
/// levels, block borders) are excluded where the other side is covered.
TriangleMesh volume_boundary(const SampledVolume& volume);

/// The edges of these faces, without duplicates: the grid seen from outside. For a lattice the edges of its cells on
/// its six sides.
PolylineSet boundary_edges(const SampledVolume& volume);

/// Borders of a lattice's cells along an axis: at the samples, or half-way between them if these are in cells.
std::vector<double> cell_borders(const Lattice& lattice, std::size_t axis, bool in_cells);

}  // namespace sansmesh::inline v1
