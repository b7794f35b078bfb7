// A triangle surface with a border, for segment intersections and distances.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Built once; thread-safe queries, in double precision and world coordinates. Coincident vertices are merged;
/// triangles without area or with an invalid corner are left out. Edges of a single triangle form the border.
class TriangleSheet {
 public:
  struct Crossing {
    double share = 0;  ///< position on the segment, 0..1
    Vec3 point;
    std::uint32_t triangle = 0;
  };
  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    double share = 0;  ///< position on the segment
    Vec3 point;        ///< on the sheet
  };

  explicit TriangleSheet(const TriangleMesh& mesh);

  bool empty() const { return triangles_.empty(); }
  const Box3& bounds() const { return box_; }
  std::size_t size() const { return triangles_.size(); }
  std::array<Vec3, 3> corners(std::size_t triangle) const;

  bool crosses(const Vec3& a, const Vec3& b) const;
  /// Appends all crossings in order; one where neighbours share the point.
  void crossings(const Vec3& a, const Vec3& b, std::vector<Crossing>& found) const;
  /// Appends the points at which border edges cross the triangle.
  void border_points(const std::array<Vec3, 3>& triangle, std::vector<Vec3>& found) const;
  /// A border edge or bent edge that crosses the triangle (a, b, c), which is so thin that b is nearer than `width` to
  /// the line from a to c.
  struct Bend {
    Vec3 point;       ///< crossing point
    Vec3 begin, end;  ///< ends of the edge
  };
  void bends(const Vec3& a, const Vec3& b, const Vec3& c, double width, std::vector<Bend>& found) const;
  /// Searches within distance `limit`. A segment that crosses the sheet has distance 0.
  Nearest nearest(const Vec3& a, const Vec3& b, double limit) const;
  Nearest nearest(const Vec3& x, double limit) const { return nearest(x, x, limit); }
  /// Nearest point of the border.
  Nearest nearest_border(const Vec3& x, double limit) const;

 private:
  struct Node {
    Box3 box;
    std::uint32_t first = 0;  ///< leaf: its first entry; inner node: its second child (the first follows the node)
    std::uint32_t count = 0;  ///< leaf: number of entries; inner node: 0
  };
  struct Tree {
    std::vector<Node> nodes;
    std::vector<std::uint32_t> entries;
  };
  template <class BoxOf>
  static void build(Tree& tree, std::size_t first, std::size_t last, const BoxOf& box_of);
  template <class Enters, class Use>
  static void visit(const Tree& tree, const Enters& enters, const Use& use);
  bool hit(const Vec3& a, const Vec3& b, std::uint32_t triangle, double& share) const;

  std::vector<Vec3> points_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<std::uint32_t, 2>> border_, bent_;
  Tree tree_, border_tree_, bent_tree_;
  Box3 box_;
};

}  // namespace sansmesh::inline v1
