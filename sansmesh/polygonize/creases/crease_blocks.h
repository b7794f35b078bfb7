// Block trees for fields with creases: small blocks along creases, elsewhere as large as the pieces allow.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/box.h"
#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

struct CreaseBlockOptions {
  /// Edge of the blocks near creases, where more than one piece is close (length, > 0).
  double cell = 0;
  /// Edge of blocks on curved pieces without further information; at least `cell`. Blocks become smaller, down to
  /// `cell`, only where a piece curves so strongly that blocks of this size would miss its shape.
  double smooth_cell = 0;
  /// Accepted deviation of a piece from a plane over a block (length). Negative: all blocks along the surface have the
  /// edge `cell`.
  double flat = -1;
  /// Bound of the norm of the field's gradient, if known: values then bound the location of the surface. Otherwise
  /// PiecewiseField::ranges() does.
  std::optional<double> slope;
};

/// A tree of blocks for polygonize_with_creases() over a cube around `box`. Blocks that the surface may cross are
/// divided down to `cell`, unless survey() reports a single piece within reach of the triangles along creases that is
/// flat or has no detail below the block size, tested at 27 points. Down to kCreaseBaseLevel all blocks that meet the
/// box are divided, because fields are distances only near their surfaces.
BlockTree crease_blocks(const PiecewiseField& field, const Box3& box, const CreaseBlockOptions& options,
                        Progress& progress);
/// As above, but returns nothing if the tree would exceed `most` blocks.
std::optional<BlockTree> crease_blocks(const PiecewiseField& field, const Box3& box, const CreaseBlockOptions& options,
                                       Progress& progress, std::size_t most);

constexpr int kCreaseBaseLevel = 5;

}  // namespace sansmesh::inline v1
