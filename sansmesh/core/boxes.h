// Tests and unions of several boxes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/union_find.h"

namespace sansmesh::inline v1 {

/// Whether two boxes have a point in common.
template <class T>
bool touch(const BoxT<T>& a, const BoxT<T>& b) {
  for (int k = 0; k < 3; ++k)
    if (!(a.lower[k] <= b.upper[k] && b.lower[k] <= a.upper[k])) return false;
  return true;
}

/// Corner c (0 to 7): bits 0, 1 and 2 select the upper end along x, y and z.
template <class T>
VecT<T> box_corner(const BoxT<T>& box, int c) {
  return {c & 1 ? box.upper.x : box.lower.x, c & 2 ? box.upper.y : box.lower.y, c & 4 ? box.upper.z : box.lower.z};
}

template <class T>
BoxT<T> widened(const BoxT<T>& box, T by) {
  const VecT<T> d{by, by, by};
  return {box.lower - d, box.upper + d};
}

/// `share`: width of the margin over the diagonal.
template <class T>
BoxT<T> with_margin(const BoxT<T>& box, T share) {
  return widened(box, share * box.diagonal());
}

/// The points that two boxes have in common.
template <class T>
BoxT<T> common_part(const BoxT<T>& a, const BoxT<T>& b) {
  BoxT<T> part;
  for (std::size_t k = 0; k < 3; ++k)
    part.lower[k] = std::max(a.lower[k], b.lower[k]), part.upper[k] = std::min(a.upper[k], b.upper[k]);
  return part;
}

/// The smallest box in float that contains a box.
inline Box3f rounded_outward(const Box3& box) {
  constexpr float kEnd = std::numeric_limits<float>::infinity();
  Box3f around{Vec3f(box.lower), Vec3f(box.upper)};
  for (std::size_t k = 0; k < 3; ++k) {
    if (static_cast<double>(around.lower[k]) > box.lower[k]) around.lower[k] = std::nextafter(around.lower[k], -kEnd);
    if (static_cast<double>(around.upper[k]) < box.upper[k]) around.upper[k] = std::nextafter(around.upper[k], kEnd);
  }
  return around;
}

/// Bounding box of the finite points of a list.
template <class Points>
auto finite_bounds(const Points& points) {
  BoxT<std::remove_cvref_t<decltype(points[0].x)>> box;
  for (const auto& p : points)
    if (is_finite(p)) box.extend(p);
  return box;
}

template <class T>
BoxT<T> bounds_of(const std::vector<BoxT<T>>& boxes) {
  BoxT<T> all;
  for (const BoxT<T>& b : boxes) all.extend(b);
  return all;
}

/// Index of the first box that contains the point, or the number of boxes if none does.
template <class T>
std::size_t which_contains(const std::vector<BoxT<T>>& boxes, const VecT<T>& p) {
  const auto found = std::find_if(boxes.begin(), boxes.end(), [&](const BoxT<T>& b) { return b.contains(p); });
  return static_cast<std::size_t>(found - boxes.begin());
}

template <class T>
bool any_contains(const std::vector<BoxT<T>>& boxes, const VecT<T>& p) {
  return which_contains(boxes, p) < boxes.size();
}

template <class T>
bool any_touches(const std::vector<BoxT<T>>& boxes, const BoxT<T>& box) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const BoxT<T>& b) { return touch(b, box); });
}

template <class T>
T volume_of(const BoxT<T>& box) {
  const VecT<T> s = box.size();
  return box.empty() ? T(0) : s.x * s.y * s.z;
}

/// Replaces two touching boxes by their common bounding box if it has at most `growth` times their total volume.
/// Repeats until no such pair is left, and drops empty boxes. Worst-case work is cubic in the number of boxes.
template <class T>
void unite(std::vector<BoxT<T>>& boxes, T growth) {
  std::erase_if(boxes, [](const BoxT<T>& b) { return b.empty(); });
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t j = i + 1; j < boxes.size();) {
      BoxT<T> both = boxes[i];
      both.extend(boxes[j]);
      if (!touch(boxes[i], boxes[j]) || volume_of(both) > growth * (volume_of(boxes[i]) + volume_of(boxes[j]))) {
        ++j;
        continue;
      }
      boxes[i] = both;
      boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(j));
      // The grown box may now merge with earlier ones: restart.
      i = 0, j = 1;
    }
}

/// Number of connected components of touching boxes.
template <class T>
std::size_t separate_sets(const std::vector<BoxT<T>>& boxes) {
  UnionFind sets(boxes.size());
  std::size_t count = boxes.size();
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    for (std::uint32_t j = i + 1; j < boxes.size(); ++j) count -= touch(boxes[i], boxes[j]) && sets.join(i, j);
  return count;
}

}  // namespace sansmesh::inline v1
