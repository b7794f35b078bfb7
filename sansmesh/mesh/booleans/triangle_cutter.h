// Subdivision of one triangle along segments.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/mesh/booleans/exact_points.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A segment between two vertices, in a plane across the triangle.
struct CutterSegment {
  std::uint32_t from = 0, to = 0;
  FacePlane plane;
};

/// A triangulation of a triangle with given points as vertices and given segments as unions of edges. Predicates are
/// exact; among the valid triangulations it is nearly the constrained Delaunay triangulation.
class TriangleCutter {
 public:
  /// The first three points are the corners; the others are in the triangle. No two are equal.
  TriangleCutter(const ExactSpace& space, const Triangle& corners, std::vector<ExactPoint> points);

  /// Makes the segment a union of edges. Where it crosses previous ones there are new vertices.
  void add(const CutterSegment& segment);

  /// The vertices: those given, then crossings of segments.
  const std::vector<ExactPoint>& points() const { return points_; }

  struct Part {
    std::array<std::uint32_t, 3> vertex;  ///< oriented like the triangle
    std::array<bool, 3> seam;             ///< whether the edge from this vertex to the next belongs to a segment
  };
  std::vector<Part> parts() const;

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  struct Face {
    std::array<std::uint32_t, 3> vertex;
    std::array<std::uint32_t, 3> next{kNone, kNone, kNone};     ///< across the edge from vertex i to vertex i + 1
    std::array<std::uint32_t, 3> segment{kNone, kNone, kNone};  ///< index of a segment that contains this edge
  };
  /// Edge `edge` of a face.
  struct Side {
    std::uint32_t face = kNone, edge = 0;
  };

  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  void insert(std::uint32_t p);
  Side locate(std::uint32_t p, bool& on_edge);
  void split_face(std::uint32_t face, std::uint32_t p);
  void split_edge(Side side, std::uint32_t p);
  void link(Side a, Side b);
  Side across(Side side) const;
  void relink(Side inner, Side outer, std::uint32_t segment);
  bool flip(Side side);
  bool improves(Side side) const;
  void legalize();
  Side edge_between(std::uint32_t a, std::uint32_t b) const;
  /// Next face around a vertex, counter-clockwise (or clockwise), given by its edge that begins at the vertex.
  Side around(Side side, bool clockwise) const;
  template <class Visit>
  void visit_around(std::uint32_t vertex, const Visit& visit) const;
  void mark(std::uint32_t a, std::uint32_t b, std::uint32_t segment);
  std::uint32_t step(std::uint32_t a, std::uint32_t b, std::uint32_t segment);
  void free_corridor(std::uint32_t a, std::uint32_t b, std::vector<std::array<std::uint32_t, 2>> crossed);

  const ExactSpace& space_;
  Triangle corners_;
  int axis_, orientation_;
  std::vector<ExactPoint> points_;
  std::vector<std::array<double, 2>> flat_;  ///< approximate positions in the plane
  std::array<Vec3, 2> frame_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> face_of_;  ///< a face at each vertex
  std::vector<CutterSegment> segments_;
  std::vector<Side> pending_;  ///< edges that may violate the Delaunay property
  std::uint32_t last_ = 0;
  std::uint32_t random_ = 1;
};

}  // namespace sansmesh::inline v1
