// Convex polyhedron with cuts by half-spaces: cells of Voronoi diagrams.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Bounded and convex. Each face carries the label of its plane. Reuse allocates no memory.
class ConvexCell {
 public:
  static constexpr std::uint32_t kBox = 0xffffffffu;  ///< label of the faces of the initial box

  /// Sets the cell to the box from lower to upper.
  void assign_box(const Vec3& lower, const Vec3& upper);

  /// Copies the faces of the other cell and keeps its own buffers.
  void assign(const ConvexCell& other) {
    vertices_ = other.vertices_;
    loops_ = other.loops_;
    faces_ = other.faces_;
  }

  /// Intersects the cell with the half-space ⟨normal, x⟩ <= offset and labels the new face. Returns whether the cell
  /// changed. The result may be empty.
  bool cut(const Vec3& normal, double offset, std::uint32_t label);

  bool empty() const { return faces_.empty(); }
  const std::vector<Vec3>& vertices() const { return vertices_; }
  double volume() const;

  struct FaceMoment {
    std::uint32_t label;
    double area;
    Vec3 first;  ///< ∫ x dA
  };
  /// Area and first moment of each face. Replaces `out`.
  void moments(std::vector<FaceMoment>& out) const;

 private:
  struct Face {
    std::uint32_t label, begin, count;  // a ring in loops_, counter-clockwise from outside
  };
  static constexpr std::uint32_t kGone = 0xffffffffu;

  /// The vertex of the cut on an edge, shared by both faces of the edge.
  std::uint32_t crossing(std::uint32_t a, std::uint32_t b);
  /// Makes the loop from `begin` on a face, if it has three vertices.
  void add_face(std::uint32_t label, std::uint32_t begin);
  void cut_face(const Face& face);
  /// Adds the new face, which traverses shared edges in the opposite direction. Rounding may leave several rings.
  void close_cut(std::uint32_t label);

  std::vector<Vec3> vertices_;
  std::vector<std::uint32_t> loops_;
  std::vector<Face> faces_;

  // Buffers of cut().
  struct Segment {
    std::uint32_t from, to;
  };
  std::vector<double> side_;
  std::vector<std::uint32_t> renamed_, old_loops_;
  std::vector<Vec3> old_vertices_;
  std::vector<Face> old_faces_;
  std::vector<Segment> segments_;
  struct CutEdge {
    std::uint64_t key;
    std::uint32_t vertex;
  };
  std::vector<CutEdge> cut_edges_;
};

}  // namespace sansmesh::inline v1::detail
