// Cells at a place, of lists of cells that are not a volume yet or whose neighbours are asked for.
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

/// Keeps views: the cells and their points must outlive it. Asked from any thread.
class CellFinder {
 public:
  CellFinder(const CellList& cells, std::span<const Vec3> points);

  /// The smallest (by volume, then number) of the cells that hold x within them and are accepted; kNoCell if there is
  /// none. `scratch` is the caller's.
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

/// What lies on the other side of faces without an equal one.
class FaceNeighbours {
 public:
  /// As CellFinder.
  FaceNeighbours(const CellList& cells, std::span<const Vec3> points);

  /// The cell across a face, if both have the same corners there; else kNoCell.
  std::uint32_t equal(std::size_t cell, std::size_t face) const { return equal_[6 * cell + face]; }
  /// The smallest other cell just beyond the place (r, s) in [0, 1]² of a face, as if it were a bilinear patch (of a
  /// triangle: whose last two corners are one); kNoCell if there is none. For faces that have no equal one.
  std::uint32_t beyond(std::size_t cell, std::size_t face, double r, double s,
                       std::vector<std::uint32_t>& scratch) const;
  const CellFinder& finder() const { return finder_; }

 private:
  CellFinder finder_;
  std::vector<std::uint32_t> equal_;
};

/// Links between cells that share part of a face, and are not equal there: across levels and borders of blocks.
/// visit(cell, corner of the cell's face that it is nearest to, other cell) is called for some places of all faces that
/// have no equal one, in order, on the calling thread.
void for_each_partial_neighbour(const FaceNeighbours& faces,
                                const std::function<void(std::uint32_t, std::uint32_t, std::uint32_t)>& visit);

}  // namespace sansmesh::inline v1
