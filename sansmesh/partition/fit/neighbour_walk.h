// Neighbourhoods of the cells of a tree of samples, computed incrementally.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/partition/fit/sample_tree.h"

namespace sansmesh::inline v1 {

/// Holds the neighbourhoods of the last requested cell and of its ancestors. Along the Morton curve, where successive
/// cells share most ancestors, each cell of the tree is searched once. This is faster than storing the 27 indices of
/// every cell, which would be the largest table of a fit. One object per thread; the tree must outlive it.
class NeighbourWalk {
 public:
  explicit NeighbourWalk(const SampleTree& tree);

  /// Moves to a cell of a level of the tree.
  void go(int level, std::uint32_t cell);
  /// Cells around the current one on its level; valid until the next move, like the others.
  const SampleTree::Neighbours& own() const { return steps_[level_].own; }
  /// Cells around its parent, on the level above; around itself on level 0.
  const SampleTree::Neighbours& parents() const { return steps_[level_ > 0 ? level_ - 1 : 0].own; }
  /// Cells around its ancestor this many levels above; around the root on level 0.
  const SampleTree::Neighbours& above(std::size_t levels) const {
    return steps_[level_ > levels ? level_ - levels : 0].own;
  }

 private:
  static constexpr std::uint32_t kNowhere = ~std::uint32_t{0};
  struct Step {
    std::uint32_t cell = kNowhere;
    std::uint32_t around = kNowhere;  ///< parent of `children`
    SampleTree::Neighbours own;
    std::array<std::int32_t, 64>
        children;  ///< 4×4×4 cells: the children of the parent in the centre, and the next ones around
  };
  void step_to(std::size_t level, std::uint32_t cell);
  std::uint32_t parent_of(std::size_t level, std::uint32_t cell) const;
  void find_children(Step& step, std::size_t above) const;

  const SampleTree& tree_;
  std::vector<Step> steps_;  ///< one per level
  std::size_t level_ = 0;
};

}  // namespace sansmesh::inline v1
