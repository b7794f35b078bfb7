#include "sansmesh/partition/fit/neighbour_walk.h"

#include <algorithm>

namespace sansmesh::inline v1 {

NeighbourWalk::NeighbourWalk(const SampleTree& tree) : tree_(tree), steps_(static_cast<std::size_t>(tree.depth()) + 1) {
  steps_[0].cell = 0;
  steps_[0].own.fill(-1);
  steps_[0].own[13] = 0;
}

void NeighbourWalk::go(int level, std::uint32_t cell) {
  level_ = static_cast<std::size_t>(level);
  step_to(level_, cell);
  if (level_ > 0) step_to(level_ - 1, steps_[level_].around);  // if the cell was known, its parent may have moved on
}

/// The cell of the level above that contains a cell: usually the parent of the previous cell, or the next one.
std::uint32_t NeighbourWalk::parent_of(std::size_t level, std::uint32_t cell) const {
  const auto& child = tree_.level(static_cast<int>(level) - 1).child;
  const std::uint32_t guess = steps_[level - 1].cell;
  for (std::uint32_t p = guess; guess != kNowhere && p < guess + 2 && p + 1 < child.size(); ++p)
    if (child[p] <= cell && cell < child[p + 1]) return p;
  return static_cast<std::uint32_t>(std::upper_bound(child.begin(), child.end(), cell) - child.begin()) - 1;
}

void NeighbourWalk::step_to(std::size_t level, std::uint32_t cell) {
  Step& step = steps_[level];
  if (step.cell == cell) return;
  const std::uint32_t parent = parent_of(level, cell);
  step_to(level - 1, parent);
  if (step.around != parent) {
    find_children(step, level - 1);
    step.around = parent;
  }
  step.cell = cell;
  const auto octant = static_cast<std::size_t>(tree_.level(static_cast<int>(level)).code[cell] & 7);
  const std::size_t corner = (octant & 1) + 4 * (octant >> 1 & 1) + 16 * (octant >> 2);
  for (std::size_t k = 0; k < 27; ++k) step.own[k] = step.children[corner + k % 3 + 4 * (k / 3 % 3) + 16 * (k / 9)];
}

void NeighbourWalk::find_children(Step& step, std::size_t above) const {
  const auto& child = tree_.level(static_cast<int>(above)).child;
  const auto& code = tree_.level(static_cast<int>(above) + 1).code;
  step.children.fill(-1);
  for (int k = 0; k < 27; ++k) {
    const std::int32_t parent = steps_[above].own[static_cast<std::size_t>(k)];
    if (parent < 0) continue;
    // The children of the parent in the centre have positions 1 and 2 on each axis.
    const int x = 2 * (k % 3) - 1, y = 2 * (k / 3 % 3) - 1, z = 2 * (k / 9) - 1;
    const auto p = static_cast<std::size_t>(parent);
    for (std::uint32_t c = child[p]; c < child[p + 1]; ++c) {
      const int octant = static_cast<int>(code[c] & 7);
      const int cx = x + (octant & 1), cy = y + (octant >> 1 & 1), cz = z + (octant >> 2);
      if (cx < 0 || cx > 3 || cy < 0 || cy > 3 || cz < 0 || cz > 3) continue;
      step.children[static_cast<std::size_t>(cx + 4 * cy + 16 * cz)] = static_cast<std::int32_t>(c);
    }
  }
}

}  // namespace sansmesh::inline v1
