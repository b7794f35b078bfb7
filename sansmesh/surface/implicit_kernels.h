// Kernels of implicit surfaces: sums over samples for groups of sixteen points.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {

enum class ImplicitFormula { hoppe, adamson, adamson_covariance, kolluri, extremal, apss, amls };

struct ImplicitKernel {
  ImplicitFormula formula = ImplicitFormula::kolluri;
  int order = 4;          ///< amls only: order of the generating functions, 2, 4 or 6
  bool sheets = false;    ///< samples that face away from those next to the point are ignored
  bool gaussian = false;  ///< weights exp(−d²/h²) instead of the compact ones; amls always uses Gaussians
};

struct GroupValues {
  alignas(64) float value[kGroup], x[kGroup], y[kGroup], z[kGroup];  ///< value and gradient
  alignas(64) float inside[kGroup];                                  ///< > 0 in the domain of definition
  alignas(64) float weight[kGroup];                                  ///< 0 where no support reaches
};

/// Values, and gradients on request, at all lanes of the group. Away from the surface the value is that of the plain
/// weighted mean of the tangent planes, for all formulas.
void implicit_values(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                     bool gradients, GroupValues& out);

/// Unnormalised normal field Σ m_i φ_i of amls in place of the gradient: only x, y, z and weight are defined.
void implicit_normals(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                      GroupValues& out);

}  // namespace sansmesh::inline v1::detail
