#include "sansmesh/search/brute_force.h"

#include <algorithm>

namespace sansmesh::inline v1 {
namespace {

std::vector<Neighbour> sorted_distances(std::span<const Vec3f> points, const Vec3f& q) {
  std::vector<Neighbour> all;
  if (!is_finite(q)) return all;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_finite(points[i])) all.push_back({squared_distance(points[i], q), static_cast<std::uint32_t>(i)});
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

std::size_t BruteForce::size() const {
  return static_cast<std::size_t>(
      std::count_if(points_.begin(), points_.end(), [](const Vec3f& p) { return is_finite(p); }));
}

std::size_t BruteForce::nearest(const Vec3f& q, std::span<Neighbour> out) const {
  const std::vector<Neighbour> all = sorted_distances(points_, q);
  const std::size_t count = std::min(all.size(), out.size());
  std::copy_n(all.begin(), count, out.begin());
  return count;
}

std::optional<Neighbour> BruteForce::nearest(const Vec3f& q) const {
  Neighbour result[1];
  if (nearest(q, result) == 0) return std::nullopt;
  return result[0];
}

void BruteForce::within(const Vec3f& q, float radius, std::vector<Neighbour>& out) const {
  out.clear();
  if (!(radius >= 0)) return;
  for (const Neighbour& n : sorted_distances(points_, q))
    if (n.squared_distance <= radius * radius) out.push_back(n);
}

std::size_t BruteForce::count_within(const Vec3f& q, float radius) const {
  std::vector<Neighbour> found;
  within(q, radius, found);
  return found.size();
}

}  // namespace sansmesh::inline v1
