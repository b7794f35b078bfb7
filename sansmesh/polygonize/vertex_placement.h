// Where the vertices of an extracted mesh go: onto the surface, its creases, and evenly over it.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/polygonize/polygonize_options.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Triangles around each vertex.
struct Rings {
  std::vector<std::uint32_t> first, triangle;
  Rings(const std::vector<Triangle>& triangles, std::size_t vertices)
      : first(vertices + 1, 0), triangle(3 * triangles.size()) {
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t) ++first[v + 1];
    for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (const std::uint32_t v : triangles[i]) triangle[next[v]++] = static_cast<std::uint32_t>(i);
  }
};

/// Moves the vertices next to a crease onto it: where the normals around a vertex differ by more than 30°, to the point
/// where the tangent planes around it meet, if that is close and the field agrees that it is on the surface.
void snap_to_creases(const ScalarField& field, const std::vector<Triangle>& triangles, const Rings& rings,
                     const std::vector<Vec3f>& normals, std::vector<Vec3>& x);

/// A mesh with its vertices on a curved surface lies on one side of it. Moves each vertex along its normal by the mean
/// distance of the triangles around it, so that they straddle the surface: on a sphere the mean gap falls to a third.
/// Vertices at creases stay.
void balance_gaps(const ScalarField& field, const std::vector<Triangle>& triangles, const Rings& rings,
                  const std::vector<Vec3f>& normals, std::vector<Vec3>& x);

/// Moves each vertex towards the area-weighted mean of its triangles' centroids, within its tangent plane: evens out
/// the spacing and leaves the shape alone (to first order).
void smooth_tangentially(const std::vector<Triangle>& triangles, const Rings& rings, const std::vector<Vec3f>& normals,
                         int rounds, std::vector<Vec3>& x);

/// After simplification: vertices go back onto the surface, or straddle it, where it is smooth. At creases they are
/// where the quadrics put them.
void place_again(const ScalarField& field, const PolygonizeOptions& options, TriangleMesh& mesh, std::vector<Vec3>& x);

}  // namespace sansmesh::inline v1
