// Tests of jobs on clouds: choices and reports. The accuracy of normals and curvatures is tested in tests/points and
// tests/surface.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/points.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/surface/curvature_colors.h"
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
  const NormalsResult turned = normals(cloud, {.orient_only = true}, progress);
  EXPECT_FALSE(turned.report.neighbours);
  EXPECT_TRUE(turned.report.check.oriented);
  for (std::size_t i = 0; i < given.size(); ++i)
    EXPECT_NEAR(std::abs(dot(Vec3(turned.points.normals[i]), Vec3(given.normals[i]))), 1, 1e-6);
  const NormalsResult left = normals(cloud, {.orient_only = true, .orient = false}, progress);
  EXPECT_EQ(left.points.normals, given.normals);
  EXPECT_FALSE(left.report.check.oriented);
  EXPECT_FALSE(left.report.oriented_by);
}

TEST(NormalsJob, RefusesWhatCannotBe) {
  Progress progress;
  PointSet bare = sphere(100), few;
  bare.normals.clear();
  few.positions.assign(50, Vec3f{1, 2, 3});
  EXPECT_THROW(normals(bare, {.orient_only = true}, progress), DataError);
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
  const CurvatureResult gauss = curvature(cloud, {.color_by = CurvatureQuantity::gaussian}, progress);
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

TEST(ProjectJob, ChoosesWhatSuitsTheSamples) {
  Progress progress;
  const PointSet noisy = sphere(3000, 0.02);
  const ProjectResult recommended = project({.points = noisy}, {}, progress);
  EXPECT_EQ(recommended.report.method, "partition");
  EXPECT_GT(recommended.report.moved.mean_move, 0);
  ProjectOptions options;
  options.surface.smoothing = 3;
  EXPECT_EQ(project({.points = noisy}, options, progress).report.method, "curvature");
  options.method = "apss";
  options.point_count = 400;
  const ProjectResult spread = project({.points = noisy}, options, progress);
  EXPECT_EQ(spread.report.method, "apss");
  EXPECT_NEAR(static_cast<double>(spread.points.size()), 400, 60);
  EXPECT_EQ(project({.points = noisy}, {.method = "lop", .point_count = 500}, progress).points.size(), 500u);
}

TEST(ProjectJob, NamesWhoseFaultItIs) {
  Progress progress;
  PointSet far = sphere(20);
  for (Vec3f& p : far.positions) p *= 9.0f;
  const auto error = [&](ProjectInput input, const ProjectOptions& options) -> std::string {
    try {
      project(std::move(input), options, progress);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(
      error({.points = far, .name = "far.ply", .onto = sphere(1000), .onto_name = "ball.ply"}, {.method = "apss"}),
      "far.ply: no point is near enough to the surface of ball.ply");
  EXPECT_EQ(
      error({.points = far, .name = "far.ply", .onto = sphere(4), .onto_name = "few.ply"}, {}).rfind("few.ply: ", 0),
      0u);
  EXPECT_EQ(error({.points = {}, .name = "none.ply"}, {.method = "lop"}).rfind("none.ply: ", 0), 0u);
}

TEST(ProjectJob, RefusesWhatMeansNothing) {
  Progress progress;
  const PointSet ball = sphere(500);
  const auto refuses = [&](const ProjectOptions& options, std::optional<PointSet> onto = {}) {
    EXPECT_THROW(project({.points = ball, .onto = std::move(onto)}, options, progress), ArgumentError)
        << options.method;
  };
  refuses({.method = "magic"});
  refuses({.point_count = 0});
  refuses({.steps = {.most_steps = 0}});
  refuses({.lop = {.radius = 1}});
  refuses({.method = "apss", .lop = {.repulsion = 0.2}});
  refuses({.method = "lop", .lop = {.repulsion = 0.5}});
  refuses({.method = "lop", .steps = {.most_steps = 3}});
  refuses({.method = "lop", .cloud = {.remove_outliers = true}});
  refuses({.method = "lop"}, sphere(100));
  ProjectOptions sharp{.method = "lop"};
  sharp.surface.sharp = SharpFormula::bilateral;
  refuses(sharp);
}

TEST(InfoJob, TellsOfACloudAndItsArrays) {
  Progress progress;
  PointSet cloud = sphere(1000);
  cloud.origin = {100, 200, 300};
  cloud.positions.push_back(cloud.positions[0]);
  cloud.normals.push_back(cloud.normals[0]);
  cloud.attributes.set("pair", std::vector<float>(2002, 1.0f), 2);
  std::vector<std::uint8_t> classes(1001, 2);
  classes[7] = 6;
  cloud.attributes.set("classification", classes);
  const CloudInfo made = info(cloud, progress);
  EXPECT_EQ(made.points, 1001u);
  EXPECT_EQ(made.duplicates, 1u);
  EXPECT_EQ(made.spans, "a volume");
  EXPECT_NEAR(made.box.lower.y, 199, 0.1);
  EXPECT_TRUE(made.normals.oriented);
  ASSERT_EQ(made.attributes.size(), 2u);
  EXPECT_EQ(made.attributes[0].ranges.size(), 2u);
  EXPECT_EQ(made.attributes[1].ranges[0], std::pair(2.0, 6.0));
  ASSERT_TRUE(made.classes);
  EXPECT_EQ((*made.classes)[2], 1000u);
  EXPECT_FALSE(made.mesh);
}

TEST(InfoJob, TellsHowAMeshHangsTogether) {
  Progress progress;
  const PointSet ball = ball_mesh(3);
  const CloudInfo made = info(ball, progress);
  EXPECT_EQ(made.triangles, ball.triangles.size());
  ASSERT_TRUE(made.mesh);
  EXPECT_TRUE(made.mesh->closed());
}

}  // namespace
}  // namespace sansmesh::test
