// Coincident points: seams of grids that close on themselves, borders of blocks, collapsed corners.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Length of the shortest edge at each point, ignoring edges between coincident corners; infinite without edges.
/// each_edge(visit) calls visit(a, b, length) for all edges and is called twice. The ends of edges without length
/// become joinable.
template <class EachEdge>
std::vector<double> shortest_edges(std::size_t points, const EachEdge& each_edge, std::vector<std::uint8_t>& joinable) {
  constexpr double kNoEdge = 1e-9;
  std::vector<double> longest(points, 0.0), shortest(points, std::numeric_limits<double>::infinity());
  each_edge([&](std::uint32_t a, std::uint32_t b, double length) {
    longest[a] = std::max(longest[a], length), longest[b] = std::max(longest[b], length);
  });
  each_edge([&](std::uint32_t a, std::uint32_t b, double length) {
    for (const std::uint32_t p : {a, b}) {
      if (length > kNoEdge * longest[p])
        shortest[p] = std::min(shortest[p], length);
      else
        joinable[p] = 1;
    }
  });
  return shortest;
}

/// For each point the first of all points that coincide with it, directly or through others: those within the smaller
/// of both tolerances. Only the `joinable` points are considered. Empty if no two points coincide.
std::vector<std::uint32_t> joined_points(std::span<const Vec3> points, std::span<const std::uint32_t> joinable,
                                         const std::function<double(std::uint32_t)>& tolerance);

/// For each point the first point that coincides with it, within a hundredth of its shortest edge and 1e-6 of the
/// extent. Only joinable points with an edge are considered. Empty if no two points coincide.
std::vector<std::uint32_t> coincident_points(std::span<const Vec3> points, std::span<const double> shortest_edges,
                                             std::span<const std::uint8_t> joinable);

}  // namespace sansmesh::inline v1
