// The sums behind the bilateral normals: sixteen points at a time, SIMD inside.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {

struct GroupNormals {
  alignas(64) float x[kGroup], y[kGroup], z[kGroup];
  alignas(64) float height[kGroup];  ///< of the point over the planes of the samples that decided
};

/// How much a sample counts.
enum class NormalFormula {
  bilateral,           ///< compact weight, times functions of height and turn
  bilateral_gaussian,  ///< the same with exp(−d²/h²)
  laguerre  ///< (35/8 − 7/2 s + ½ s²) e^{−s} with s = ε d²/h² + height² / (2σ²): the source's, nothing else
};

/// Refines the unit normals in place, and fills in the heights. `inverse_height` of the candidates is 1 / (2σ²);
/// `inverse_turn` is 1 / τ². `inverse_support`: of compact weights 1 / (2h)², else 1 / h² (laguerre: ε / h²).
void refine_group(NormalFormula formula, std::span<const Candidate> candidates, const PointGroup& group, int iterations,
                  float inverse_turn, GroupNormals& normals);

}  // namespace sansmesh::inline v1::detail
