#include "sansmesh/polygonize/lattice/cell_polygons.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint8_t kNoEdge = 255;

/// Corners of face 2·axis + side, counter-clockwise seen from outside.
constexpr std::array<std::array<std::uint8_t, 4>, 6> corners_of_faces() {
  std::array<std::array<std::uint8_t, 4>, 6> all{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t side = 0; side < 2; ++side) {
      const auto b = static_cast<std::uint8_t>(1u << (axis + 1) % 3),
                 c = static_cast<std::uint8_t>(1u << (axis + 2) % 3);
      const auto base = static_cast<std::uint8_t>(side << axis), far = static_cast<std::uint8_t>(base + b + c);
      const auto to_b = static_cast<std::uint8_t>(base + b), to_c = static_cast<std::uint8_t>(base + c);
      all[2 * axis + side] = side ? std::array{base, to_b, far, to_c} : std::array{base, to_c, far, to_b};
    }
  return all;
}
constexpr std::array<std::array<std::uint8_t, 4>, 6> kFaces = corners_of_faces();

/// Index of the edge between two corners: 4 · direction + position.
std::size_t edge_between(std::size_t a, std::size_t b) {
  const std::size_t low = std::min(a, b), along = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
  const std::size_t across = along == 0 ? low >> 1 : along == 1 ? (low & 1u) | (low >> 1 & 2u) : low & 3u;
  return 4 * along + across;
}

/// 1 for equilateral triangles, 0 without area.
double shape_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
  const Vec3 p = b - a, q = c - a;
  const double sum = squared_norm(p) + squared_norm(q) + squared_norm(q - p);
  return sum > 0 ? 2 * std::sqrt(3.0) * dot(cross(p, q), normal) / sum : 0;
}

}  // namespace

void trace_cell(unsigned negative, std::size_t outer, unsigned split, CellPolygons& found) {
  found.points.clear();
  found.ends.clear();
  const auto below = [&](std::size_t corner) { return (negative >> corner & 1u) != 0; };
  struct Step {
    std::uint8_t to = kNoEdge;
    CellPolygons::Point from{}, via{};  ///< corners of the edge, and of the face diagonal if the path crosses it
    bool crosses = false;
  };
  std::array<Step, 12> step;
  for (std::size_t face = 0; face < 6; ++face) {
    const std::array<std::uint8_t, 4>& at = kFaces[face];
    unsigned signs = 0;
    for (std::size_t k = 0; k < 4; ++k) signs |= below(at[k]) ? 1u << k : 0u;
    if (signs == 0 || signs == 15) continue;
    // End of the face diagonal: a corner of the block on the block's faces, else its centre.
    const std::size_t axis = face / 2, side = face % 2;
    const std::size_t end = side == (outer >> axis & 1u) ? outer : outer ^ 7u;
    std::size_t d = 0;
    while (at[d] != end) ++d;
    const std::size_t e = (d + 2) % 4;
    const bool alternate = signs == 5 || signs == 10;
    for (std::size_t k = 0; k < 4; ++k) {  // from the change to negative ...
      const std::size_t l = (k + 1) % 4;
      if (below(at[k]) || !below(at[l])) continue;
      // ... to the change to positive: the next one, or the previous if positive corners are separated.
      std::size_t m = l;
      if (alternate && below(at[d])) {
        m = (k + 3) % 4;
      } else {
        while (below(at[(m + 1) % 4])) m = (m + 1) % 4;
      }
      Step& s = step[edge_between(at[k], at[l])];
      s.to = static_cast<std::uint8_t>(edge_between(at[m], at[(m + 1) % 4]));
      s.from = {at[k], at[l]};
      s.via = {at[d], at[e]};
      s.crosses = (split >> face & 1u) != 0 && below(at[d]) != below(at[e]);
    }
  }
  std::array<bool, 12> done{};
  for (std::size_t first = 0; first < 12; ++first) {
    if (done[first] || step[first].to == kNoEdge) continue;
    for (std::size_t now = first; !done[now]; now = step[now].to) {
      done[now] = true;
      found.points.push_back(step[now].from);
      if (step[now].crosses) found.points.push_back(step[now].via);
    }
    found.ends.push_back(static_cast<std::uint32_t>(found.points.size()));
  }
}

void best_triangles(std::span<const Vec3> corner, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const std::size_t n = corner.size();
  triangles.clear();
  if (n == 3) {
    triangles.push_back({0, 1, 2});
    return;
  }
  Vec3 normal;
  for (std::size_t k = 2; k < n; ++k) normal += cross(corner[k - 1] - corner[0], corner[k] - corner[0]);
  normal = normalized(normal);
  if (n == 4) {
    const double a =
        std::min(shape_of(corner[0], corner[1], corner[2], normal), shape_of(corner[0], corner[2], corner[3], normal));
    const double b =
        std::min(shape_of(corner[0], corner[1], corner[3], normal), shape_of(corner[1], corner[2], corner[3], normal));
    if (a >= b) {
      triangles.assign({{0, 1, 2}, {0, 2, 3}});
    } else {
      triangles.assign({{0, 1, 3}, {1, 2, 3}});
    }
    return;
  }
  // Dynamic programming over the vertex ranges i, i + 1, …, j, by increasing length.
  thread_local std::vector<double> best;
  thread_local std::vector<std::uint32_t> middle;
  best.assign(n * n, 1);
  middle.assign(n * n, 0);
  for (std::size_t length = 2; length < n; ++length)
    for (std::size_t i = 0, j = length; j < n; ++i, ++j) {
      double most = -2;
      for (std::size_t k = i + 1; k < j; ++k) {
        const double least =
            std::min({best[i * n + k], best[k * n + j], shape_of(corner[i], corner[k], corner[j], normal)});
        if (least > most) most = least, middle[i * n + j] = static_cast<std::uint32_t>(k);
      }
      best[i * n + j] = most;
    }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{0, static_cast<std::uint32_t>(n - 1)}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const std::uint32_t k = middle[i * n + j];
    triangles.push_back({i, k, j});
    open.emplace_back(i, k);
    open.emplace_back(k, j);
  }
}

}  // namespace sansmesh::inline v1
