// Simplification to a number of triangles: collapses the cheapest edges of the whole mesh first.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/mesh/edit/edge_collapses.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1::detail {

/// Values of the vertices that the costs take into account, such as colours.
struct VertexValues {
  static constexpr std::size_t kMost = 8;
  std::size_t columns = 0;  ///< at most kMost
  std::vector<double> of;   ///< `columns` per vertex, scaled to lengths
};

/// Collapses edges of a mesh with `prepare`d vertices in the order of their cost until at most `target` triangles are
/// left, or no edge can be collapsed. The cost is that of the current triangles around the edge (memoryless), the
/// merged vertex preserves the volume [lindstrom1998]. New triangles may be worse than `options.least_shape` only where
/// one around the edge is as bad. Error limits (`limit`) refer to the original triangles. Returns the weight of each
/// vertex in the properties of the one that it was merged into: they follow the position along the edge.
std::vector<double> collapse_cheapest(EdgeCollapses& mesh, std::size_t target, VertexValues values, Progress& progress);

}  // namespace sansmesh::inline v1::detail
