#include "sansmesh/deform/handles/handle_conflicts.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>

#include "sansmesh/box.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::detail {
namespace {

double fraction_near(const DeformHandle& h, const Vec3& x) {
  return h.segment ? std::clamp(dot(x - h.q, h.along_q) / squared_norm(h.along_q), 0.0, 1.0) : 0;
}

/// Positions on two handles that may coincide: ends, and the closest points of lines.
using HandlePair = std::array<double, 2>;
std::vector<HandlePair> candidates(const DeformHandle& a, const DeformHandle& b) {
  std::vector<HandlePair> pairs{{0, fraction_near(b, a.q)}, {fraction_near(a, b.q), 0}};
  if (a.segment) pairs.push_back({1, fraction_near(b, a.q + a.along_q)});
  if (b.segment) pairs.push_back({fraction_near(a, b.q + b.along_q), 1});
  if (a.segment && b.segment) {
    const double aa = squared_norm(a.along_q), bb = squared_norm(b.along_q), ab = dot(a.along_q, b.along_q);
    const double det = aa * bb - ab * ab;
    if (det > 1e-20 * aa * bb) {
      const Vec3 between = b.q - a.q;
      const double s = std::clamp((dot(between, a.along_q) * bb - dot(between, b.along_q) * ab) / det, 0.0, 1.0);
      pairs.push_back({s, fraction_near(b, a.q + a.along_q * s)});
    }
  }
  return pairs;
}

bool conflict(const DeformHandle& a, const DeformHandle& b, double together, double apart) {
  for (const auto& [s, t] : candidates(a, b)) {
    if (norm(a.q + a.along_q * s - b.q - b.along_q * t) <= together &&
        norm(a.p + a.along_p * s - b.p - b.along_p * t) > apart)
      return true;
  }
  return false;
}

}  // namespace

void check_handle_conflicts(const std::vector<DeformHandle>& handles, double together, double apart) {
  // Sorted along the longest side, because landmarks may be coplanar.
  Box3 box;
  for (const DeformHandle& h : handles) box.extend(h.q), box.extend(h.q + h.along_q);
  const Vec3 size = box.size();
  const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto begin = [&](std::size_t i) { return handles[i].q[axis] + std::min(0.0, handles[i].along_q[axis]); };
  const auto end = [&](std::size_t i) { return handles[i].q[axis] + std::max(0.0, handles[i].along_q[axis]); };
  std::vector<std::size_t> order(handles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return begin(a) != begin(b) ? begin(a) < begin(b) : a < b; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    for (std::size_t l = k + 1; l < order.size() && begin(order[l]) <= end(order[k]) + together; ++l) {
      const auto [i, j] = std::minmax(order[k], order[l]);
      if (conflict(handles[i], handles[j], together, apart))
        throw ArgumentError("handles " + std::to_string(i + 1) + " and " + std::to_string(j + 1) +
                            " have one target but different origins: remove or move one of them");
    }
  }
}

}  // namespace sansmesh::inline v1::detail
