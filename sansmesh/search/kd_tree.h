// Nearest-neighbour and radius queries on a cloud: an eight-wide tree of boxes as flat arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/search/box_levels.h"
#include "sansmesh/search/kd_tree_kernels.h"
#include "sansmesh/search/neighbour.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Built once (parallel, O(n log n)), then queried from any thread. Results are exact and equal to those of brute force
/// on every machine and for any number of threads, including ties. Ignores points that are not finite; keeps duplicates
/// and returns each of them. The cloud and the query points must be within 1e18 of the origin, or squared distances
/// overflow.
class KdTree {
 public:
  KdTree() = default;
  /// Copies the data; `points` need not outlive it. At most 2³² − 2 points.
  explicit KdTree(std::span<const Vec3f> points);

  /// Number of finite points.
  std::size_t size() const { return size_; }

  /// Writes the out.size() nearest points of q in ascending order, fewer if the tree has fewer; returns their number. A
  /// point of the cloud finds itself (or a duplicate of lower index) first. None if q is not finite.
  std::size_t nearest(const Vec3f& q, std::span<Neighbour> out) const;
  /// Nearest point; nothing if the tree is empty or q is not finite.
  std::optional<Neighbour> nearest(const Vec3f& q) const;
  /// Distance to the nearest point (length); infinite if there is none.
  double distance(const Vec3f& q) const;
  /// Replaces `out` by the points with squared distance <= radius², in ascending order.
  void within(const Vec3f& q, float radius, std::vector<Neighbour>& out) const;
  /// Same, in tree order: takes less than half the time for many neighbours.
  void within_by_slot(const Vec3f& q, float radius, std::vector<Neighbour>& out) const;
  /// Number of points that `within` would return.
  std::size_t count_within(const Vec3f& q, float radius) const;

  /// Points in tree order: consecutive slots are close together in space. order()[slot] is the caller's index.
  std::span<const std::uint32_t> order() const { return order_; }
  Vec3f position(std::size_t slot) const {
    const detail::KdTreeLeaf& leaf = leaves_[slot / kTreeWidth];
    return {leaf.x[slot % kTreeWidth], leaf.y[slot % kTreeWidth], leaf.z[slot % kTreeWidth]};
  }
  /// All positions in tree order.
  std::vector<Vec3f> positions() const;

  /// Finds the k nearest points of every point (itself included, first or after its duplicates). Calls visit(slot,
  /// neighbours) once per slot, in parallel, with the neighbours as slots in ascending order (ties by slot).
  /// Neighbouring slots run consecutively on the same thread: the fastest way to process a whole cloud.
  using Visit = std::function<void(std::uint32_t slot, std::span<const Neighbour> neighbours)>;
  void for_each_nearest(std::size_t k, const Visit& visit) const;
  /// Same, for the slots [first, last) on the calling thread.
  void for_each_nearest(std::size_t k, std::size_t first, std::size_t last, const Visit& visit) const;

 private:
  std::size_t size_ = 0;
  std::vector<detail::KdTreeLeaf> leaves_;
  BoxLevels levels_;  ///< levels over the leaves
  std::vector<std::uint32_t> order_;
};

}  // namespace sansmesh::inline v1
