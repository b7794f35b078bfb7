// Interpolation by the shape functions of cells of higher order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/cells/nodal_basis.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1 {

/// Nodes of a cell of higher order with the values of their shape functions at a point.
struct NodeWeights {
  std::span<const std::uint32_t> nodes;  ///< samples
  std::vector<double> weights;           ///< sum to 1
  std::vector<Vec3> slopes;              ///< gradients of the weights, if requested

  /// Interpolated component of the samples' values.
  double value(const VolumeValues& values, std::size_t component) const;
  Vec3 gradient(const VolumeValues& values, std::size_t component) const;
};

/// The function that a file of cells of higher order defines: Σ N_n(u) f_n with the natural coordinates u of the point,
/// Σ N_n(u) x_n = x. Pieces of cells give approximate coordinates; Newton's method makes them exact where the cell is
/// curved, and the neighbour counts where they leave the cell. So the function is continuous across curved faces. In
/// the slivers between curved faces of the volume and the straight faces of their pieces polynomials continue.
class HigherOrderFunctions {
 public:
  /// `volume` must outlive the object.
  explicit HigherOrderFunctions(const SampledVolume& volume);

  bool empty() const { return volume_.higher.of_piece.empty(); }
  /// Whether a located cell is a piece of a cell of higher order.
  bool has(std::uint32_t cell) const { return !empty() && volume_.higher.of_piece[cell] != HigherOrderCells::kNone; }
  /// Weights at x, a point at `location`, with slopes if requested. Returns false, and changes nothing, if the cell is
  /// no piece.
  bool find(const CellLocation& location, const Vec3& x, bool slopes, NodeWeights& out) const;
  /// Weights in the middle of a cell of the volume: the mean of its corners.
  bool at_middle(std::uint32_t cell, NodeWeights& out) const;
  /// Weights half-way between two samples of an edge; `cells` are those of the first.
  bool at_edge(std::span<const std::uint32_t> cells, std::uint32_t from, std::uint32_t to, NodeWeights& out) const;

 private:
  void number_corners();
  void classify();
  const NodalBasis& basis_of(std::uint32_t cell) const { return bases_[basis_[cell]]; }
  Vec3 start_of(const CellLocation& location) const;
  bool invert(std::uint32_t cell, const Vec3& x, Vec3& u, NodeWeights& out) const;
  bool find_beyond(const CellLocation& location, const Vec3& x, std::uint32_t& cell, Vec3& u, NodeWeights& out) const;

  const SampledVolume& volume_;
  std::vector<NodalBasis> bases_;     ///< one per kind
  std::vector<std::uint16_t> basis_;  ///< per cell of higher order
  std::vector<std::uint8_t> curved_;  ///< its map from natural coordinates is not affine
  std::vector<std::uint16_t> local_;  ///< for each corner of the volume's cells: its number among the nodes
  Adjacency around_;                  ///< cells of higher order at each sample; only if any is curved
  std::vector<Box3> boxes_;           ///< boxes that contain them; as above
};

}  // namespace sansmesh::inline v1
