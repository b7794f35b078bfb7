// Exact intersections of pairs of triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/mesh/booleans/exact_points.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A part of a triangle that belongs to another triangle: a segment between two points of a list, or one point twice.
struct TriangleCut {
  std::uint32_t triangle = 0;
  std::uint32_t from = 0, to = 0;
  FacePlane plane;  ///< contains the segment; not the plane of the triangle
};

struct TriangleCuts {
  std::vector<ExactPoint> points;
  std::vector<TriangleCut> cuts;
};

/// Adds the intersection of triangles s and t to the cuts of both. With coplanar triangles, the edges of each cut the
/// other. Both have an area.
void cut_pair(const ExactSpace& space, std::span<const Triangle> triangles, std::uint32_t s, std::uint32_t t,
              TriangleCuts& found);

}  // namespace sansmesh::inline v1
