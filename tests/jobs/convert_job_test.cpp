// Tests of conversion: steps, reports, errors, and parts.
#include "sansmesh/convert.h"

#include <gtest/gtest.h>

#include "sansmesh/error.h"
#include "support/clouds.h"
#include "support/mesh_shapes.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

PointSet four_points() {
  PointSet points;
  points.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return points;
}

CloudOrMesh converted(const PointSet& points, std::vector<ConvertStep> steps) {
  Progress progress;
  return convert(points, {.steps = std::move(steps)}, progress).data;
}

Vec3 place_of(const CloudOrMesh& data, std::size_t i) { return data.points.origin + Vec3(data.points.positions[i]); }

void expect_near(const Vec3& a, const Vec3& b) { EXPECT_LT(norm(a - b), 1e-6) << a.x << " " << a.y << " " << a.z; }

std::string refusal(const PointSet& points, ConvertStep step) {
  try {
    converted(points, {std::move(step)});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(ConvertJob, StepsFollowEachOther) {
  const PointSet points = four_points();
  const CloudOrMesh turned = converted(
      points,
      {TranslateStep{.by = {1, 0, 0}}, RotateStep{.axis = {0, 0, 1}, .degrees = 90}, ScaleStep{.factors = {2, 2, 2}}});
  expect_near(place_of(turned, 0), {0, 2, 0});
  const CloudOrMesh about = converted(points, {RotateStep{.degrees = 180, .about = Vec3{1, 0, 0}}});
  expect_near(place_of(about, 0), {2, 0, 0});
  const CloudOrMesh middle = converted(points, {ScaleStep{.factors = {3, 3, 3}, .about_center = true}});
  expect_near(place_of(middle, 0), {-1, -1, -1});
  expect_near(place_of(converted(points, {AxesStep{.axes = "y, x,-z"}}), 3), {0, 0, -1});
  expect_near(place_of(converted(points, {UpStep{}}), 2), {0, 0, 1});
  expect_near(place_of(converted(points, {UpStep{}, UpStep{.to = StepUp::y}}), 2), {0, 1, 0});
  expect_near(place_of(converted(points, {UnitStep{.from = "in", .to = "mm"}}), 1), {25.4, 0, 0});
  const AffineMap map = AffineMap::rotation({1, 2, 3}, 40);
  expect_near(place_of(converted(points, {TransformStep{.map = map}, TransformStep{.map = map, .inverse = true}}), 3),
              {0, 0, 1});
}

TEST(ConvertJob, ReportsWhatStaysAfterEachStep) {
  Progress progress;
  const ConvertResult made = convert(
      four_points(), {.steps = {CropStep{.box = {{-1, -1, -1}, {2, 0.5, 2}}}, CountStep{2}, EveryStep{2}}}, progress);
  EXPECT_EQ(made.report.size, 4u);
  ASSERT_EQ(made.report.steps.size(), 3u);
  EXPECT_EQ(made.report.steps[0].step, "box");
  EXPECT_EQ(made.report.steps[0].size, 3u);
  EXPECT_EQ(made.report.steps[1].size, 2u);
  EXPECT_EQ(made.report.steps[2].size, 1u);
  EXPECT_FALSE(made.report.steps[2].triangles);
  EXPECT_EQ(step_name(CropStep{.inside = false}), "outside_box");
  EXPECT_EQ(step_name(FlipStep{.normals = false}), "flip_faces");
}

TEST(ConvertJob, AMeshStaysOneUnlessItsPointsAreAskedFor) {
  Progress progress;
  const ConvertResult mesh = convert(ball_mesh(2), {.steps = {WeldStep{}}}, progress);
  EXPECT_TRUE(mesh.data.is_mesh);
  EXPECT_EQ(mesh.report.steps[0].triangles, mesh.report.triangles);
  EXPECT_FALSE(convert(ball_mesh(2), {.vertices_only = true}, progress).data.is_mesh);
  EXPECT_EQ(refusal(ball_mesh(2), SpacingStep{0.1}).rfind("`point_spacing` is for points", 0), 0u);
}

TEST(ConvertJob, AttributesOfThreeNumbersAreToldOfWhereTheyMayBeDirections) {
  Progress progress;
  PointSet points = four_points();
  points.attributes.set("flow", std::vector<float>(12), 3);
  EXPECT_TRUE(has_note(convert(points, {.steps = {UpStep{}}}, progress).notes, "unturned"));
  EXPECT_TRUE(convert(points, {.steps = {TranslateStep{.by = {1, 2, 3}}}}, progress).notes.empty());
}

TEST(ConvertJob, RefusalsNameTheStep) {
  const PointSet points = four_points();
  EXPECT_EQ(refusal(points, CropStep{.box = {{5, 5, 5}, {6, 6, 6}}}).rfind("`box` leaves nothing of 4 points", 0), 0u);
  EXPECT_EQ(refusal(points, FlipStep{.normals = false}).rfind("`flip_faces` is for meshes", 0), 0u);
  EXPECT_NE(refusal(points, ChooseStep{.names = {"foo"}}).find("'foo'"), std::string::npos);
  const std::vector<ConvertStep> bad = {SpacingStep{0},
                                        CountStep{0},
                                        EveryStep{0},
                                        WeldStep{-1},
                                        AxesStep{"x,x,y"},
                                        AxesStep{"x,y"},
                                        UnitStep{"furlong", "m"},
                                        ScaleStep{.factors = {1, 0, 1}},
                                        RotateStep{.axis = {0, 0, 0}},
                                        CropStep{.box = {{1, 0, 0}, {0, 1, 1}}},
                                        TranslateStep{.by = {std::nan(""), 0, 0}},
                                        TransformStep{.map = AffineMap::scaling({1, 1, 0}), .inverse = true}};
  for (const ConvertStep& step : bad) EXPECT_THROW(validate_step(step), ArgumentError) << step_name(step);
}

TEST(SplitJob, PartsOfAMeshComeLargestFirst) {
  Progress progress;
  CloudOrMesh both{PointSet{}};
  both.is_mesh = true;
  both.mesh = joined(octasphere(1), octasphere(2), {5, 0, 0});
  const SplitResult made = split(both, {}, progress);
  ASSERT_EQ(made.parts.size(), 2u);
  EXPECT_EQ(made.parts[0].mesh.triangles.size(), octasphere(2).triangles.size());
  EXPECT_TRUE(made.notes.empty());
  const SplitResult large = split(both, {.min_size = 100}, progress);
  EXPECT_EQ(large.parts.size(), 1u);
  EXPECT_EQ(large.found, 2u);
  EXPECT_TRUE(has_note(large.notes, "small_parts"));
  EXPECT_THROW(split(both, {.min_size = 1000}, progress), DataError);
  EXPECT_THROW(split(both, {.most_parts = 1}, progress), DataError);
  EXPECT_THROW(split(both, {.split_distance = -1}, progress), ArgumentError);
}

TEST(SplitJob, PartsOfACloudAreFarFromEachOther) {
  Progress progress;
  const CloudOrMesh cloud(joined(sphere(500), sphere(300), 1, {5, 0, 0}));
  const SplitResult made = split(cloud, {}, progress);
  ASSERT_EQ(made.parts.size(), 2u);
  EXPECT_EQ(made.parts[0].size(), 500u);
  ASSERT_TRUE(made.distance);
  EXPECT_EQ(split(cloud, {.split_distance = 10}, progress).parts.size(), 1u);
}

}  // namespace
}  // namespace sansmesh::test
