// Projections exactly as published, one point at a time in double precision, without the simplifications of
// projection_kernels.h.
#pragma once

#include <span>

#include "sansmesh/surface/levin_plane.h"
#include "sansmesh/surface/projection_kernels.h"

namespace sansmesh::inline v1::detail {

/// Polynomial over a plane, with coordinates u, v and heights in the frame of tangent_frame(normal).
struct PlanePolynomial {
  double value = 0, u = 0, v = 0;  ///< value and slopes at the origin
  double uu = 0, uv = 0, vv = 0;   ///< second derivatives at the origin
  int degree = 0;                  ///< degree that the samples determine
};

/// Weighted least-squares polynomial over the plane through q with this normal, with weights about q. `degree`: 1..4,
/// lowered where the samples do not determine it; `incomplete`: degree 2 without slopes, [x², y², xy, 1]. `width`: unit
/// of length of the coordinates.
PlanePolynomial fit_polynomial(std::span<const WeighedSample> samples, const Vec3& q, const Vec3& normal, int degree,
                               bool incomplete, double width);

/// Fixed point of x ← x + Δt (1/Ω) Σ ω_i g_i (x_i − x) from q (tejada2008, 4.2.2), Ω = Σ ω_i, with the diffusion
/// function g_i of |κ_i| = 2 |⟨n, x_i − x⟩| / ‖x_i − x‖² and λ = kernel.threshold / width. `along`: moves along n only.
Vec3 diffuse(std::span<const WeighedSample> samples, const ProjectionKernel& kernel, const Vec3& q, const Vec3& normal,
             double width, bool along);

/// χ₁, χ₂, χ₃ of Euler's theorem, fitted to directional curvatures at p with weights ρ^{2τ} ω_i (tejada2008, 4.2.1);
/// zero where the samples do not determine them.
Vec3 fit_directional_curvatures(std::span<const WeighedSample> samples, const Vec3& p, const Vec3& normal, int tau,
                                double width);

/// Like project_group, for all formulas and options.
void project_group_as_published(const ProjectionKernel& kernel, std::span<const Candidate> candidates,
                                const PointGroup& group, GroupFeet& out);

}  // namespace sansmesh::inline v1::detail
