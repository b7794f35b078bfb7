// Two surfaces as their alignment sees them: samples with normals, and where the nearest place of the surface is.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// p → scale · R p + shift, R by its columns.
struct Pose {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  double scale = 1;
  Vec3 shift;

  Vec3 turn(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3 turn_back(const Vec3& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
  Vec3 operator()(const Vec3& p) const { return turn(p) * scale + shift; }
  Vec3 inverse(const Vec3& p) const { return turn_back(p - shift) / scale; }
};

/// The rotation by a vector (radians).
Pose rotation_by_vector(const Vec3& w);
/// Angle between the rotations of two poses, 0..π.
double angle_between(const Pose& a, const Pose& b);

struct OrientedPoints {
  std::vector<Vec3> x, n;  ///< normals unit, or zero where unknown
  std::size_t size() const { return x.size(); }
};

/// The nearest place of a surface.
struct Foot {
  Vec3 point, normal;
  bool beyond = false;  ///< the surface ends there
};

/// Evenly spread samples, and the tangent planes at them.
class SampleSurface {
 public:
  SampleSurface() = default;
  SampleSurface(OrientedPoints points, double spacing);
  /// Nothing within reach: false.
  bool closest(const Vec3& q, double reach, Foot& foot) const;
  const OrientedPoints& points() const { return points_; }

 private:
  OrientedPoints points_;
  double spacing_ = 0;
  KdTree tree_;
};

/// The surface itself: triangles with their borders, or all points.
class WholeSurface {
 public:
  /// Of points in coordinates of their own; `spacing` as SampleSurface.
  WholeSurface(const TriangleMesh& mesh, const OrientedPoints& points, double spacing);
  bool closest(const Vec3& q, double reach, Foot& foot) const;

 private:
  const TriangleMesh& mesh_;
  std::unique_ptr<ClosestTriangle> triangles_;
  std::vector<std::uint8_t> border_edge_;  ///< of each triangle, a bit for each of its edges ab, bc, ca
  std::vector<std::uint8_t> border_vertex_;
  std::unique_ptr<SampleSurface> points_;
};

/// One side, in coordinates of its own: divided by a length, about a place of the world.
struct AlignSide {
  Vec3 origin;             ///< in the world
  double unit = 1;         ///< length in the world of 1
  TriangleMesh mesh;       ///< finite vertices, with triangles where it has any
  OrientedPoints all;      ///< of clouds: every point that counts; estimated normals have any sign
  OrientedPoints dense;    ///< fewer, and estimated normals look to one side
  double area = 0;         ///< as far as samples tell
  bool has_sides = false;  ///< whether normals point to one side
  bool is_mesh = false;
  Vec3 centroid;
  double radius = 0;  ///< root mean square distance from it
};

/// `unit`: of both sides. `most`: of so many points of a cloud without normals these are estimated, and the others left
/// out. Throws DataError saying which side (`name`) cannot be aligned.
AlignSide prepare_side(const TriangleMesh& mesh, const Vec3& origin, double unit, std::size_t most, const char* name,
                       Progress& progress);

/// The origin and size by which a side is best placed.
void measure_side(const TriangleMesh& mesh, const char* name, Vec3& origin, double& size);

/// Even samples of a side, about `spacing` apart, with normals that are means over `blur` (lengths).
OrientedPoints even_samples(const AlignSide& side, double spacing, double blur);

}  // namespace sansmesh::inline v1::detail
