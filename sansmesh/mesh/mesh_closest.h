// Closest point on a mesh.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Part of a triangle (a, b, c): a corner, an edge without its ends, or the interior.
enum class TrianglePart : std::uint8_t { a, b, c, ab, bc, ca, inside };

struct TrianglePoint {
  Vec3 point;
  TrianglePart part = TrianglePart::a;
};

/// Closest point of the triangle (a, b, c) to p and its part of the triangle; for triangles without area that of an
/// edge or vertex (Ericson 2005, section 5.1.5).
TrianglePoint locate_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);
/// Same, without the part.
Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Built once (parallel), then queried from any thread: a binary tree of boxes over the triangles, split at the median.
/// Copies the data. Ignores triangles with a corner that is not finite or does not exist.
class ClosestTriangle {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// Closest point: position relative to the mesh's origin, squared distance, triangle (kNone for an empty mesh).
  struct Hit {
    Vec3 point;
    double squared_distance = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = kNone;
  };

  explicit ClosestTriangle(const TriangleMesh& mesh);

  bool empty() const { return corners_.empty(); }
  /// Exact up to rounding. `query` is relative to the mesh's origin. `hint`: result of a nearby query, which
  /// accelerates the search without changing the distance. A hint with a squared distance but no triangle limits the
  /// search to smaller distances: if nothing is closer, the result has no triangle either.
  Hit closest(const Vec3& query, const Hit& hint) const;
  Hit closest(const Vec3& query) const;

 private:
  struct Node {
    Vec3f lower, upper;
    std::uint32_t first = 0;  ///< leaf: its first triangle; inner node: its second child (the first follows the node)
    std::uint32_t count = 0;  ///< leaf: number of triangles; inner node: 0
  };
  struct Corners {
    Vec3f a, b, c;
  };
  struct Item {
    Vec3f center;
    std::uint32_t triangle;
  };
  void build(std::vector<Item>& items, const TriangleMesh& mesh, std::size_t node, std::size_t first, std::size_t last);

  std::vector<Node> nodes_;
  std::vector<Corners> corners_;          ///< in tree order
  std::vector<std::uint32_t> triangles_;  ///< in tree order: index in the mesh
  std::vector<std::uint32_t> slots_;      ///< position of each triangle of the mesh in tree order
};

}  // namespace sansmesh::inline v1
