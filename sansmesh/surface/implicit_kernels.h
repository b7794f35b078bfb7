// The sums over samples behind every implicit surface: sixteen points at a time, SIMD inside.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {

enum class ImplicitFormula { hoppe, adamson, adamson_covariance, kolluri, extremal, apss, amls };

struct ImplicitKernel {
  ImplicitFormula formula = ImplicitFormula::kolluri;
  int order = 4;          ///< of the generating functions, 2, 4 or 6 (amls)
  bool sheets = false;    ///< samples that face away from those next to the point are ignored
  bool gaussian = false;  ///< weights exp(−d²/h²) in place of the compact ones; amls has no others
};

struct GroupValues {
  alignas(64) float value[kGroup], x[kGroup], y[kGroup], z[kGroup];  ///< value and gradient
  alignas(64) float inside[kGroup];                                  ///< > 0 in the domain of definition
  alignas(64) float weight[kGroup];                                  ///< 0 where no support reaches
};

/// Values (and gradients, if asked for) at all lanes of the group. Away from the surface the value is that of the plain
/// weighted mean of the tangent planes, whatever the formula.
void implicit_values(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                     bool gradients, GroupValues& out);

/// The normal field Σ m_i φ_i of amls as it comes, in place of the gradient: x, y, z and weight alone have a meaning.
void implicit_normals(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                      GroupValues& out);

}  // namespace sansmesh::inline v1::detail
