// Simplification of a mesh by patches.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/mesh/edit/edge_collapses.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1::detail {

/// Vertices per patch: its data fits into the cache of one core.
constexpr std::size_t kPatch = 4096;

/// Collapses edges within patches of kPatch vertices, independently per patch: without cache misses or synchronisation
/// with remote parts. Returns the vertices with untried edges, at the borders of patches. Independent of the number of
/// threads.
std::vector<std::uint32_t> collapse_patches(EdgeCollapses& mesh, Progress& progress);

}  // namespace sansmesh::inline v1::detail
