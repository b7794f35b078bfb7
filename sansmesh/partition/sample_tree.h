// Samples sorted along the Morton curve of a cube, with every level of the octree over them as a flat table.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/core/vec.h"

namespace sansmesh {

/// The cells of each level that hold samples: cell c of a level holds samples begin[c] .. begin[c+1] (sorted order),
/// and its children on the next level are child[c] .. child[c+1].
class SampleTree {
 public:
  struct Level {
    std::vector<std::uint64_t> code;   ///< Morton codes, ascending
    std::vector<std::uint32_t> begin;  ///< code.size() + 1 entries
    std::vector<std::uint32_t> child;  ///< code.size() + 1 entries; empty on the last level
    std::size_t size() const { return code.size(); }
  };

  /// The 3×3×3 cells around a cell (index 13 is the cell itself), x fastest; -1 where there is none.
  using Neighbours = std::array<std::int32_t, 27>;

  /// Sorts the samples and builds levels 0 .. depth (depth <= 20). normals may be empty.
  SampleTree(std::span<const Vec3f> positions, std::span<const Vec3f> normals, const Vec3f& lower, float edge,
             int depth);

  int depth() const { return static_cast<int>(levels_.size()) - 1; }
  const Level& level(int l) const { return levels_[static_cast<std::size_t>(l)]; }
  const Vec3f& lower() const { return lower_; }
  float edge() const { return edge_; }

  /// Sorted samples; order()[i] is the caller's index of sorted sample i.
  std::span<const Vec3f> positions() const { return positions_; }
  std::span<const Vec3f> normals() const { return normals_; }
  std::span<const std::uint32_t> order() const { return order_; }

  /// Index of the cell with this code on a level; -1 if it holds no sample.
  std::int64_t find(int level, std::uint64_t code) const;
  Neighbours root_neighbours() const;
  /// Neighbours of cell `child` (an index on level + 1), given those of its parent (on `level`).
  Neighbours child_neighbours(int level, const Neighbours& of_parent, std::uint32_t child) const;

 private:
  Vec3f lower_;
  float edge_;
  std::vector<Vec3f> positions_, normals_;
  std::vector<std::uint32_t> order_;
  std::vector<Level> levels_;
};

/// Interleaves the low 21 bits of three integers, x lowest.
std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z);
std::array<std::uint32_t, 3> morton_cell(std::uint64_t code);

}  // namespace sansmesh
