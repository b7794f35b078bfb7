// Block trees for the polygonization of a surface of samples.
#pragma once

#include <optional>
#include <span>

#include "sansmesh/box.h"
#include "sansmesh/field/ball_union.h"
#include "sansmesh/point_set.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

/// Support of a surface of samples.
struct SurfaceSupport {
  const BallUnion& balls;
  /// Local spacing at the centres (length); empty if the balls determine the resolution.
  std::span<const float> spacings;
  Box3 bounds;
  double smoothing = 0;  ///< median width of the weight functions over the spacing
  bool sharp = false;    ///< vertices are placed on sharp edges
};

/// Data to find regions where large triangles suffice.
struct FlatSurface {
  const PointSet& feet;  ///< projections of the ball centres onto the surface, with normals
  double error;          ///< accepted mean distance between surface and triangles (length)
};

/// Blocks as fine as the local samples, times `coarseness`; with `flat` larger where the surface is a single flat
/// sheet, and no finer than the width of the weight functions.
BlockTree surface_blocks(const SurfaceSupport& surface, double coarseness, const std::optional<FlatSurface>& flat = {});

}  // namespace sansmesh::inline v1
