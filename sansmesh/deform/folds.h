// Where a map of space is folded: several places come from one, inside out in between.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// Neighbouring points of a lattice where the determinant of the map's Jacobian is not above 0.
struct Fold {
  Box3 box;          ///< of the cells about its points
  Vec3 center;       ///< mean of its points
  double share = 0;  ///< of the volume looked at
  double least = 0;  ///< determinant

  static const ReportSchema& schema();
};

struct FoldReport {
  double share = 0;         ///< of the volume looked at: where the map is defined, and no gap
  double least = 0;         ///< determinant anywhere; 1 where nothing is known
  std::vector<Fold> folds;  ///< connected ones, the largest first
  GridBlock determinants;   ///< lattice with an array `determinant` (1 float; NaN outside of that volume)

  static const ReportSchema& schema();
};

/// Looks at the points of a lattice of 2 to 4096 points an axis over a box (first and last on its faces), each of which
/// stands for the volume about it. The stage of `progress` is "folds". Throws ArgumentError where the box has no size.
FoldReport find_folds(const SpaceMap& map, const Box3& box, const std::array<std::size_t, 3>& sizes,
                      Progress& progress);

}  // namespace sansmesh::inline v1
