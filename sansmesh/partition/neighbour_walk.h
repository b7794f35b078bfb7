// The cells around the cells of a tree of samples, found on the way from one to the next. Internal to partition/.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/partition/sample_tree.h"

namespace sansmesh::inline v1 {

/// Knows the cells around one cell of each level, the last one asked for and its ancestors. Along the curve, where the
/// next cell has most ancestors in common with the one before, each cell of the tree is looked up once: quicker than to
/// keep the 27 indices of every cell, which would be the largest table of a fit. One a thread; the tree must outlive
/// it.
class NeighbourWalk {
 public:
  explicit NeighbourWalk(const SampleTree& tree);

  /// Goes to a cell of a level of the tree.
  void go(int level, std::uint32_t cell);
  /// The cells around it, on its level; valid until it goes elsewhere, as is the other.
  const SampleTree::Neighbours& own() const { return steps_[level_].own; }
  /// The cells around its parent, on the level above; around itself on level 0.
  const SampleTree::Neighbours& parents() const { return steps_[level_ > 0 ? level_ - 1 : 0].own; }
  /// The cells around its ancestor so many levels above; around the root on level 0.
  const SampleTree::Neighbours& above(std::size_t levels) const {
    return steps_[level_ > levels ? level_ - levels : 0].own;
  }

 private:
  static constexpr std::uint32_t kNowhere = ~std::uint32_t{0};
  struct Step {
    std::uint32_t cell = kNowhere;
    std::uint32_t around = kNowhere;  ///< the parent of `children`
    SampleTree::Neighbours own;
    std::array<std::int32_t, 64> children;  ///< 4×4×4 cells: those of the parent in the middle, and the next around
  };
  void step_to(std::size_t level, std::uint32_t cell);
  std::uint32_t parent_of(std::size_t level, std::uint32_t cell) const;
  void find_children(Step& step, std::size_t above) const;

  const SampleTree& tree_;
  std::vector<Step> steps_;  ///< of each level
  std::size_t level_ = 0;
};

}  // namespace sansmesh::inline v1
