// Detects folds of a map of space: regions that it turns inside out.
#pragma once

#include <array>
#include <cstddef>

#include "sansmesh/box.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// Evaluates the map at the points of a lattice of 2 to 4096 points per axis over a box (first and last on its faces);
/// each represents the volume around it. The stage of `progress` is "folds". Throws ArgumentError if the box has no
/// size.
FoldReport find_folds(const SpaceMap& map, const Box3& box, const std::array<std::size_t, 3>& sizes,
                      Progress& progress);

}  // namespace sansmesh::inline v1
