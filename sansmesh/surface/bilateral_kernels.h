// Kernels of bilateral normals, for groups of sixteen points.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {

struct GroupNormals {
  alignas(64) float x[kGroup], y[kGroup], z[kGroup];
  alignas(64) float height[kGroup];  ///< height of the point over the tangent planes of the contributing samples
};

/// Weight functions of samples.
enum class NormalFormula {
  bilateral,           ///< compact weight, times functions of height and of the angle of normals
  bilateral_gaussian,  ///< the same with the radial weight exp(−d²/h²)
  laguerre  ///< (35/8 − 7/2 s + ½ s²) e^{−s} with s = ε d²/h² + height² / (2σ²) (tejada2008, 4.3.2)
};

/// Refines the unit normals in place, and computes the heights. `inverse_height` of the candidates is 1 / (2σ²);
/// `inverse_turn` is 1 / τ². `inverse_support`: 1 / (2h)² for compact weights, 1 / h² for Gaussians, ε / h² for
/// laguerre.
void refine_group(NormalFormula formula, std::span<const Candidate> candidates, const PointGroup& group, int iterations,
                  float inverse_turn, GroupNormals& normals);

}  // namespace sansmesh::inline v1::detail
