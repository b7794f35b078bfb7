// Jobs around a cloud: what is chosen and told. How good normals and curvatures are is told by tests/points and
// tests/surface.
#include <gtest/gtest.h>

#include <cmath>

#include "sansmesh/core/error.h"
#include "sansmesh/jobs/curvature.h"
#include "sansmesh/jobs/normals.h"
#include "support/clouds.h"
#include "support/mesh_shapes.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

TEST(NormalsJob, EstimatesOrientsAndChecks) {
  Progress progress;
  PointSet cloud = sphere(3000);
  cloud.normals.clear();
  const NormalsResult made = normals(cloud, {}, progress);
  EXPECT_TRUE(made.report.check.oriented);
  EXPECT_EQ(made.report.check.words, "oriented outward");
  EXPECT_EQ(made.report.oriented_by, OrientBy::propagation);
  ASSERT_TRUE(made.report.neighbours);
  EXPECT_EQ(made.report.neighbours, choose_neighbours(made.report.spacing, made.report.noise.deviation));
  EXPECT_EQ(made.report.unknown, 0u);
}

TEST(NormalsJob, KeepsWhatItIsToldToKeep) {
  Progress progress;
  PointSet cloud = sphere(3000);
  for (std::size_t i = 0; i < cloud.size(); i += 2) cloud.normals[i] = Vec3f{} - cloud.normals[i];
  const PointSet given = cloud;
  const NormalsResult turned = normals(cloud, {.keep = true}, progress);
  EXPECT_FALSE(turned.report.neighbours);
  EXPECT_TRUE(turned.report.check.oriented);
  for (std::size_t i = 0; i < given.size(); ++i)
    EXPECT_NEAR(std::abs(dot(Vec3(turned.points.normals[i]), Vec3(given.normals[i]))), 1, 1e-6);
  const NormalsResult left = normals(cloud, {.keep = true, .orient = false}, progress);
  EXPECT_EQ(left.points.normals, given.normals);
  EXPECT_FALSE(left.report.check.oriented);
  EXPECT_FALSE(left.report.oriented_by);
}

TEST(NormalsJob, RefusesWhatCannotBe) {
  Progress progress;
  PointSet bare = sphere(100), few;
  bare.normals.clear();
  few.positions.assign(50, Vec3f{1, 2, 3});
  EXPECT_THROW(normals(bare, {.keep = true}, progress), DataError);
  EXPECT_THROW(normals(few, {}, progress), DataError);
  EXPECT_THROW(normals(bare, {.orient_by = OrientBy::scanner}, progress), DataError);
  EXPECT_THROW(normals(bare, {.orient = false, .orient_by = OrientBy::up}, progress), ArgumentError);
  EXPECT_THROW(normals(bare, {.estimation = {.neighbours = 3}}, progress), ArgumentError);
}

TEST(CurvatureJob, LengthsAreThoseOfTheInput) {
  Progress progress;
  PointSet cloud = sphere(4000);
  for (Vec3f& p : cloud.positions) p = p * 5.0f;
  const CurvatureResult made = curvature(cloud, {.color_range = 0.3}, progress);
  EXPECT_FALSE(made.report.mesh);
  EXPECT_NEAR(made.report.median, 0.2, 0.01);
  EXPECT_EQ(made.report.color_range, 0.3);
  EXPECT_FALSE(made.report.beyond_range);
  EXPECT_NE(made.points.attributes.find("d2z"), nullptr);
  EXPECT_EQ(made.points.colors.size(), cloud.size());
  const CurvatureResult gauss = curvature(cloud, {.color_by = CurvatureColorOptions::Quantity::gaussian}, progress);
  EXPECT_NEAR(gauss.report.median, 0.04, 0.004);
}

TEST(CurvatureJob, OfAMeshEveryVertexKeepsItsPlace) {
  Progress progress;
  const PointSet ball = ball_mesh(4);
  const CurvatureResult made = curvature(ball, {}, progress);
  EXPECT_TRUE(made.report.mesh);
  EXPECT_EQ(made.points.positions, ball.positions);
  EXPECT_EQ(made.points.triangles, ball.triangles);
  EXPECT_THROW(curvature(ball, {.color_range = 0}, progress), ArgumentError);
  EXPECT_THROW(curvature(ball, {.estimation = {.tau = 9}}, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::test
