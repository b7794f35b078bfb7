// Fewer triangles for the same surface.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/mesh/edit/collapse_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Collapses edges as long as the quadric error (Garland & Heckbert 1997, "Surface simplification using quadric error
/// metrics") stays below `error`, cheapest first among their surroundings, many at once. Topology, closedness and
/// manifoldness stay; no triangle turns by more than 60° at once; borders move within the error. What belongs
/// to merged vertices becomes their mean weighted by area (attributes: as AttributeTable says); triangles that are left
/// keep their attributes. The same for any number of threads. Returns whether anything changed. `from` gets the number
/// that each triangle had before, `becomes` that which each vertex, or the one it was merged into, has afterwards.
bool simplify_mesh(TriangleMesh& mesh, const CollapseOptions& options, Progress& progress,
                   std::vector<std::uint32_t>* from = nullptr, std::vector<std::uint32_t>* becomes = nullptr);

}  // namespace sansmesh::inline v1
