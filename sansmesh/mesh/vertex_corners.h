// Triangles around each vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/data/group_rows.h"
#include "sansmesh/error.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Largest number of triangles whose corners 32 bits can count.
constexpr std::size_t kMostTriangles = 0xffffffff / 3;

/// Corners (3·triangle + k) at each vertex, ascending. Throws DataError for more than kMostTriangles.
struct VertexCorners : Adjacency32 {
  VertexCorners(const std::vector<Triangle>& triangles, std::size_t vertices)
      : Adjacency32(group_corners(triangles, vertices)) {}

 private:
  static Adjacency32 group_corners(const std::vector<Triangle>& triangles, std::size_t vertices) {
    if (triangles.size() > kMostTriangles) throw DataError("the mesh has more triangles than can be counted");
    return group_rows<std::uint32_t>(vertices, [&](const auto& visit) {
      for (std::size_t i = 0; i < triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) visit(triangles[i][k], 3 * i + k);
    });
  }
};

}  // namespace sansmesh::inline v1
