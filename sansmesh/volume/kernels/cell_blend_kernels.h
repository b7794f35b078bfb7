// Vectorised blend of corner polynomials at many points of one cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sansmesh/cell_list.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1::detail {

/// Contribution of one corner of a cell: τ p(x) + (1 − τ) L(x), L the interpolation in the cell.
struct CellCorner {
  StarMetric metric;
  const float* coefficients = nullptr;  ///< without the constant: see LocalPolynomials
  int degree = 0;
  float constant = 0;  ///< p at the corner, minus the base of the cell
  float value = 0;     ///< sample value, minus the base of the cell
  float trust = 1;     ///< τ
};

/// Points of one cell, a structure of arrays aligned for the widest vectors. Float suffices: offsets are small, and
/// values are relative to a base shared by the cell's corners.
struct CellTile {
  static constexpr std::size_t kTile = 64;
  alignas(64) float weights[8][kTile];     ///< shape functions N of the corners
  alignas(64) float slopes[8][3][kTile];   ///< their gradients; only if requested
  alignas(64) float offsets[8][3][kTile];  ///< x − corner
  alignas(64) float own[kTile];            ///< L minus the base of the cell, if it is not the linear interpolation
  alignas(64) float own_slopes[3][kTile];
  alignas(64) float blend[8][kTile];  ///< output: S
  alignas(64) float blend_slopes[8][3][kTile];
  alignas(64) float value[kTile];        ///< output
  alignas(64) float gradient[3][kTile];  ///< output
};

/// S of all corners, and ∇S if `gradient`, for the first n points. S are smooth steps of the shape functions, s(t) = t²
/// (3 − 2t): in hexahedra the product over the three local coordinates, in tetrahedra s(N_v) / Σ s(N_w), in wedges and
/// pyramids functions that agree with both on the faces. They are a partition of unity; S_v is 1 at its corner and 0 at
/// the others, and its values on a face depend only on the face. Where cells meet at right angles ∇S is continuous.
void blend_weights(CellShape shape, std::size_t n, bool gradient, CellTile& tile);

/// Σ_v S_v (τ_v p_v + (1 − τ_v) L) at the first n points, and its gradient if requested; L is linear, or `own` of the
/// tile. The result is the same on every machine.
void blend_corners(const CellCorner* corners, std::size_t count, std::size_t n, bool gradient, bool own,
                   CellTile& tile);

}  // namespace sansmesh::inline v1::detail
