#include "sansmesh/points/duplicates.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/local_frame.h"

namespace sansmesh {
namespace {

constexpr std::size_t kChunk = 65536;

bool lexicographic(const Vec3f& a, const Vec3f& b) {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

std::uint64_t hash_of(const Vec3f& p) {
  std::uint64_t hash = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const float c = p[k] + 0.0f;  // -0 becomes 0
    hash = (hash ^ std::bit_cast<std::uint32_t>(c)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash;
}

// Finite samples in the order of a hash of their position: duplicates come together, the lowest index first.
// Different positions with the same hash must be told apart by the code that walks along a run.
std::vector<KeyIndex> by_position(const std::vector<Vec3f>& positions) {
  std::vector<KeyIndex> keys;
  keys.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (is_finite(positions[i])) keys.push_back({hash_of(positions[i]), static_cast<unsigned>(i)});
  parallel_sort(keys);
  return keys;
}

// Calls duplicate(index) for every finite sample that equals one of lower index; returns the number of the others.
template <class Duplicate>
std::size_t for_each_duplicate(const std::vector<Vec3f>& positions, const Duplicate& duplicate) {
  const std::vector<KeyIndex> keys = by_position(positions);
  std::size_t unique = 0;
  std::vector<std::uint32_t> run;
  for (std::size_t first = 0, last = 0; first < keys.size(); first = last) {
    while (last < keys.size() && keys[last].key == keys[first].key) ++last;
    run.clear();
    for (std::size_t i = first; i < last; ++i) run.push_back(keys[i].index);
    std::stable_sort(run.begin(), run.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return lexicographic(positions[a], positions[b]); });
    for (std::size_t i = 0; i < run.size(); ++i) {
      if (i > 0 && positions[run[i]] == positions[run[i - 1]])
        duplicate(run[i]);
      else
        ++unique;
    }
  }
  return unique;
}

}  // namespace

CloudShape classify_shape(const PointSet& points) {
  // Offsets from the middle of the box in double: no cancellation even far from the origin.
  Box3f box;
  std::size_t finite = 0;
  for (const Vec3f& p : points.positions)
    if (is_finite(p)) box.extend(p), ++finite;
  if (finite == 0) return CloudShape::empty;
  const Vec3 center = Box3{Vec3(box.lower), Vec3(box.upper)}.center();
  const double diagonal = norm(Vec3(box.upper) - Vec3(box.lower));
  double largest_coordinate = 0;
  for (std::size_t k = 0; k < 3; ++k)
    largest_coordinate = std::max(
        {largest_coordinate, std::abs(static_cast<double>(box.lower[k])), std::abs(static_cast<double>(box.upper[k]))});
  const double rounding = 4 * static_cast<double>(std::numeric_limits<float>::epsilon()) * largest_coordinate;
  if (diagonal <= rounding) return CloudShape::point;

  const std::vector<Vec3f>& positions = points.positions;
  const auto add = [](Symmetric3 a, const Symmetric3& b) {
    return Symmetric3{a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
  };
  const auto offset = [&](std::size_t i) { return (Vec3(positions[i]) - center) / diagonal; };
  const Vec3 mean = parallel_reduce(
                        positions.size(), kChunk, Vec3{},
                        [&](std::size_t first, std::size_t last) {
                          Vec3 sum;
                          for (std::size_t i = first; i < last; ++i)
                            if (is_finite(positions[i])) sum += offset(i);
                          return sum;
                        },
                        [](Vec3 a, const Vec3& b) { return a + b; }) /
                    static_cast<double>(finite);
  const Symmetric3 covariance = parallel_reduce(
      positions.size(), kChunk, Symmetric3{},
      [&](std::size_t first, std::size_t last) {
        Symmetric3 sum;
        for (std::size_t i = first; i < last; ++i)
          if (is_finite(positions[i])) sum.add(offset(i) - mean);
        return sum;
      },
      add);
  const PrincipalAxes axes = principal_axes(covariance);
  Box3 extent;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!is_finite(positions[i])) continue;
    const Vec3 o = offset(i);
    extent.extend({dot(o, axes.axes[0]), dot(o, axes.axes[1]), dot(o, axes.axes[2])});
  }
  const Vec3 size = extent.size();
  const double tolerance = 1e-6 * std::max({size.x, size.y, size.z}) + rounding / diagonal;
  if (size.y <= tolerance) return CloudShape::line;
  return size.x <= tolerance ? CloudShape::plane : CloudShape::volume;
}

std::size_t count_non_finite(const PointSet& points) {
  return static_cast<std::size_t>(
      std::count_if(points.positions.begin(), points.positions.end(), [](const Vec3f& p) { return !is_finite(p); }));
}

double duplicate_share(const PointSet& points) {
  const std::uint64_t mask = points.size() < 100000 ? 0 : 63;
  std::vector<std::uint64_t> hashes;
  for (const Vec3f& p : points.positions)
    if (const std::uint64_t hash = hash_of(p); is_finite(p) && (hash >> 32 & mask) == 0) hashes.push_back(hash);
  if (hashes.empty()) return 0;
  const auto count = static_cast<double>(hashes.size());
  std::sort(hashes.begin(), hashes.end());
  const auto unique = std::unique(hashes.begin(), hashes.end()) - hashes.begin();
  return 1 - static_cast<double>(unique) / count;
}

std::size_t count_unique(const PointSet& points) {
  return for_each_duplicate(points.positions, [](std::uint32_t) {});
}

std::vector<std::uint8_t> find_duplicates(const PointSet& points) {
  std::vector<std::uint8_t> mask(points.size());
  for_each_duplicate(points.positions, [&](std::uint32_t i) { mask[i] = 1; });
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points.positions[i])) mask[i] = 1;
  return mask;
}

}  // namespace sansmesh
