// Meshes as parts of solids: exact faces, exact creases, rounded offsets, and warnings about meshes that are no solid.
#include "sansmesh/function/mesh_solid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/error.h"
#include "sansmesh/function/mesh_field.h"
#include "sansmesh/measure/mesh_signed_distance.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "support/edged_shapes.h"
#include "support/mesh_checks.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

Solid solid_of(const TriangleMesh& mesh, bool rounded = false) {
  std::vector<std::string> warnings;
  Solid solid = mesh_solid(mesh, rounded, warnings);
  EXPECT_TRUE(warnings.empty());
  return solid;
}

struct Cut {
  TriangleMesh mesh;
  CsgMeshReport report;
};

Cut meshed(const Solid& solid, int resolution) {
  Cut m;
  Progress progress;
  m.mesh = mesh_csg(solid, {.resolution = resolution}, progress, &m.report);
  EXPECT_TRUE(test::topology_of(m.mesh).closed_manifold());
  return m;
}

/// Largest difference of the distances of a mesh's vertices from a surface and `expected`.
double off(const TriangleMesh& mesh, const TriangleMesh& surface, double expected) {
  const MeshDistance exact(surface);
  double most = 0;
  for (const Vec3f& v : mesh.vertices) {
    const Vec3 x = mesh.origin + Vec3(v);
    MeasuredPoint found;
    exact.measure({&x, 1}, 100, {&found, 1});
    most = std::max(most, std::abs(found.distance - expected));
  }
  return most;
}

TEST(MeshSolid, FlatFacesComeBackExactly) {
  const TriangleMesh cube = test::cube_of_faces();
  const Cut again = meshed(solid_of(cube), 40);
  EXPECT_NEAR(again.report.volume, 8, 1e-4);
  EXPECT_NEAR(again.report.area, 24, 1e-4);
  EXPECT_LT(again.mesh.triangles.size(), 200u);
  for (const TriangleMesh& shape : {test::icosahedron(), test::swept_profile()}) {
    const Cut m = meshed(solid_of(shape), 40);
    EXPECT_LT(off(m.mesh, shape, 0), 1e-5);
    // The converse: its corners are present.
    EXPECT_LT(off(shape, m.mesh, 0), 1e-5);
  }
}

TEST(MeshSolid, CombinesWithPrimitives) {
  const Solid cube = solid_of(test::cube_of_faces());
  EXPECT_NEAR(meshed(csg::subtract(cube, csg::cylinder({}, {0, 0, 1}, 0.5)), 40).report.volume,
              8 - std::numbers::pi / 2, 1e-3);
  EXPECT_NEAR(meshed(csg::unite(cube, csg::sphere({1, 0, 0}, 0.5)), 40).report.volume, 8 + std::numbers::pi / 12, 1e-3);
  const Cut moved = meshed(csg::rotate(csg::intersect(cube, csg::half_space({1, 1, 1}, 0)), {1, 2, 0}, 30), 40);
  EXPECT_NEAR(moved.report.volume, 4, 1e-4);
}

TEST(MeshSolid, OffsetsAreRoundedOutsideAndSharpInside) {
  const TriangleMesh cube = test::cube_of_faces();
  const double d = 0.3;
  const Cut grown = meshed(csg::offset(solid_of(cube, true), d), 24);
  EXPECT_NEAR(grown.report.volume, 8 + 24 * d + 6 * std::numbers::pi * d * d + 4 * std::numbers::pi / 3 * d * d * d,
              5e-3);
  EXPECT_LT(off(grown.mesh, cube, d), 0.05 * grown.report.cell);
  const Cut shrunk = meshed(csg::offset(solid_of(cube, true), -d), 24);
  EXPECT_NEAR(shrunk.report.volume, std::pow(2 - 2 * d, 3), 1e-4);
  const Cut wall = meshed(csg::shell(solid_of(cube, true), 0.2, csg::ShellSide::inside), 24);
  EXPECT_NEAR(wall.report.volume, 8 - std::pow(1.6, 3), 1e-4);
  const TriangleMesh notched = test::swept_profile();
  for (const double by : {0.1, -0.1})
    EXPECT_LT(off(meshed(csg::offset(solid_of(notched, true), by), 40).mesh, notched, by), 2e-3) << by;
}

TEST(MeshSolid, ValuesAreTheDistanceWithItsGradient) {
  const TriangleMesh ball = test::octasphere(4);
  const MeshField field(ball, {.rounded = true});
  for (const Vec3& x : {Vec3{0.3, 0.2, 0.1}, Vec3{1.5, -0.4, 0.2}, Vec3{0, 0, -1.01}, Vec3{-0.9, 0.1, 0.05}}) {
    double value = 0;
    Vec3 gradient;
    field.evaluate({&x, 1}, {&value, 1}, {&gradient, 1});
    EXPECT_NEAR(value, norm(x) - 1, 5e-3);
    EXPECT_GT(dot(gradient, normalized(x)), 0.99);
    EXPECT_NEAR(norm(gradient), 1, 1e-12);
  }
}

std::string refusal(const TriangleMesh& mesh) {
  std::vector<std::string> warnings;
  try {
    mesh_solid(mesh, false, warnings);
  } catch (const DataError& e) {
    return e.what();
  }
  return {};
}

TEST(MeshSolid, SaysWhatIsNoSolid) {
  TriangleMesh open = test::cube_of_faces();
  open.triangles.resize(10);
  EXPECT_NE(refusal(open).find("edges are open"), std::string::npos);
  TriangleMesh doubled = test::cube_of_faces();
  doubled.triangles.insert(doubled.triangles.end(), doubled.triangles.begin(), doubled.triangles.begin() + 6);
  EXPECT_NE(refusal(doubled).find("three faces or more"), std::string::npos);
  const TriangleMesh ball = test::octasphere(3);
  EXPECT_NE(refusal(test::joined(ball, ball, {0.7f, 0, 0})).find("inside of others"), std::string::npos);
  EXPECT_EQ(refusal(test::joined(ball, ball, {3, 0, 0})), "");
}

TEST(MeshSolid, SaysThatFacesCross) {
  // The tips of two bodies of one mesh intersect.
  const TriangleMesh ball = test::octasphere(5);
  std::vector<std::string> warnings;
  mesh_solid(test::joined(ball, ball, {1.98f, 0.013f, 0.007f}), false, warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("faces intersect"), std::string::npos) << warnings[0];
}

TEST(MeshSolid, SaysThatPartsAreSmallerThanCells) {
  Cut m;
  std::vector<std::string> warnings;
  Progress progress;
  TriangleMesh speck = test::octasphere(2);
  for (Vec3f& v : speck.vertices) v = v * 0.07f;
  const TriangleMesh both = test::joined(test::octasphere(3), speck, {1.5f, 0, 0});
  m.mesh = mesh_csg(mesh_solid(both, false, warnings), {.cell = 0.08}, progress, &m.report);
  EXPECT_EQ(m.report.components, 2u);
  ASSERT_EQ(m.report.notes.size(), 1u);
  EXPECT_NE(m.report.notes[0].text.find("1 of 2 components is less than 6 cells across"), std::string::npos)
      << m.report.notes[0].text;
}

TEST(MeshSolid, ClosesHolesAndTurnsOver) {
  TriangleMesh ball = test::octasphere(5);
  ball.triangles.erase(ball.triangles.begin() + 100, ball.triangles.begin() + 102);
  for (Triangle& t : ball.triangles) std::swap(t[0], t[1]);
  std::vector<std::string> warnings;
  const Solid solid = mesh_solid(ball, false, warnings);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("1 hole"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("reversed"), std::string::npos) << warnings[1];
  EXPECT_NEAR(meshed(solid, 30).report.volume / (4 * std::numbers::pi / 3), 1, 5e-3);
}

}  // namespace
}  // namespace sansmesh::inline v1
