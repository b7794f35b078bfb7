// Surfaces prepared for alignment: samples with normals, and closest points.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sansmesh/data/similarity.h"
#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

struct OrientedPoints {
  std::vector<Vec3> x, n;  ///< unit normals, or zero if unknown
  std::size_t size() const { return x.size(); }
  /// At most this number of them, evenly spaced in their order, in which neighbours are adjacent.
  OrientedPoints some(std::size_t most) const;
};

/// Closest point of a surface.
struct Foot {
  Vec3 point, normal;
  bool beyond = false;  ///< beyond the border of the surface
};

/// Evenly distributed samples with their tangent planes.
class SampleSurface {
 public:
  SampleSurface() = default;
  SampleSurface(OrientedPoints points, double spacing);
  /// Returns false if nothing is within reach.
  bool closest(const Vec3& q, double reach, Foot& foot) const;
  const OrientedPoints& points() const { return points_; }

 private:
  OrientedPoints points_;
  double spacing_ = 0;
  KdTree tree_;
};

/// Complete surface: triangles with their borders, or all points.
class WholeSurface {
 public:
  /// The points are in local coordinates; `spacing` as in SampleSurface.
  WholeSurface(const TriangleMesh& mesh, const OrientedPoints& points, double spacing);
  bool closest(const Vec3& q, double reach, Foot& foot) const;

 private:
  const TriangleMesh& mesh_;
  std::unique_ptr<ClosestTriangle> triangles_;
  std::vector<std::uint8_t> border_edge_;  ///< a bit per edge ab, bc, ca of each triangle
  std::vector<std::uint8_t> border_vertex_;
  std::unique_ptr<SampleSurface> points_;
};

/// One surface in local coordinates: relative to a point of the world and divided by a length.
struct AlignSide {
  TriangleMesh mesh;       ///< finite vertices, with triangles if there are any
  OrientedPoints all;      ///< clouds: all used points; estimated normals have arbitrary signs
  OrientedPoints dense;    ///< fewer points; estimated normals have consistent signs
  double area = 0;         ///< estimated from samples
  bool has_sides = false;  ///< whether normals have consistent signs
  bool is_mesh = false;
  Vec3 centroid;
  double radius = 0;  ///< root mean square distance from the centroid
};

/// Converts a surface to local coordinates. `most`: number of points of a cloud without normals for which these are
/// estimated; the others are dropped. Throws DataError that names the surface (`name`) if it cannot be aligned.
AlignSide prepare_side(const TriangleMesh& mesh, const LocalFrame& frame, std::size_t most, const char* name,
                       Progress& progress);

/// Local frame of a surface by itself: its centre, and its size as the unit. Throws DataError as prepare_side.
LocalFrame measure_side(const TriangleMesh& mesh, const char* name);

/// Even samples of a surface, about `spacing` apart, with normals averaged over `blur` (lengths).
OrientedPoints even_samples(const AlignSide& side, double spacing, double blur);

}  // namespace sansmesh::inline v1::detail
