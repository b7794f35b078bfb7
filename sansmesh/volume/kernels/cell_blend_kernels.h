// Polynomials about the corners of a cell, blended in it: many points of one cell at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sansmesh/cell_list.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1::detail {

/// What one corner of a cell adds: τ p(x) + (1 − τ) L(x), L the linear interpolation in the cell.
struct CellCorner {
  StarMetric metric;
  const float* coefficients = nullptr;  ///< without the constant: see LocalPolynomials
  int degree = 0;
  float constant = 0;  ///< p at the corner, less the base of the cell
  float value = 0;     ///< of the sample, less the base of the cell
  float trust = 1;     ///< τ
};

/// Points of one cell, a structure of arrays aligned for the widest vectors. All in float: offsets are small, values
/// are less a base that the cell's corners share.
struct CellTile {
  static constexpr std::size_t kTile = 64;
  alignas(64) float weights[8][kTile];     ///< shape functions N of the corners
  alignas(64) float slopes[8][3][kTile];   ///< and their gradients; only if gradients are wanted
  alignas(64) float offsets[8][3][kTile];  ///< x − corner
  alignas(64) float blend[8][kTile];       ///< out: S
  alignas(64) float blend_slopes[8][3][kTile];
  alignas(64) float value[kTile];        ///< out
  alignas(64) float gradient[3][kTile];  ///< out
};

/// S of all corners, and ∇S if `gradient`, for the first n points. S are smooth steps of the shape functions, s(t) = t²
/// (3 − 2t): in hexahedra the product of those of the three local coordinates, in tetrahedra s(N_v) / Σ s(N_w), in
/// wedges and pyramids what agrees with both on the faces. They are a partition of unity, S_v is 1 at its corner and 0
/// at the others, and depends on a face only on the face. Where cells meet at right angles ∇S is continuous.
void blend_weights(CellShape shape, std::size_t n, bool gradient, CellTile& tile);

/// Σ_v S_v (τ_v p_v + (1 − τ_v) L) at the first n points, and its gradient if wanted. The same on every machine.
void blend_corners(const CellCorner* corners, std::size_t count, std::size_t n, bool gradient, CellTile& tile);

}  // namespace sansmesh::inline v1::detail
