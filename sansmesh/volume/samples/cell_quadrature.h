// Quadrature over the cells of samples: means of polynomials over cells.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A point with its share of the cell's volume.
struct QuadraturePoint {
  Vec3 x;  ///< relative to the origin that was given
  double weight = 0;
};

/// Quadrature over the cells of each sample (several, where a degenerate cell was divided). Lattices have no cells.
class CellQuadrature {
 public:
  /// `volume` has values in cells and must outlive it.
  explicit CellQuadrature(const SampledVolume& volume);

  /// Replaces `out` by points whose weights are positive and sum to 1: exact for polynomials of degree 3 (of the
  /// position, in every cell); six points in a box, eight in a tetrahedron, 27 to 64 in other cells.
  void points(std::uint32_t sample, const Vec3& origin, std::vector<QuadraturePoint>& out) const;
  /// The same with 64 points a cell: exact for degree 4, and close for smooth functions.
  void fine_points(std::uint32_t sample, const Vec3& origin, std::vector<QuadraturePoint>& out) const;

  /// The cells of a sample.
  std::span<const std::uint32_t> cells_of(std::uint32_t sample) const { return cells_[sample]; }

 private:
  void gather(std::uint32_t sample, const Vec3& origin, bool fine, std::vector<QuadraturePoint>& out) const;

  const SampledVolume& volume_;
  Adjacency cells_;
};

}  // namespace sansmesh::inline v1
