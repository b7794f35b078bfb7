// The sums behind the bilateral normals: sixteen points at a time, SIMD inside.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::detail {

struct GroupNormals {
  alignas(64) float x[kGroup], y[kGroup], z[kGroup];
  alignas(64) float height[kGroup];  ///< of the point over the planes of the samples that decided
};

/// Refines the unit normals in place, and fills in the heights. `inverse_height` of the candidates is 1 / (2σ²);
/// `inverse_turn` is 1 / τ².
void refine_group(std::span<const Candidate> candidates, const PointGroup& group, int iterations, float inverse_turn,
                  GroupNormals& normals);

}  // namespace sansmesh::detail
