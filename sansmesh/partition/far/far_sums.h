// Sums over the patches of a tree, for sixteen points at a time.
#pragma once

#include <cstddef>

#include "sansmesh/partition/far/far_tree.h"

namespace sansmesh::inline v1 {

/// Points and the sums over all patches at each: dipoles / r³ (/ r⁶ for open surfaces), area / r⁴, area / r⁶; and their
/// gradients.
struct FarBatch {
  static constexpr std::size_t kBatch = 16;
  alignas(64) float x[3][kBatch], sum[3][kBatch], slope[3][3][kBatch];
};
/// Kind of sums: the winding number only, or those of a far field.
enum class FarSums { winding, closed, open };

/// Computes the sums at the first `count` points of the batch. Gradients are unchanged unless `gradient`; a winding
/// number has none.
void sum_sources(const FarTree& tree, FarSums sums, bool gradient, std::size_t count, FarBatch& batch);

/// Computes FarBatch::sum[0] roughly, of a winding number or of open patches: a group beyond 1.5 of its radius counts
/// as one patch. Of open ones sum[1] is Σ area / r⁵, the most that sum[0] could be, and sum[2] Σ area / r⁶.
void sum_roughly(const FarTree& tree, bool open, std::size_t count, FarBatch& batch);

}  // namespace sansmesh::inline v1
