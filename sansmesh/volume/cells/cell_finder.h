// Point location and face neighbours in lists of cells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/cells/box_tree.h"

namespace sansmesh::inline v1 {

/// Keeps views: the cells and their points must outlive it. Safe from any thread.
class CellFinder {
 public:
  CellFinder(const CellList& cells, std::span<const Vec3> points);

  /// The smallest accepted cell (by volume, then index) that contains x; kNoCell if there is none. `scratch` belongs to
  /// the caller.
  std::uint32_t smallest(const Vec3& x, const std::function<bool(std::uint32_t)>& accept,
                         std::vector<std::uint32_t>& scratch) const;

  const CellList& cells() const { return cells_; }
  const Vec3& corner(std::size_t cell, std::size_t k) const { return points_[cells_[cell][k]]; }
  Vec3 middle(std::size_t cell) const;
  Box3 box(std::size_t cell) const;
  double mean_edge(std::size_t cell) const;

 private:
  const CellList& cells_;
  std::span<const Vec3> points_;
  BoxTree tree_;
};

/// Neighbours across faces, including faces that do not match.
class FaceNeighbours {
 public:
  /// As CellFinder.
  FaceNeighbours(const CellList& cells, std::span<const Vec3> points);

  /// The cell across a face if both have the same corners there; else kNoCell.
  std::uint32_t equal(std::size_t cell, std::size_t face) const { return equal_[6 * cell + face]; }
  /// The smallest other cell just beyond the point (r, s) in [0, 1]² of a face as a bilinear patch (of a triangle: with
  /// the last two corners equal); kNoCell if there is none. For faces without a matching cell.
  std::uint32_t beyond(std::size_t cell, std::size_t face, double r, double s,
                       std::vector<std::uint32_t>& scratch) const;
  const CellFinder& finder() const { return finder_; }

 private:
  CellFinder finder_;
  std::vector<std::uint32_t> equal_;
};

/// Links between cells that share only part of a face: across levels and block borders. Calls visit(cell, nearest
/// corner of the cell's face, other cell) for some points of all faces without a matching cell, in order, on the
/// calling thread.
void for_each_partial_neighbour(const FaceNeighbours& faces,
                                const std::function<void(std::uint32_t, std::uint32_t, std::uint32_t)>& visit);

}  // namespace sansmesh::inline v1
