// Kernels of projection operators, one step for groups of sixteen points.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {

enum class ProjectionFormula { levin, alexa, curvature };
enum class ProjectionFlow { fit, normal, free };

struct ProjectionKernel {
  ProjectionFormula formula = ProjectionFormula::curvature;
  bool sheets = false;    ///< samples that face away from those next to the point are ignored
  bool gaussian = false;  ///< weights exp(−d²/h²) instead of the compact ones
  /// curvature: reduce the weight of samples whose directional curvature exceeds λ = threshold / h, or ignore them.
  bool diffusion = true, hard = false;
  float threshold = 1;
  int tau = 2;  ///< curvature: exponent of the M-like weights, 1..3
  // Options of project_group_by_source only.
  ProjectionFlow flow = ProjectionFlow::fit;  ///< curvature: step onto the surface
  bool nonlinear = false;                     ///< levin: plane by minimisation
  int degree = 2;                             ///< levin, alexa: degree of the polynomial, 1..4
  bool incomplete = false;                    ///< levin, alexa: polynomial [x², y², xy, 1]

  bool by_source() const { return flow != ProjectionFlow::fit || nonlinear || degree != 2 || incomplete; }
};

/// For kernels that are not by_source(). Only lanes with inside > 0 hold a foot point.
void project_group(const ProjectionKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                   GroupFeet& out);

}  // namespace sansmesh::inline v1::detail
