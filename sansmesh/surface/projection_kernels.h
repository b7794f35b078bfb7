// One application of a projection operator to a group of points: sixteen at a time, SIMD inside.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::detail {

enum class ProjectionFormula { levin, alexa, curvature };

struct ProjectionKernel {
  ProjectionFormula formula = ProjectionFormula::curvature;
  bool sheets = false;  ///< samples that face away from those next to the point are ignored
  /// curvature: samples whose directional curvature exceeds λ = threshold / h count less, or not at all.
  bool diffusion = true, hard = false;
  float threshold = 1;
  int tau = 2;  ///< curvature: exponent of the M-like weights, 1..3
};

/// Only lanes with inside > 0 hold a foot point.
void project_group(const ProjectionKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                   GroupFeet& out);

}  // namespace sansmesh::detail
