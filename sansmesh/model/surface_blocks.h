// Blocks for the polygonisation of a surface of samples.
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
  std::span<const float> spacings;  ///< around the centres (length); none where the balls tell how fine the surface is
  Box3 bounds;
  double smoothing = 0;  ///< median width of the weights over the spacing
  bool sharp = false;    ///< vertices are placed on sharp edges
};

/// Data to find places where large triangles suffice.
struct FlatSurface {
  const PointSet& feet;  ///< of the balls' centres, with normals
  double error;          ///< accepted gap between surface and triangles, on average (length)
};

/// As fine as the samples near them, times `coarseness`; with `flat` larger where the surface is a single sheet and
/// flat, and no finer than the weights are wide.
BlockTree surface_blocks(const SurfaceSupport& surface, double coarseness, const std::optional<FlatSurface>& flat = {});

}  // namespace sansmesh::inline v1
