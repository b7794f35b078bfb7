// Meshes that show handles and folds.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sansmesh/deform/maps/folds.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct HandleShapeOptions {
  double radius = 0;  ///< radius of the balls, > 0 (length)
  std::array<std::uint8_t, 3> before{96, 125, 160}, after{214, 88, 38};
};

/// A ball at each handle's position before and after, segments as rods, an arrow between the two positions if the
/// handle moves by more than its ball, and arrows along directions. Colours distinguish before and after.
TriangleMesh handle_shapes(std::span<const Handle> handles, const HandleShapeOptions& options);

/// The cells around the lattice points of find_folds() that are folded, as one red surface; empty if there are none.
TriangleMesh fold_shapes(const FoldReport& folds, const std::array<std::uint8_t, 3>& color = {222, 30, 30});

}  // namespace sansmesh::inline v1
