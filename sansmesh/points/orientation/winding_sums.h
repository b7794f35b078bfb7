// Fast sums of the winding number of oriented nodes, its gradient, and the transposed sum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Sums over pairs of nodes at fixed positions with the regularised kernel K(d) = d / (4π (‖d‖² + width²)^{3/2}). The
/// sum of a group of nodes at its centre replaces these at a distance of two radii (barill2018), or if they coincide.
/// The groups that each node uses are chosen once. Positions should be of order 1. Results are independent of the
/// number of threads.
class WindingSums {
 public:
  WindingSums() = default;
  /// Neighbours in the list should be neighbours in space.
  explicit WindingSums(std::span<const Vec3f> nodes);

  /// Winding numbers of area vectors at each node x: Σ ⟨K(p − x), a⟩ over the nodes p.
  void winding(std::span<const Vec3f> area, float width, std::span<float> values) const;

  /// Negative gradients of these winding numbers; they point outward.
  void gradient(std::span<const Vec3f> area, float width, std::span<Vec3f> outward) const;

  /// Transposed sums, at each node p: Σ K(p − x) v over the nodes x.
  void transposed(std::span<const float> value, float width, std::span<Vec3f> sums) const;

 private:
  static constexpr std::size_t kWidth = 8;  ///< members of a group
  struct Sources {
    std::vector<float> x, y, z;
  };
  /// Sums the values of the nodes over all groups.
  void sum_up(std::vector<float>& values) const;
  Sources sources(std::span<const Vec3f> area) const;
  template <class Add>
  void for_each_group(const Add& add) const;

  std::size_t size_ = 0;
  std::vector<std::size_t> first_ = {0};      ///< first entry of each level, and the number of all; level 0: the nodes
  std::vector<float> x_, y_, z_;              ///< positions of nodes and centres of groups
  std::vector<float> radius_;                 ///< radii of the groups
  std::vector<std::uint32_t> used_;           ///< nodes and groups that the nodes of each group of level 1 use
  std::vector<std::size_t> used_from_ = {0};  ///< first of them, by group
};

}  // namespace sansmesh::inline v1::detail
