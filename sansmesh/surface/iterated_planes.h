// Coefficients of iterated approximate moving least squares on a surface, precomputed for all points.
#pragma once

#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/surface/surface_samples.h"

namespace sansmesh::inline v1::detail {

struct IterationOptions {
  int order = 4;  ///< order of the generating functions: 2, 4, 6
  int iterations = 3;
  bool separate_sheets = true;
  /// Use one width and one weight for all samples instead of those of their spacing and area.
  bool alike = false;
};

/// M f(x) = Σ_i (⟨x, m_i⟩ − e_i) φ_i(x). The iteration Mⁿ⁺¹ = Mⁿ + Σ (g_i − Mⁿ(x_i)) φ_i with g_i = ⟨x − x_i, n_i⟩
/// (tejada2008, 4.3.1) is linear in g, and g is affine in x. With B = Σ_k (I − A)^k, A_ij = φ_j(x_i), it reduces to m =
/// B n and e = B ⟨x, n⟩ for all x (docs/methods/implicit-surfaces.md).
struct IteratedPlanes {
  std::vector<Vec3f> m;
  std::vector<float> offset;  ///< e_i − ⟨x_i, m_i⟩: small, so sufficiently exact in float
};

/// `widths`: σ_i of the Gaussians exp(−d²/σ²) (length).
IteratedPlanes iterate_planes(const SurfaceSamples& samples, const std::vector<float>& widths,
                              const IterationOptions& options, Progress& progress);

/// Width, as a multiple of the spacing, and number of iterations with the least leave-one-out error: the distance of
/// some samples from the surface of the others. `smoothing`: known width, or 0; `iterations`: known number, or −1.
struct IterationChoice {
  int order = 4;
  double smoothing = 1;
  int iterations = 0;
  double error = 0;  ///< root mean square (length)
};
IterationChoice choose_iterations(const SurfaceSamples& samples, const IterationOptions& options, double smoothing,
                                  int iterations);

}  // namespace sansmesh::inline v1::detail
