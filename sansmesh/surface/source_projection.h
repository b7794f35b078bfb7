// Projections by the letter of their sources, one point at a time in double precision: what the kernels of
// projection_kernels.h depart from (METHODS §2.1, §2.2).
#pragma once

#include <span>

#include "sansmesh/surface/levin_plane.h"
#include "sansmesh/surface/projection_kernels.h"

namespace sansmesh::inline v1::detail {

/// How the polynomial over a plane came out, with coordinates u, v and heights in the frame of tangent_frame(normal).
struct PlanePolynomial {
  double value = 0, u = 0, v = 0;  ///< at the origin, with its slopes
  double uu = 0, uv = 0, vv = 0;   ///< second derivatives there
  int degree = 0;                  ///< that the samples were enough for
};

/// The polynomial of weighted least squares over the plane through q with this normal, weights about q. `degree`: 1..4,
/// less where the samples do not determine it; `incomplete`: of degree 2 without slopes, [x², y², xy, 1]. `width`: the
/// length that coordinates are measured in.
PlanePolynomial fit_polynomial(std::span<const WeighedSample> samples, const Vec3& q, const Vec3& normal, int degree,
                               bool incomplete, double width);

/// The fixed point of x ← x + Δt (1/Ω) Σ ω_i g_i (x_i − x) from q (tejada2008 §4.2.2), Ω = Σ ω_i, with the diffusion
/// function g_i of |κ_i| = 2 |⟨n, x_i − x⟩| / ‖x_i − x‖² and λ = kernel.threshold / width. `along`: moves along n
/// alone.
Vec3 diffuse(std::span<const WeighedSample> samples, const ProjectionKernel& kernel, const Vec3& q, const Vec3& normal,
             double width, bool along);

/// χ₁, χ₂, χ₃ of Euler's theorem, fitted to directional curvatures at p with weights ρ^{2τ} ω_i (tejada2008 §4.2.1);
/// zero where the samples do not determine them.
Vec3 fit_directional_curvatures(std::span<const WeighedSample> samples, const Vec3& p, const Vec3& normal, int tau,
                                double width);

/// As project_group, for all formulas and options.
void project_group_by_source(const ProjectionKernel& kernel, std::span<const Candidate> candidates,
                             const PointGroup& group, GroupFeet& out);

}  // namespace sansmesh::inline v1::detail
