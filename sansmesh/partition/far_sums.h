// Sums over the patches of a tree at some points, sixteen of them at a time.
#pragma once

#include <cstddef>

#include "sansmesh/partition/far_tree.h"

namespace sansmesh::inline v1 {

/// Points and the sums over all patches at each: of dipoles / r³ (of open ones / r⁶), of area / r⁴, of area / r⁶; and
/// the gradients of those.
struct FarBatch {
  static constexpr std::size_t kBatch = 16;
  alignas(64) float x[3][kBatch], sum[3][kBatch], slope[3][3][kBatch];
};
/// The sums that are asked for: the winding number's alone, and those of far fields.
enum class FarSums { winding, closed, open };

/// At the first `count` points of the batch; gradients are left alone unless `gradient`, of which a winding number has
/// none.
void sum_sources(const FarTree& tree, FarSums sums, bool gradient, std::size_t count, FarBatch& batch);

}  // namespace sansmesh::inline v1
