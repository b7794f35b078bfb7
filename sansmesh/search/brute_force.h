// Brute-force neighbour search, O(n) per query: the reference for tests of KdTree.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/search/kd_tree.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Has the interface and results of KdTree. Keeps a view: `points` must outlive it.
class BruteForce {
 public:
  explicit BruteForce(std::span<const Vec3f> points) : points_(points) {}

  std::size_t size() const;
  std::size_t nearest(const Vec3f& q, std::span<Neighbour> out) const;
  std::optional<Neighbour> nearest(const Vec3f& q) const;
  void within(const Vec3f& q, float radius, std::vector<Neighbour>& out) const;
  std::size_t count_within(const Vec3f& q, float radius) const;

 private:
  std::span<const Vec3f> points_;
};

}  // namespace sansmesh::inline v1
