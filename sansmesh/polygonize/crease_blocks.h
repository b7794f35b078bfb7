// Blocks for fields with creases: small along creases, elsewhere as large as the pieces allow.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/box.h"
#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

struct CreaseBlockOptions {
  /// Edge of the blocks along creases, and wherever more than one piece is near (length, > 0).
  double cell = 0;
  /// Edge of the blocks on curved pieces of which nothing else is known; at least `cell`. Smaller ones, down to `cell`,
  /// only where pieces bend so much that blocks of this size would miss their shape.
  double smooth_cell = 0;
  /// Pieces that depart from planes by no more than this over a block need no smaller ones (length). Negative: all
  /// blocks along the surface have the edge `cell`.
  double flat = -1;
  /// What the field's gradients are at most, where that is known: values tell by it where the surface may be. Else
  /// PiecewiseField::ranges() tells.
  std::optional<double> slope;
};

/// A tree of blocks for polygonize_with_creases(), with a cube around `box`. Blocks that the surface may pass through
/// are cut down to `cell` unless the field's survey() says that only one piece is near, with room for the triangles
/// along creases; that it is flat, or no finer than the block in its detail, has been asked at 27 points. Down to the
/// level of kCreaseBaseLevel all blocks are cut that meet the box: fields are distances only near their surfaces.
BlockTree crease_blocks(const PiecewiseField& field, const Box3& box, const CreaseBlockOptions& options,
                        Progress& progress);
/// The same, or nothing if that takes more than `most` blocks.
std::optional<BlockTree> crease_blocks(const PiecewiseField& field, const Box3& box, const CreaseBlockOptions& options,
                                       Progress& progress, std::size_t most);

constexpr int kCreaseBaseLevel = 5;

}  // namespace sansmesh::inline v1
