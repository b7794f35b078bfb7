#include "sansmesh/local_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sansmesh/error.h"
#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

const AffineMap kGeneral{{1, 0.5, -0.25}, {0.25, 2, 0.5}, {-0.5, 0.125, -3}, {10, -20, 30}};

/// Oblique triangle with a different normal at each corner.
TriangleMesh triangle() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0.5f}, {0.25f, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const Vec3f n = normalized(cross(mesh.vertices[1], mesh.vertices[2]));
  mesh.normals = {n, n, Vec3f{}};
  return mesh;
}

Vec3 face_normal(const TriangleMesh& m) {
  const Triangle& t = m.triangles[0];
  const Vec3 a(m.vertices[t[0]]), b(m.vertices[t[1]]), c(m.vertices[t[2]]);
  return normalized(cross(b - a, c - a));
}

TEST(AffineMap, InverseAndProductUndoAndChain) {
  const Vec3 p{3, -7, 11};
  EXPECT_LT(norm(kGeneral.inverse()(kGeneral(p)) - p), 1e-12);
  const AffineMap turn = AffineMap::rotation({1, 2, 3}, 77);
  EXPECT_LT(norm(kGeneral.after(turn)(p) - kGeneral(turn(p))), 1e-12);
  const Vec3 center{5, 6, 7};
  EXPECT_LT(norm(turn.about(center)(center) - center), 1e-12);
}

TEST(AffineMap, RotatesCounterClockwiseAndByQuartersExactly) {
  EXPECT_EQ(AffineMap::rotation({0, 0, 1}, 90)(Vec3{1, 0, 0}), (Vec3{0, 1, 0}));
  EXPECT_EQ(AffineMap::rotation({0, 0, 2}, -450)(Vec3{1, 0, 0}), (Vec3{0, -1, 0}));
  EXPECT_NEAR(AffineMap::rotation({1, 0, 0}, 30)(Vec3{0, 1, 0}).z, 0.5, 1e-15);
  EXPECT_THROW(AffineMap::rotation({0, 0, 0}, 30), ArgumentError);
}

TEST(AffineMap, NormalsStayNormalToTheSurfaceAndFacesKeepTheirOutside) {
  for (const AffineMap& map : {kGeneral, AffineMap::scaling({1, 5, 0.125}), AffineMap::scaling({-1, 1, 1})}) {
    TriangleMesh mesh = triangle();
    transform(mesh, map);
    EXPECT_NEAR(norm(Vec3(mesh.normals[0])), 1, 1e-6);
    EXPECT_GT(dot(Vec3(mesh.normals[0]), face_normal(mesh)), 1 - 1e-6);
    EXPECT_EQ(mesh.normals[2], Vec3f{});  // unknown stays unknown
    // Orientation is preserved: a point in front of the face stays in front of it.
    const Vec3 outside = map(Vec3(triangle().vertices[0]) + face_normal(triangle()));
    EXPECT_GT(dot(outside - mesh.origin - Vec3(mesh.vertices[mesh.triangles[0][0]]), face_normal(mesh)), 0);
  }
}

TEST(AffineMap, ShiftsLoseNothingAndSurveysTurnAboutFarPoints) {
  PointSet points;
  points.origin = {512345.125, 4512345.5, 250};
  points.positions = {{0.1f, 0.2f, 0.3f}, {1e3f, -7, 5}};
  points.scanners = {{1, 2, 3}};
  PointSet moved = points;
  transform(moved, AffineMap::translation({1e6, 0.001, -250}));
  EXPECT_EQ(moved.positions, points.positions);
  EXPECT_EQ(moved.origin, points.origin + Vec3(1e6, 0.001, -250));
  // Rotation about 0 and back, at a distance of five million metres.
  const AffineMap turn = AffineMap::rotation({0, 0, 1}, 33);
  transform(moved = points, turn);
  transform(moved, turn.inverse());
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT(norm(moved.origin + Vec3(moved.positions[i]) - points.origin - Vec3(points.positions[i])), 2e-4);
  EXPECT_LT(norm(Vec3(moved.scanners[0] - points.scanners[0])), 1e-5);
}

TEST(AffineMap, RefusesWhatCannotBeUndone) {
  TriangleMesh mesh = triangle();
  const TriangleMesh before = mesh;
  EXPECT_THROW(transform(mesh, AffineMap::scaling({1, 1, 0})), ArgumentError);
  EXPECT_THROW(transform(mesh, AffineMap::scaling({1, std::nan(""), 1})), ArgumentError);
  EXPECT_THROW(transform(mesh, AffineMap::scaling({1e20, 1e20, 1e20})), ArgumentError);
  EXPECT_THROW(transform(mesh, AffineMap::scaling({1e-30, 1e-30, 1e-30})), ArgumentError);
  EXPECT_EQ(mesh.vertices, before.vertices);
  EXPECT_EQ(mesh.origin, before.origin);
}

}  // namespace
}  // namespace sansmesh::inline v1
