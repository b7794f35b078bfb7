// Edges of triangles, sorted by their ends.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Key: the lower vertex · 2^32 + the higher one; index: 3 · triangle + edge, from corner `edge` to the next one.
/// Ascending. `triangle(t)` is triangle t of n, with vertices below `vertices`.
template <class TriangleAt>
std::vector<KeyIndex> sorted_edges(std::size_t n, std::size_t vertices, const TriangleAt& triangle) {
  std::vector<std::uint32_t> first(vertices + 1, 0);
  const auto for_each = [&](const auto& visit) {
    for (std::size_t t = 0; t < n; ++t) {
      const Triangle& v = triangle(t);
      for (std::size_t e = 0; e < 3; ++e) {
        const std::uint32_t a = v[e], b = v[e == 2 ? 0 : e + 1];
        visit(a < b ? a : b, a < b ? b : a, static_cast<unsigned>(3 * t + e));
      }
    }
  };
  for_each([&](std::uint32_t low, std::uint32_t, unsigned) { ++first[low + 1]; });
  for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
  std::vector<KeyIndex> edges(3 * n);
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for_each([&](std::uint32_t low, std::uint32_t high, unsigned index) {
    edges[next[low]++] = {std::uint64_t{low} << 32 | high, index};
  });
  parallel_for(0, vertices, 4096, [&](std::size_t v) {
    const auto begin = edges.begin() + first[v], end = edges.begin() + first[v + 1];
    if (end - begin > 1) std::sort(begin, end);
  });
  return edges;
}

}  // namespace sansmesh::inline v1
