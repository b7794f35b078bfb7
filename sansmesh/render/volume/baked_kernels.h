// Interpolation between the nodes of bricks, with SIMD kernels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

constexpr int kBrickCells = 8, kBrickNodes = kBrickCells + 1;
constexpr std::size_t kBrickSize =
    4u * kBrickNodes * kBrickNodes * kBrickNodes;  ///< floats per brick: a value and its gradient per node

/// The arrays of a tree of bricks. Branches: index of the first of eight children, or ~(index of the brick).
struct BrickTree {
  const std::int32_t* branches;  ///< roots first, x fastest
  const float* nodes;            ///< kBrickSize per brick, x fastest
  Vec3 lower, inverse;           ///< lower corner of the box; 1 / size of a root
  int counts[3];                 ///< numbers of roots
};

/// A point in the tree: its brick and its coordinates there, 0..kBrickCells.
struct BrickPoint {
  std::int32_t brick;
  float x, y, z;
};
BrickPoint brick_point(const BrickTree& tree, const Vec3& x);

/// Values and gradients at all x, which must be finite; one of the two may be empty. Points outside the box are clamped
/// to it.
void brick_values(const BrickTree& tree, std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients);

}  // namespace sansmesh::inline v1::detail
