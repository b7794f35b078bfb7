// Kernels of the orthogonal polynomials: SIMD loops over samples with the same result on every instruction set.
#pragma once

#include <cstddef>

namespace sansmesh::inline v1::detail {

/// Rows are padded with zeros to a multiple of this. Eight partial sums make the result independent of the SIMD width.
constexpr std::size_t kRowLanes = 8;

/// out[i] = x[i] · row[i] for i < n, and dots[c] = Σ out[i] · others[c][i]. n is a multiple of kRowLanes; `out`
/// overlaps no other row.
void multiply_and_dot(std::size_t n, const double* x, const double* row, const double* const* others, std::size_t count,
                      double* out, double* dots);

struct NormAndDot {
  double squared_norm = 0;  ///< Σ row[i]²
  double dot = 0;           ///< Σ row[i] · residual[i]
};
/// row[i] −= Σ_c factors[c] · others[c][i]; returns the sums over the new row.
NormAndDot subtract_rows(std::size_t n, const double* const* others, const double* factors, std::size_t count,
                         const double* residual, double* row);

/// residual[i] −= coefficient · row[i]; returns Σ residual[i]².
double subtract_from_residual(std::size_t n, const double* row, double coefficient, double* residual);

}  // namespace sansmesh::inline v1::detail
