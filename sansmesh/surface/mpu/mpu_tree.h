// Octree of multi-level partition of unity implicits with the shapes of its leaves, as flat arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/progress.h"
#include "sansmesh/surface/mpu/local_shape.h"
#include "sansmesh/surface/mpu/mpu_options.h"
#include "sansmesh/triangulation/block_tree.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// N_min of ohtake2003: a ball with fewer samples is enlarged for its fit.
inline constexpr std::size_t kLeastSamples = 15;

/// Kind of the shape of a leaf.
enum class LeafShape : std::uint8_t { heights, general, edge, corner };

/// A leaf of the octree. Its shape has weight in the ball around its centre, which extends beyond the cell.
struct MpuLeaf {
  Vec3 center;
  double radius = 0;              ///< radius of the ball (length)
  double edge = 0;                ///< edge of the cell (length)
  std::uint32_t first_piece = 0;  ///< index in `pieces`
  std::uint32_t samples = 0;      ///< number in the ball before it was enlarged
  PieceCombination combination;
  LeafShape shape = LeafShape::heights;
  std::uint8_t level = 0;
};

struct MpuTree {
  BlockTree cells{{}, 0};
  std::vector<std::uint32_t> leaf_of;  ///< index in `leaves` of each cell that is a leaf
  std::vector<MpuLeaf> leaves;         ///< in the order of their cells along the Morton curve
  std::vector<QuadricPiece> pieces;

  /// The leaf that contains x, a point of the cube.
  std::size_t leaf_at(const Vec3& x) const;
};

/// Fits the tree (ohtake2003, sections 3 and 4). Finite positions with unit normals, in an order that keeps neighbours
/// together. `error`: accepted error (length). Throws DataError for no samples, or if all coincide.
MpuTree fit_mpu_tree(std::span<const Vec3f> positions, std::span<const Vec3f> normals, double error, int max_depth,
                     bool sharp, Progress& progress);

}  // namespace sansmesh::inline v1
