// Samples sorted along the Morton curve of a cube, with the levels of the octree over them as flat tables.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Cells of each level that hold samples: cell c of a level holds samples begin[c] .. begin[c+1] (sorted order), and
/// its children on the next level are child[c] .. child[c+1].
class SampleTree {
 public:
  struct Level {
    std::vector<std::uint64_t> code;   ///< Morton codes, ascending
    std::vector<std::uint32_t> begin;  ///< code.size() + 1 entries
    std::vector<std::uint32_t> child;  ///< code.size() + 1 entries; empty on the last level
    std::size_t size() const { return code.size(); }
  };

  /// The 3×3×3 cells around a cell (index 13 is the cell itself), x fastest; -1 for empty ones.
  using Neighbours = std::array<std::int32_t, 27>;

  static constexpr int kMaxDepth = 20;
  static constexpr std::size_t kMostSamples = 0x7fffffff;  ///< cell indices have 31 bits

  /// Moves the samples in and sorts them in place along the curve through the cells of level `depth` (0..kMaxDepth) of
  /// the cube [lower, lower + edge]³; samples of one cell keep their order. normals may be empty. Creates no levels.
  /// Throws DataError beyond kMostSamples.
  SampleTree(std::vector<Vec3f> positions, std::vector<Vec3f> normals, const Vec3f& lower, float edge, int depth);

  /// Mean number of samples in a sample's cell, including itself, on each level 0 .. depth of the sort.
  std::vector<double> company() const;

  /// Creates levels 0 .. deepest, which is at most the depth of the sort.
  void build_levels(int deepest);

  int depth() const { return static_cast<int>(levels_.size()) - 1; }  ///< deepest level created
  const Level& level(int l) const { return levels_[static_cast<std::size_t>(l)]; }
  const Vec3f& lower() const { return lower_; }
  float edge() const { return edge_; }

  /// Sorted samples.
  std::span<const Vec3f> positions() const { return positions_; }
  std::span<const Vec3f> normals() const { return normals_; }

  /// Index of the cell with this code on a level; -1 if it holds no sample.
  std::int64_t find(int level, std::uint64_t code) const;

  /// Each of these moves a part of the tree out that is no longer needed. take_order()[i] is the caller's index of
  /// sorted sample i.
  std::vector<std::uint32_t> take_order() { return std::move(order_); }
  std::vector<Vec3f> take_positions() { return std::move(positions_); }
  std::vector<Vec3f> take_normals() { return std::move(normals_); }
  Level take_level(int l) { return std::move(levels_[static_cast<std::size_t>(l)]); }

 private:
  std::uint64_t code_of(const Vec3f& p) const;
  void sort();
  int first_level_apart(std::uint64_t a, std::uint64_t b) const;
  template <class Seen>
  void for_each_start(std::size_t chunk, int deepest, Seen&& seen) const;

  Vec3f lower_;
  float edge_;
  int sort_depth_;
  std::vector<Vec3f> positions_, normals_;
  std::vector<std::uint32_t> order_;
  std::vector<Level> levels_;
};

}  // namespace sansmesh::inline v1
