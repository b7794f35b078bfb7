// Simplification of a mesh patch by patch.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/mesh/edit/edge_collapses.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1::detail {

/// A patch has so many vertices: what belongs to them fits into a core's own cache.
constexpr std::size_t kPatch = 4096;

/// Collapses what lies within patches of kPatch vertices, each patch by itself: without looking beyond a core's cache
/// and without taking turns with what is far away. Returns the vertices whose edges were not all tried: those at the
/// borders of patches. The same for any number of threads.
std::vector<std::uint32_t> collapse_patches(EdgeCollapses& mesh, Progress& progress);

}  // namespace sansmesh::inline v1::detail
