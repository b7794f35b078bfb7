// Outward directions of the samples of a closed surface from the consistency of their winding numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/points/orientation/relation_graph.h"
#include "sansmesh/points/orientation/winding_sums.h"

namespace sansmesh::inline v1::detail {

/// Evenly distributed samples of a part of a graph, and the winding numbers of the part at these.
class WindingSides {
 public:
  /// `members`: samples of the part, in tree order; every `step`-th one is used.
  WindingSides(const RelationGraph& graph, std::span<const std::uint32_t> members, std::size_t step);

  std::span<const std::uint32_t> nodes() const { return nodes_; }

  /// Relative variance of the winding number over the part, 0..1, with the normals times these signs: 0 where it is the
  /// same everywhere, as on a closed surface with consistent signs; near 1 for a single sheet and for random signs.
  /// Smooths over two noises or spacings.
  double error(std::span<const std::int8_t> sign) const;

  /// Unit outward direction at each node, independent of the normals (wnnc2024): area vectors descend towards a winding
  /// number of ½ at all nodes, and turn into the direction of its gradient, while the kernel's width shrinks. An open
  /// sheet has no such directions.
  std::vector<Vec3f> outward() const;

 private:
  const RelationGraph& graph_;
  std::vector<std::uint32_t> nodes_;
  float scale_ = 1;                 ///< length of 1 in the unit of `sums_`, the extent of the part
  double spacing_ = 0, noise_ = 0;  ///< lengths, in the unit of `sums_`
  WindingSums sums_;
};

}  // namespace sansmesh::inline v1::detail
