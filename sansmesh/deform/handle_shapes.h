// Handles and folds as something to see.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sansmesh/deform/folds.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct HandleShapeOptions {
  double radius = 0;  ///< of the balls, > 0 (length)
  std::array<std::uint8_t, 3> before{96, 125, 160}, after{214, 88, 38};
};

/// A ball where each handle was and one where it went, segments as rods, an arrow from the one to the other where it
/// moved by more than its ball, and arrows along directions. Colours tell before from after.
TriangleMesh handle_shapes(std::span<const Handle> handles, const HandleShapeOptions& options);

/// The cells about the points of a lattice that find_folds() found folded, as one red surface around them; empty where
/// there are none.
TriangleMesh fold_shapes(const FoldReport& folds, const std::array<std::uint8_t, 3>& color = {222, 30, 30});

}  // namespace sansmesh::inline v1
