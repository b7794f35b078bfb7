// Values between the nodes of bricks: SIMD inside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

constexpr int kBrickCells = 8, kBrickNodes = kBrickCells + 1;
constexpr std::size_t kBrickSize = 4u * kBrickNodes * kBrickNodes * kBrickNodes;  ///< floats: a value and its gradient

/// The arrays of a tree of bricks. Branches: the first of eight children, or ~(number of the brick).
struct BrickTree {
  const std::int32_t* branches;  ///< roots first, x fastest
  const float* nodes;            ///< kBrickSize a brick, x fastest
  Vec3 lower, inverse;           ///< of the box; 1 / size of a root
  int counts[3];                 ///< of roots
};

/// A point in the tree: its brick and its place there, 0..kBrickCells.
struct BrickPlace {
  std::int32_t brick;
  float x, y, z;
};
BrickPlace brick_place(const BrickTree& tree, const Vec3& x);

/// Values and gradients at all of x, which must be finite; both or one may be wanted (the others empty). Points beyond
/// the box are moved onto it.
void brick_values(const BrickTree& tree, std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients);

}  // namespace sansmesh::inline v1::detail
