// Vectorised moving least squares at many points of a cell.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/vec.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1::detail {

/// A sample with the weight (1 − r²)⁴, r = ‖M (x − position)‖ / radius < 1.
struct MlsSample {
  Vec3 position;  ///< relative to the origin of the cell
  StarMetric metric;
  double inverse_square = 1;  ///< 1 / radius²
  double value = 0;           ///< minus the base of the cell
};

/// Points of one cell and the results, a structure of arrays aligned for the widest vectors.
struct MlsTile {
  static constexpr std::size_t kTile = 64;
  alignas(64) double x[3][kTile];  ///< relative to the origin of the cell
  alignas(64) double value[kTile];
  alignas(64) double gradient[3][kTile];
  /// Variance of the value over variance of the weighted mean; −1 where no sample counts.
  alignas(64) double variance[kTile];
  std::vector<double> moments;  ///< scratch
};

/// For each of the first n points (a multiple of 8): the polynomial p of that degree (0..4) in u = `frame` (x_i − x)
/// that minimises Σ w_i (f_i − p(u_i))², its value at x and the exact gradient of that value as a function of x. Normal
/// equations by LDLᵀ in the order of the degrees; monomials that the samples do not determine (pivot below 2e-3 of the
/// diagonal) are dropped. The value is 0 where all weights are 0.
void solve_mls(const MlsSample* samples, std::size_t count, const StarMetric& frame, int degree, std::size_t n,
               bool gradient, MlsTile& tile);

}  // namespace sansmesh::inline v1::detail
