// The surface of a volume, convex or not: where rays enter and leave it.
#pragma once

#include "sansmesh/polyline_set.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Faces that only one cell has, as triangles turned outwards, with shared vertices. Faces between cells of different
/// size (levels of AMR, borders of blocks) do not count where the other side is covered.
TriangleMesh volume_boundary(const SampledVolume& volume);

/// The edges of these faces, each once: what the grid looks like from outside. Of a lattice the borders of its cells
/// along its six sides.
PolylineSet boundary_edges(const SampledVolume& volume);

}  // namespace sansmesh::inline v1
