// A convex polyhedron that planes cut smaller and smaller: cells of Voronoi diagrams.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Bounded and convex. Each face carries a label: that of the plane that made it. Reused, it allocates nothing.
class ConvexCell {
 public:
  static constexpr std::uint32_t kBox = 0xffffffffu;  ///< label of the faces of the box it was made of

  /// The box from lower to upper.
  void assign_box(const Vec3& lower, const Vec3& upper);

  /// Becomes a copy of the other one, keeping its own memory for cuts.
  void assign(const ConvexCell& other) {
    vertices_ = other.vertices_;
    loops_ = other.loops_;
    faces_ = other.faces_;
  }

  /// Keeps what lies on the side ⟨normal, x⟩ <= offset; the new face is labelled. Returns whether anything was cut off.
  /// What is left may be empty.
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
  std::vector<Vec3> vertices_;
  std::vector<std::uint32_t> loops_;
  std::vector<Face> faces_;

  // Of the cut in progress.
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
