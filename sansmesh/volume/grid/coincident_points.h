// Points at one place: seams of grids that close on themselves, borders of blocks, corners that coincide.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The shortest edge at each point that is one, rather than two corners at the same place; infinite where there is
/// none. each_edge(visit) calls visit(a, b, length) for all edges, twice the same ones. Points at the ends of edges
/// without length become joinable.
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

/// Of each point the first one at its place, to a hundredth of the shortest edge there and 1e-6 of the whole. Only
/// joinable points are looked at, and only those that have an edge. Empty if no two are at one place.
std::vector<std::uint32_t> coincident_points(std::span<const Vec3> points, std::span<const double> shortest_edges,
                                             std::span<const std::uint8_t> joinable);

}  // namespace sansmesh::inline v1
