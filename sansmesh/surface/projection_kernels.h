// One application of a projection operator to a group of points: sixteen at a time, SIMD inside.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {

enum class ProjectionFormula { levin, alexa, curvature };
enum class ProjectionFlow { fit, normal, free };

struct ProjectionKernel {
  ProjectionFormula formula = ProjectionFormula::curvature;
  bool sheets = false;    ///< samples that face away from those next to the point are ignored
  bool gaussian = false;  ///< weights exp(−d²/h²) in place of the compact ones
  /// curvature: samples whose directional curvature exceeds λ = threshold / h count less, or not at all.
  bool diffusion = true, hard = false;
  float threshold = 1;
  int tau = 2;  ///< curvature: exponent of the M-like weights, 1..3
  // What only project_group_by_source heeds.
  ProjectionFlow flow = ProjectionFlow::fit;  ///< curvature: how points get to their place
  bool nonlinear = false;                     ///< levin: the plane by minimisation
  int degree = 2;                             ///< levin, alexa: of the polynomial, 1..4
  bool incomplete = false;                    ///< [x², y², xy, 1]

  bool by_source() const { return flow != ProjectionFlow::fit || nonlinear || degree != 2 || incomplete; }
};

/// Of kernels that are not by_source(). Only lanes with inside > 0 hold a foot point.
void project_group(const ProjectionKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                   GroupFeet& out);

}  // namespace sansmesh::inline v1::detail
