// Mesh simplification by edge collapses.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/mesh/edit/collapse_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Collapses edges with a quadric error [garland1997] below `error`, local minima of the cost first, many in parallel;
/// or for a number of triangles, the cheapest of all (collapse_cheapest.h). Preserves topology, closedness and
/// manifoldness; no triangle turns by more than 60° at once; borders move within the error. Merged vertices get the
/// area-weighted mean of their properties (attributes: as in AttributeTable); remaining triangles keep their
/// attributes. Independent of the number of threads. Returns whether anything changed. `from` receives the former index
/// of each triangle, `becomes` the new index of each former vertex or of the one it was merged into.
bool simplify_mesh(TriangleMesh& mesh, const CollapseOptions& options, Progress& progress,
                   std::vector<std::uint32_t>* from = nullptr, std::vector<std::uint32_t>* becomes = nullptr);

}  // namespace sansmesh::inline v1
