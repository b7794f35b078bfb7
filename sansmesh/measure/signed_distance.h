// How far a point lies from a surface, and on which side: of a mesh, of points, of a function.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/core/box.h"
#include "sansmesh/core/vec.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/field/scalar_field.h"
#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {

struct MeasuredPoint {
  /// Positive outside; NaN where the surface is farther than asked or could not be found.
  double distance = std::numeric_limits<double>::quiet_NaN();
  Vec3 point;           ///< closest of the surface, or nearly so; world coordinates
  bool border = false;  ///< the closest point lies on the border of an open mesh: the surface ends there
  bool lost = false;    ///< no surface was found though nothing says that it is far
};

/// A surface to measure from. Coordinates are those of the world.
class SignedDistance {
 public:
  virtual ~SignedDistance() = default;

  /// Of the surface.
  virtual Box3 bounds() const = 0;
  /// false: all distances are positive, since nothing tells the sides apart.
  virtual bool has_sides() const { return true; }
  /// Distances at all of x, one call per batch; neighbours in neighbouring slots go fastest. Sizes must agree. What
  /// lies farther than `farthest` may be NaN. Points that are not finite are. Safe from several threads: whoever has
  /// many points cuts them into batches and asks in a loop, since this, unlike a field, has none.
  virtual void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const = 0;
};

/// Exact distance to the triangles, the sign from the pseudo-normal of what the closest point lies on: the face, the
/// edge (sum of its faces' unit normals) or the vertex (sum weighted by their angles there), which is right for every
/// closed mesh (Bærentzen and Aanæs 2005). Vertices at the same place are one. At the border of an open mesh it is the
/// side of the faces that end there. Triangles without area have no normal: that of their neighbours stands in.
class MeshDistance : public SignedDistance {
 public:
  /// Keeps a reference to the mesh. Throws DataError if there is no triangle with finite corners.
  explicit MeshDistance(const TriangleMesh& mesh);

  Box3 bounds() const override { return bounds_; }
  void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const override;

  /// Of what `part` of a triangle stands for; zero where it cancels out. `border` becomes true if a face ends there.
  Vec3 pseudo_normal(std::uint32_t triangle, TrianglePart part, bool& border) const;

 private:
  std::span<const std::uint32_t> triangles_at(std::uint32_t corner) const;
  Vec3 position(std::uint32_t corner) const { return Vec3(mesh_.vertices[corner]); }
  Triangle corners(std::uint32_t triangle) const;
  Vec3 face_normal(std::uint32_t triangle) const;
  Vec3 normals_across(std::uint32_t triangle, std::uint32_t a, std::uint32_t b) const;
  Vec3 edge_normal(std::uint32_t a, std::uint32_t b, bool& border) const;
  Vec3 vertex_normal(std::uint32_t corner, bool& border) const;

  const TriangleMesh& mesh_;
  ClosestTriangle closest_;
  Box3 bounds_;
  std::vector<std::uint32_t> same_;   ///< of each vertex: the first one at its place
  std::vector<std::uint32_t> first_;  ///< of each vertex: where its triangles begin in triangles_
  std::vector<std::uint32_t> triangles_;
};

/// Distance to discs at the samples, across their normals, that reach as far as their eighth neighbour: near the
/// samples the distance to the surface that they stand for, not to the single sample; farther off that to the rim. Sign
/// and disc are those of the nearest sample. Without normals: the distance to the nearest sample, without a sign.
class PointsDistance : public SignedDistance {
 public:
  /// Keeps a reference to the points (a mesh whose triangles are not looked at). Throws DataError if none is finite.
  explicit PointsDistance(const TriangleMesh& points);

  Box3 bounds() const override { return bounds_; }
  bool has_sides() const override { return !points_.normals.empty(); }
  void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const override;

 private:
  const TriangleMesh& points_;
  KdTree tree_;
  Box3 bounds_;
  std::vector<float> radius_;  ///< of each disc
};

/// Distance to the zero set of a function, negative inside, that need not be a distance itself: Newton steps along the
/// gradient onto the zero set, halving between its two sides where they do not shrink, then steps within its tangent
/// planes until the line to the point is normal to it. So the foot is a point of the zero set, to 1e-9 of the box's
/// diagonal or as well as the function's noise allows if that is below 1e-6 of it, and closest among its neighbours,
/// though another part may be closer still. The sign is the function's. NaN are points whose steps lead farther than
/// `farthest`, and lost those whose steps lead out of the domain or nowhere.
class FieldDistance : public SignedDistance {
 public:
  /// Keeps a reference to the field.
  explicit FieldDistance(const ScalarField& field) : field_(field) {}

  Box3 bounds() const override { return field_.bounds(); }
  void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const override;

 private:
  const ScalarField& field_;
};

/// The distance to a mesh, or to points if it has no triangles. Keeps a reference to it.
std::unique_ptr<SignedDistance> signed_distance(const TriangleMesh& surface);

}  // namespace sansmesh
