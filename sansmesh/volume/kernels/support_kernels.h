// Vectorised sums of functions with ellipsoidal supports.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1::detail {

/// One support: w(r) = (1 − r²)⁴ for r = ‖M (x − center)‖ / radius < 1, times a polynomial.
struct SupportTerm {
  Vec3f center;              ///< relative to the origin of the tile
  StarMetric metric;         ///< M
  float inverse_square = 1;  ///< 1 / radius²
  const float* coefficients =
      nullptr;  ///< factors of the monomials in M d, without the constant; may be null for degree 0
  int degree = 0;
  float constant = 0;                                     ///< minus the base of the tile
  float scale = 1;                                        ///< factor of the weight
  float least = -std::numeric_limits<float>::infinity();  ///< bounds of the polynomial, minus the base of the tile
  float most = std::numeric_limits<float>::infinity();
};

/// Points and sums, a structure of arrays aligned for the widest vectors.
struct SupportTile {
  static constexpr std::size_t kTile = 64;
  alignas(64) float x[3][kTile];             ///< relative to the origin
  alignas(64) float weight[kTile];           ///< Σ w
  alignas(64) float value[kTile];            ///< Σ w p
  alignas(64) float weight_slope[3][kTile];  ///< ∇ Σ w
  alignas(64) float value_slope[3][kTile];
};

/// Sums over `count` supports at the first n points, a multiple of 16; gradients if requested. The result is the same
/// on every machine.
void sum_supports(const SupportTerm* terms, std::size_t count, std::size_t n, bool gradient, SupportTile& tile);

}  // namespace sansmesh::inline v1::detail
