// Tests of jobs on functions: reports. Values, edits and diagnoses are tested in tests/field and tests/function.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "sansmesh/error.h"
#include "sansmesh/functions.h"
#include "sansmesh/jobs/meshes/solid_parts.h"
#include "sansmesh/pictures.h"
#include "sansmesh/points.h"
#include "sansmesh/solids.h"
#include "support/clouds.h"
#include "support/mesh_shapes.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

/// A sphere of radius 2 in the input.
const SurfaceFunction& ball_function() {
  static const SurfaceFunction function = [] {
    Progress progress;
    PointSet points = sphere(3000);
    for (Vec3f& p : points.positions) p *= 2.0f;
    return fit_function(std::move(points), {}, progress).function;
  }();
  return function;
}

template <class Error>
std::string words_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing thrown";
}

Edit constant_everywhere() { return {.select = {}, .action = SetConstant{}}; }

TEST(EvaluateJob, IsInTheUnitOfTheInput) {
  Progress progress;
  const std::vector<Vec3> points{{2.02, 0, 0}, {0, -2, 0}, {0, 0, 1.9}};
  const ProbeFunctionResult made = probe_function(ball_function(), points, progress);
  ASSERT_EQ(made.values.size(), 3u);
  EXPECT_NEAR(made.values[0].value, 0.02, 0.004);
  EXPECT_NEAR(made.values[1].k1, 0.5, 0.05);
  EXPECT_NEAR(made.values[2].value, -0.1, 0.02);
  EXPECT_EQ(made.report.largest, std::abs(made.values[2].value));
  EXPECT_GE(made.report.inside, 1u);
  EXPECT_NEAR(made.report.largest_gradient, 1, 0.2);
  AttributeTable attributes;
  made.add_to(attributes);
  ASSERT_NE(attributes.find("k2"), nullptr);
  EXPECT_EQ(attributes.find("value")->number(2), static_cast<float>(made.values[2].value));
  EXPECT_TRUE(probe_function(ball_function(), {}, progress).values.empty());
}

TEST(EditJob, BringsAMeshUpToDate) {
  Progress progress;
  const TriangleMesh before = mesh_of_function(ball_function(), {}, progress).mesh;
  Edit flat;
  flat.select.ball = EditSelection::Ball{{0, 0, 2}, 0.4};
  flat.action = SetDegree{1};
  const EditedFunction made = edit({.function = ball_function(), .mesh = before}, {flat}, true, progress);
  ASSERT_EQ(made.steps.size(), 1u);
  EXPECT_GT(made.steps[0].chosen, 0u);
  EXPECT_TRUE(made.update.local) << made.update.why;
  EXPECT_LT(made.update.added, before.triangles.size() / 2);
  EXPECT_TRUE(edit({.function = ball_function()}, {flat}, false, progress).mesh.triangles.empty());
}

TEST(EditJob, NamesTheStepAndWhatIsNotOfTheFunction) {
  Progress progress;
  const auto edited = [&](const std::vector<Edit>& edits, std::optional<TriangleMesh> mesh = {}) {
    edit({.function = ball_function(), .name = "ball.smf", .mesh = std::move(mesh), .mesh_name = "ball.ply"}, edits,
         true, progress);
  };
  const Edit all{.select = {}, .action = SetDegree{1}}, none{.select = {}, .action = RemoveSupports{}};
  EXPECT_EQ(words_of<DataError>([&] { edited({all, none}); }).rfind("ball.smf: step 2: ", 0), 0u);
  EXPECT_EQ(words_of<DataError>([&] { edited({constant_everywhere()}); }).rfind("ball.smf: after the edits: ", 0), 0u);
  EXPECT_EQ(words_of<ArgumentError>([&] { edited({{.select = {}, .action = SetDegree{9}}}); }).rfind("step 1: ", 0),
            0u);
  EXPECT_EQ(words_of<DataError>([&] { edited({}, octasphere(4)); }).rfind("ball.ply: is not a mesh of ball.smf", 0),
            0u);
  EXPECT_EQ(words_of<DataError>([&] { edited({}, TriangleMesh{}); }), "ball.ply: has no triangles");
}

TEST(DiagnoseJob, ListsPlacesByKindWithTheirEdits) {
  Progress progress;
  const PointSet scan = joined(sphere(5000), sphere(60), 0.09f, {1.5f, 0.2f, 0});
  const DiagnoseResult made = diagnose(fit_function(scan, {}, progress).function, {}, progress);
  ASSERT_FALSE(made.regions.empty());
  std::size_t steps = 0;
  for (std::size_t i = 0; i < made.regions.size(); ++i) {
    const ListedRegion& p = made.regions[i];
    EXPECT_EQ(p.number, i + 1);
    EXPECT_LE(made.regions[i - (i > 0 ? 1 : 0)].region.kind, p.region.kind);
    EXPECT_FALSE(p.worst_words().empty());
    steps += p.step.has_value();
  }
  EXPECT_EQ(steps, made.edits.size());
  RenderOptions look;
  look.view.width = 80, look.view.height = 60, look.quality.samples = 1;
  const std::vector<Image> each = draw_regions(made, look, false, progress);
  ASSERT_EQ(each.size(), made.regions.size());
  EXPECT_EQ(each[0].width, 80);
  EXPECT_EQ(draw_regions(made, look, true, progress).size(), 1u);
  EXPECT_TRUE(draw_regions({}, look, true, progress).empty());
  DiagnoseResult many = made;
  many.regions.resize(1601);
  EXPECT_NE(words_of<ArgumentError>([&] { draw_regions(many, look, true, progress); }).find("`places`"),
            std::string::npos);
}

TEST(DiagnoseJob, RefusesWhatIsOutOfRange) {
  Progress progress;
  EXPECT_THROW(diagnose(ball_function(), {.coverage_below = 2}, progress), ArgumentError);
  EXPECT_THROW(diagnose(ball_function(), {.error_above = 0}, progress), ArgumentError);
  EXPECT_THROW(diagnose(ball_function(), {.gradient_above = 1}, progress), ArgumentError);
}

TEST(InfoJob, TellsOfAFunction) {
  const FunctionInfo made = info(ball_function());
  EXPECT_GT(made.fits, 0u);
  EXPECT_EQ(made.samples, ball_function().samples());
  EXPECT_EQ(made.open_share, 0);
  EXPECT_LT(made.cube.lower.x, -2);
  EXPECT_GT(made.cube.upper.z, 2);
  EXPECT_NEAR(made.spacing, std::sqrt(16 * std::numbers::pi / 3000), 0.03);
}

SolidModel solid_of(const std::string& expression) {
  Progress progress;
  return read_solid(expression, progress);
}

TEST(CsgJob, KeepsAllPartsOfSolidsWithoutFunctions) {
  Progress progress;
  const SolidModel two = solid_of("sphere(1) | sphere(0.1, center=(2,0,0))");
  const CsgResult made = mesh_of_solid(two, {.resolution = 48}, progress);
  EXPECT_EQ(made.report.components, 2u);
  EXPECT_TRUE(made.report.closed);
  EXPECT_TRUE(made.notes.empty());
  EXPECT_EQ(mesh_of_solid(two, {.resolution = 48, .components = ComponentChoice{}}, progress).report.components, 1u);
  SolidParts parts = two.parts();
  parts.functions.emplace("ball.smf", ball_function());
  const SolidModel with_function(parts);
  EXPECT_EQ(mesh_of_solid(with_function, {.resolution = 48}, progress).report.components, 1u);
}

TEST(CsgJob, NotesWhatTheMeshMayHaveLost) {
  Progress progress;
  const CsgResult made = mesh_of_solid(solid_of("box(2) - sphere(0.02)"), {.cell = 0.1}, progress);
  EXPECT_TRUE(has_note(made.notes, "too_thin"));
}

TEST(CsgJob, RefusesWhatIsOutOfRange) {
  Progress progress;
  const SolidModel ball = solid_of("sphere(1)");
  EXPECT_THROW(mesh_of_solid(ball, {.cell = 0.1, .resolution = 8}, progress), ArgumentError);
  EXPECT_THROW(mesh_of_solid(ball, {.triangles = 3}, progress), ArgumentError);
  EXPECT_THROW(mesh_of_solid(ball, {.triangles = 100, .simplify = 0}, progress), ArgumentError);
  EXPECT_THROW(mesh_of_solid(solid_of("plane(z)"), {}, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::test
