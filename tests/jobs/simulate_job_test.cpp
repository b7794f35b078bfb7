// Tests of simulations: choices for a body and a scene, and notes. The dynamics is tested in tests/dynamics.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sansmesh/dataset/tet_dataset.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/error.h"
#include "sansmesh/simulate.h"
#include "support/tet_shapes.h"

namespace sansmesh::test {
namespace {

TetMesh small_bar() { return test::box_of_tets({0, 0, 0}, {4, 1, 1}, 4, 1, 1); }

bool noted(const std::vector<Note>& notes, std::string_view code) {
  return std::any_of(notes.begin(), notes.end(), [&](const Note& n) { return n.code == code; });
}

TEST(SimulationPlan, BodiesThatNothingHoldsFallOntoAFloor) {
  const SimulationPlan plan = plan_simulation(small_bar(), {}, {});
  ASSERT_EQ(plan.scene.floors.size(), 1u);
  EXPECT_LT(plan.scene.floors[0].point.y, 0);
  EXPECT_EQ(plan.unit, 1);
  EXPECT_TRUE(plan.notes.empty());
  EXPECT_LT(plan_simulation(small_bar(), {}, {.z_up = true}).scene.floors[0].point.z, 0);
  SceneScript held;
  held.scene.fixed = {0, 5};
  EXPECT_TRUE(plan_simulation(small_bar(), held, {}).scene.floors.empty());
}

TEST(SimulationPlan, FramesFollowFromTwoOfTimeRateAndNumber) {
  const SimulationPlan usual = plan_simulation(small_bar(), {}, {});
  EXPECT_EQ(usual.frames, 51u);
  EXPECT_EQ(usual.frame_steps, 4u);
  const SimulationPlan by_time = plan_simulation(small_bar(), {}, {.duration = 0.4, .frames = 5});
  EXPECT_EQ(by_time.frames, 5u);
  EXPECT_NEAR(by_time.frame_time, 0.1, 1e-12);
  const SimulationPlan by_rate = plan_simulation(small_bar(), {}, {.fps = 10, .frames = 5});
  EXPECT_EQ(by_rate.frames, 5u);
  EXPECT_NEAR(by_rate.frame_time, 0.1, 1e-12);
  EXPECT_THROW(plan_simulation(small_bar(), {}, {.duration = 1, .fps = 2, .frames = 3}), ArgumentError);
}

TEST(SimulationPlan, TellsErrorsOfTheSceneFromThoseOfOptions) {
  SceneScript blink;
  blink.duration = 1e-3;
  EXPECT_THROW(plan_simulation(small_bar(), blink, {}), SceneError);
  try {
    plan_simulation(small_bar(), {}, {.duration = 1e-3});
    FAIL();
  } catch (const SceneError&) {
    FAIL() << "the option says it";
  } catch (const ArgumentError& error) {
    EXPECT_NE(std::string(error.what()).find("`duration`"), std::string::npos);
  }
  EXPECT_THROW(plan_simulation(small_bar(), {}, {.poisson = 0.7}), ArgumentError);
  const SimulationBody body{std::make_shared<const TetDataset>(TetDataset{small_bar(), {}, {}, {}}), "bar.msh"};
  blink.file = "blink.json";
  try {
    plan_simulation(body, blink, {});
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.file(), "blink.json");
  }
  EXPECT_EQ(plan_simulation(body, {}, {}).body_file, "bar.msh");
}

TEST(SimulationPlan, TakesMaterialsOfCellsAndSaysWhatItGuesses) {
  TetMesh body = small_bar();
  std::vector<double> density(body.tets.size(), 500), young(body.tets.size(), 1e4), poisson(body.tets.size(), 0.2);
  density[0] = 1500;
  body.tet_attributes.set("density", density);
  body.tet_attributes.set("young", young);
  body.tet_attributes.set("poisson", poisson);
  const SimulationPlan plan = plan_simulation(body, {}, {});
  EXPECT_TRUE(noted(plan.notes, "mean_material"));
  EXPECT_EQ(plan.options.model, SoftBodyModel::corotational);
  EXPECT_NEAR(plan.options.poisson, 0.2, 1e-12);
  EXPECT_FALSE(noted(plan_simulation(body, {}, {.stiffness = 100, .density = 1}).notes, "mean_material"));
  poisson[3] = 0.495;
  body.tet_attributes.set("poisson", poisson);
  EXPECT_THROW(plan_simulation(body, {}, {}), DataError);

  const TetMesh large = test::box_of_tets({0, 0, 0}, {400, 100, 100}, 4, 1, 1);
  const SimulationPlan guessed = plan_simulation(large, {}, {});
  EXPECT_EQ(guessed.unit, 0.01);
  ASSERT_TRUE(noted(guessed.notes, "unit"));
  EXPECT_NE(guessed.notes[0].remedy.find("`unit`"), std::string::npos);
  EXPECT_FALSE(noted(plan_simulation(large, {}, {.unit = LengthUnit{0.01}}).notes, "unit"));
}

TEST(SimulateOptions, UnitsHaveNames) {
  SimulateOptions options;
  for_each_option(SimulateOptions::schema(), &options, [](const OptionRow& row, void* owner) {
    if (row.name != "unit") return;
    set_option(row, owner, std::string("inch"));
    EXPECT_EQ(option_words(option_value(row, owner)), "inch");
    EXPECT_THROW(set_option(row, owner, std::string("parsec")), ArgumentError);
    EXPECT_THROW(set_option(row, owner, std::string("1e300")), ArgumentError);
    set_option(row, owner, std::string("0.5"));
  });
  EXPECT_EQ(options.unit->metres, 0.5);
}

TEST(SimulateJob, KeepsWhatIsAskedForAndSaysWhatIsWrongAtRest) {
  SceneScript scene;
  scene.downwards = 0;
  scene.scene.spheres = {{{0, 0, 0}, 0.5, 0}};
  Progress progress;
  const SimulationPlan plan = plan_simulation(small_bar(), scene, {.duration = 0.04, .frames = 3});
  const SimulateResult made = simulate(plan, {.positions = true, .velocities = false}, true, progress);
  EXPECT_TRUE(noted(made.notes, "within_obstacle"));
  EXPECT_EQ(made.motion.frames(), 3u);
  EXPECT_TRUE(made.motion.velocities(1).empty());
  EXPECT_EQ(made.report.moments.size(), made.report.steps + 1);
  EXPECT_EQ(simulate(plan, {}, false, progress).report.moments.size(), 1u);
}

TEST(SimulateJob, SurfacesGoWithTheBody) {
  SceneScript pull;
  pull.downwards = 0;
  PulledHandle all;
  for (std::uint32_t v = 0; v < 20; ++v) all.vertices.push_back(v);
  all.keys = {{0, {}, {}}, {0.1, {0, 2, 0}, {}}};
  pull.scene.handles = {all};
  Progress progress;
  const SimulationPlan plan = plan_simulation(small_bar(), pull, {.duration = 0.1, .frames = 2});
  const SimulateResult made = simulate(plan, {}, false, progress);
  TriangleMesh inner;
  inner.vertices = {{1, 0.5F, 0.5F}, {2, 0.5F, 0.5F}, {9, 0.5F, 0.5F}};
  inner.triangles = {{0, 1, 2}};
  const CarriedSurface surface(*plan.rest, inner);
  EXPECT_TRUE(noted(surface.notes(), "outside"));
  const TriangleMesh moved = surface.at(made.motion, 1);
  EXPECT_NEAR(moved.origin.y + static_cast<double>(moved.vertices[0].y), 2.5, 1e-5);
  EXPECT_TRUE(CarriedSurface(*plan.rest).notes().empty());
}

}  // namespace
}  // namespace sansmesh::test
