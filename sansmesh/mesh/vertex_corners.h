// Triangles around each vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Largest number of triangles whose corners 32 bits can count.
constexpr std::size_t kMostTriangles = 0xffffffff / 3;

/// Corners (3·triangle + k) at vertex v: corner[first[v] .. first[v + 1]], ascending. Throws DataError for more than
/// kMostTriangles.
struct VertexCorners {
  std::vector<std::uint32_t> first, corner;

  VertexCorners(const std::vector<Triangle>& triangles, std::size_t vertices)
      : first(vertices + 1), corner(3 * triangles.size()) {
    if (triangles.size() > kMostTriangles) throw DataError("the mesh has more triangles than can be counted");
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t) ++first[v + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) corner[next[triangles[i][k]]++] = static_cast<std::uint32_t>(3 * i + k);
  }
};

}  // namespace sansmesh::inline v1
