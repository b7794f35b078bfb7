// Nearest-neighbour and radius queries on a cloud: an 8-wide tree of boxes as flat arrays.
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

/// Built once (parallel, O(n log n)), then any number of queries from any thread. Guarantees: answers are exact, equal
/// to those of brute force on every machine and with any number of threads, ties included; points that are not finite
/// are left out; duplicates are kept and returned one by one. Squared distances must not overflow float: the cloud and
/// the queries lie within 1e18 of the origin.
class KdTree {
 public:
  KdTree() = default;
  /// Copies what it needs; `points` may go away. At most 2³² − 2 points.
  explicit KdTree(std::span<const Vec3f> points);

  /// Number of finite points.
  std::size_t size() const { return size_; }

  /// The out.size() points nearest to q in ascending order; fewer where the tree holds fewer. Returns how many. A point
  /// of the cloud finds itself (or a duplicate of lower index) first. None if q is not finite.
  std::size_t nearest(const Vec3f& q, std::span<Neighbour> out) const;
  /// The nearest point; nothing if the tree is empty or q not finite.
  std::optional<Neighbour> nearest(const Vec3f& q) const;
  /// The distance to it (length); infinite if there is none.
  double distance(const Vec3f& q) const;
  /// Replaces `out` by the points with squared distance <= radius², in ascending order.
  void within(const Vec3f& q, float radius, std::vector<Neighbour>& out) const;
  /// The same in the order of the tree: for many neighbours in less than half the time.
  void within_by_slot(const Vec3f& q, float radius, std::vector<Neighbour>& out) const;
  /// How many points `within` would return.
  std::size_t count_within(const Vec3f& q, float radius) const;

  /// The points in tree order: consecutive slots lie close together in space. order()[slot] is the caller's index.
  std::span<const std::uint32_t> order() const { return order_; }
  Vec3f position(std::size_t slot) const {
    const detail::KdTreeLeaf& leaf = leaves_[slot / kTreeWidth];
    return {leaf.x[slot % kTreeWidth], leaf.y[slot % kTreeWidth], leaf.z[slot % kTreeWidth]};
  }
  /// All positions in tree order.
  std::vector<Vec3f> positions() const;

  /// The k nearest points of every point (itself among them, first or after its duplicates): calls
  /// visit(slot, neighbours) once per slot, in parallel, with the neighbours as slots in ascending order (ties by
  /// slot). Neighbouring slots are visited one after another on the same thread: this is the fast way to treat a whole
  /// cloud.
  using Visit = std::function<void(std::uint32_t slot, std::span<const Neighbour> neighbours)>;
  void for_each_nearest(std::size_t k, const Visit& visit) const;
  /// The same for the slots [first, last) on the calling thread.
  void for_each_nearest(std::size_t k, std::size_t first, std::size_t last, const Visit& visit) const;

 private:
  std::size_t size_ = 0;
  std::vector<detail::KdTreeLeaf> leaves_;
  BoxLevels levels_;  ///< over the leaves
  std::vector<std::uint32_t> order_;
};

}  // namespace sansmesh::inline v1
