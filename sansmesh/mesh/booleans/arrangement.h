// Subdivision of the triangles of several solids along their intersections.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/mesh/booleans/exact_points.h"
#include "sansmesh/mesh/face_box_tree.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Triangles of several solids over one array of corners.
struct SolidTriangles {
  std::vector<Vec3> corners;
  std::vector<Triangle> triangles;      ///< with areas; each solid closed and oriented
  std::vector<std::uint32_t> solid_of;  ///< solid of each triangle
  std::size_t solids = 0;
  /// Whether all intersections of each solid with itself are cut, too, so that winding numbers are those of patches.
  std::vector<std::uint8_t> resolved;
};

/// Box of a triangle, rounded outward.
Box3f triangle_box(const SolidTriangles& in, std::size_t triangle);
/// One for each triangle.
std::vector<Box3f> triangle_boxes(const SolidTriangles& in);

/// A triangle, or a part of one.
struct Piece {
  Triangle vertex;           ///< see Arrangement::point
  std::uint32_t triangle;    ///< the whole triangle
  std::array<bool, 3> seam;  ///< whether the edge from this vertex to the next is on another triangle
  bool cut = false;          ///< whether it is only a part
};

/// Pieces that meet other solids' only at common vertices and edges, or coincide with a region of them.
struct Arrangement {
  std::size_t corners = 0;       ///< vertices below this are corners of the input
  std::vector<ExactPoint> seam;  ///< vertex corners + i
  std::vector<Piece> pieces;     ///< in the order of the triangles

  ExactPoint point(const ExactSpace& space, std::uint32_t vertex) const {
    return vertex < corners ? space.corner(vertex) : seam[vertex - corners];
  }
};

/// Equal points of pieces of cut triangles are one vertex. A triangle that meets no other solid is one piece, with its
/// own corners or equal ones. Self-intersections of solids that are not `resolved` are cut where they continue those
/// with others. The result does not depend on the number of threads.
Arrangement arrange(const SolidTriangles& in, const ExactSpace& space, const FaceBoxTree& tree,
                    std::span<const Box3f> boxes);

}  // namespace sansmesh::inline v1
