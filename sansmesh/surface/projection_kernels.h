// Kernels of projection operators, one step for groups of sixteen points.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

enum class ProjectionMethod {
  levin,     ///< plane of least weighted squares over direction and offset, then a polynomial (levin2003)
  alexa,     ///< the same with weights about the point itself: one step (alexa2003)
  curvature  ///< mean plane, then principal curvatures from directional ones (tejada2008, 4.2)
};

namespace detail {

/// Steps of the iteration to the plane of levin.
constexpr int kLevinSteps = 6;

struct ProjectionKernel {
  ProjectionMethod method = ProjectionMethod::curvature;
  bool sheets = false;    ///< samples that face away from those next to the point are ignored
  bool gaussian = false;  ///< weights exp(−d²/h²) instead of the compact ones
  /// curvature: reduce the weight of samples whose directional curvature exceeds λ = threshold / h, or ignore them.
  bool diffusion = true, hard = false;
  float threshold = 1;
  int tau = 2;  ///< curvature: exponent of the M-like weights, 1..3
  // Options of project_group_as_published only.
  SurfaceFlow flow = SurfaceFlow::fit;  ///< curvature: step onto the surface
  bool nonlinear = false;               ///< levin: plane by minimisation
  int degree = 2;                       ///< levin, alexa: degree of the polynomial, 1..4
  bool incomplete = false;              ///< levin, alexa: polynomial [x², y², xy, 1]

  bool as_published() const { return flow != SurfaceFlow::fit || nonlinear || degree != 2 || incomplete; }
};

/// For kernels that are not as_published(). Only lanes with inside > 0 hold a foot point.
void project_group(const ProjectionKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                   GroupFeet& out);

}  // namespace detail
}  // namespace sansmesh::inline v1
