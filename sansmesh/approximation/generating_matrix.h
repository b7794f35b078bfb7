// Sparse matrix K = (φ_j(x_i)) of approximate moving least squares and its divisors.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/approximation/approximate_mls_options.h"
#include "sansmesh/approximation/generating_functions.h"
#include "sansmesh/approximation/sample_index.h"

namespace sansmesh::inline v1::detail {

/// Reciprocal of max(S, 0.55 T), or 0 where both vanish. With this divisor each absolute row sum is below 1/0.55 < 2.
/// As φ is positive definite, the eigenvalues of the divided matrix are in (0, 2) and the iteration converges.
inline double inverse_divisor(double gaussian_sum, double absolute_sum) {
  const double divisor = std::max(gaussian_sum, 0.55 * absolute_sum);
  return std::isnormal(1 / divisor) && divisor > 0 ? 1 / divisor : 0;
}

/// Symmetric matrix in compressed sparse rows.
struct GeneratingMatrix {
  std::vector<std::size_t> row;
  std::vector<std::uint32_t> column;
  std::vector<double> value;
  std::vector<double> gaussian_sum, absolute_sum;  ///< S and T of each row

  std::size_t size() const { return gaussian_sum.size(); }

  /// residual −= A · residual for c components per sample; `scratch` has the same length.
  void step(Normalisation normalisation, std::size_t c, std::span<double> residual, std::span<double> scratch) const;
};

/// Throws DataError beyond `max_entries`.
template <int D>
GeneratingMatrix generating_matrix(const SampleIndex<D>& samples, const LaguerreGaussian& phi, double radius,
                                   std::size_t max_entries);

/// Throws as the constructor of ApproximateMls.
void check_options(const ApproximateMlsOptions& options, std::size_t samples, std::span<const double> values);

}  // namespace sansmesh::inline v1::detail
