// Bodies and obstacles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dynamics/body_checks.h"
#include "sansmesh/dynamics/stable_step.h"
#include "support/tet_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::kAllIntegrators;

/// A cube with its bottom at z = `bottom`.
TetMesh cube(double bottom) { return test::box_of_tets({-0.5, -0.5, bottom}, {0.5, 0.5, bottom + 1}, 4, 4, 4); }

SoftBodyOptions of_rubber(std::string_view integrator) {
  SoftBodyOptions options;
  options.integrator = integrator, options.step = integrator == "implicit-euler" ? 0.01 : 4e-4;
  options.stiffness = 2000, options.damping = 8, options.total_mass = 20;
  return options;
}

double lowest(const SoftBody& body) {
  double z = 1e9;
  for (const Vec3& p : body.positions()) z = std::min(z, p.z);
  return z;
}

TEST(Contact, FallsOnTheFloorAndRests) {
  for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
    for (std::string_view integrator : kAllIntegrators) {
      if (model == SoftBodyModel::corotational && integrator != "implicit-euler") continue;
      SCOPED_TRACE(testing::Message() << static_cast<int>(model) << ' ' << integrator);
      SoftBodyOptions options = of_rubber(integrator);
      options.model = model, options.young = 2e4, options.stiffness_damping = 0.004;
      DynamicsScene scene;
      scene.floors.push_back({{0, 0, 0}, {0, 0, 2}, 0.3});
      SoftBody body(cube(0.2), options, scene);
      for (int k = 0; k < 15; ++k) {
        body.advance(0.1);
        ASSERT_GE(lowest(body), -1e-12);
      }
      double fastest = 0;
      for (const Vec3& v : body.velocities()) fastest = std::max(fastest, norm(v));
      EXPECT_LT(fastest, 0.1);  // it fell at 2
      EXPECT_EQ(body.advance(0.01).contacts, 25);
      const double sunk = 0.5 - test::center_of(body).z;
      EXPECT_GT(sunk, 0);
      EXPECT_LT(sunk, 0.05);
    }
  }
}

TEST(Contact, LiesOverASphereWithoutGoingIn) {
  for (std::string_view integrator : kAllIntegrators) {
    DynamicsScene scene;
    scene.spheres.push_back({{0, 0, -0.5}, 0.5, 0.2});
    scene.floors.push_back({{0, 0, -1}, {0, 0, 1}, 0.2});
    SoftBody body(cube(0.05), of_rubber(integrator), scene);
    int contacts = 0;
    for (int k = 0; k < 50; ++k) {
      contacts = std::max(contacts, body.advance(0.02).contacts);
      for (const Vec3& p : body.positions()) {
        ASSERT_GE(norm(p - scene.spheres[0].center), 0.5 - 1e-9);
        ASSERT_GE(p.z, -1 - 1e-9);
      }
    }
    EXPECT_GT(contacts, 0);
  }
}

TEST(Contact, SlidesDownASlopeThatIsSteeperThanItsFriction) {
  // Gravity is inclined instead of the floor: tan of the angle is 0.4.
  const double lean = std::atan(0.4);
  for (std::string_view integrator : {"velocity-verlet", "implicit-euler"}) {
    for (const double friction : {0.0, 0.2, 0.5}) {
      SCOPED_TRACE(testing::Message() << integrator << ' ' << friction);
      SoftBodyOptions options = of_rubber(integrator);
      options.stiffness = 2e4, options.damping = 20, options.step *= 0.5;
      options.gravity = {9.81 * std::sin(lean), 0, -9.81 * std::cos(lean)};
      DynamicsScene scene;
      scene.floors.push_back({{0, 0, 0}, {0, 0, 1}, friction});
      SoftBody body(cube(0), options, scene);
      const double start = test::center_of(body).x;
      body.advance(0.6);
      const double gone = test::center_of(body).x - start;
      const double free = 0.5 * 9.81 * (std::sin(lean) - friction * std::cos(lean)) * 0.36;
      if (friction > 0.4) {
        EXPECT_LT(std::abs(gone), 0.01);
      } else {
        EXPECT_NEAR(gone, free, 0.05 * free + 0.005);
      }
    }
  }
}

/// A rubber cube on a slope of 30 degrees with an initial speed along it. `step` 0: half of the stable step.
SoftBody on_a_slope(std::string_view integrator, double friction, double step, double speed) {
  SoftBodyOptions options;
  options.integrator = integrator, options.model = SoftBodyModel::corotational, options.young = 1e6;
  options.stiffness_damping = 0.004;
  options.gravity = {9.81 * 0.5, 0, -9.81 * std::sqrt(0.75)};
  DynamicsScene scene;
  scene.floors.push_back({{0, 0, 0}, {0, 0, 1}, friction});
  const TetMesh mesh = test::box_of_tets({-0.5, -0.5, 0}, {0.5, 0.5, 1}, 2, 2, 2);
  options.step = step > 0 ? step : 0.5 * stable_step(mesh, options, scene);
  SoftBody body(mesh, options, scene);
  body.set_state(mesh.vertices, std::vector<Vec3>(mesh.vertices.size(), Vec3{speed, 0, 0}));
  return body;
}

// At the default tolerance, with a speed beside which the impulse of gravity in a step is small.
TEST(Contact, ShortStepsSlideAsFarAsLongOnes) {
  for (const double h : {1e-2, 1e-3, 1e-4}) {
    for (const double friction : {0.0, 0.2}) {
      for (const double speed : {0.0, 20.0}) {
        const double time = 0.2, gain = 9.81 * (0.5 - friction * std::sqrt(0.75)) * time * time / 2;
        SoftBody body = on_a_slope("implicit-euler", friction, h, speed);
        body.advance(time);
        EXPECT_NEAR(test::center_of(body).x - speed * time, gain, 0.11 * gain) << h << ' ' << friction << ' ' << speed;
      }
    }
  }
}

TEST(Contact, WhatSticksDoesNotCreep) {
  for (std::string_view integrator : kAllIntegrators) {
    SoftBody body = on_a_slope(integrator, 1.5, integrator == "implicit-euler" ? 0.01 : 0, 0);
    const auto foot = [&] {
      double sum = 0;
      const auto x = body.positions();
      for (std::size_t v = 0; v < 9; ++v) sum += x[v].x / 9;
      return sum;
    };
    body.advance(1);  // comes to rest
    const double before = foot();
    body.advance(1);
    EXPECT_NEAR(foot(), before, 2e-4) << integrator;
  }
}

TEST(Contact, WhatIsHeldStaysInObstacles) {
  for (std::string_view integrator : kAllIntegrators) {
    DynamicsScene scene;
    scene.floors.push_back({{0, 0, 0.3}, {0, 0, 1}, 0.5});
    const TetMesh mesh = cube(0);
    PulledHandle down{{}, {{0, {}, {}}, {0.1, {0, 0, -0.1}, {}}}, {}, {}};
    for (std::uint32_t v = 0; v < 25; ++v) (v < 13 ? scene.fixed : down.vertices).push_back(v);
    scene.handles.push_back(down);
    SoftBody body(mesh, of_rubber(integrator), scene);
    const auto within = body.within_obstacles();
    ASSERT_EQ(within.size(), 25);  // the layer above, at 0.25
    EXPECT_EQ(within.front(), 25);
    EXPECT_EQ(within.back(), 49);
    int contacts = 0;
    for (int k = 0; k < 10; ++k) contacts = std::max(contacts, body.advance(0.02).contacts);
    EXPECT_LE(contacts, 25) << integrator;
    EXPECT_TRUE(body.within_obstacles().empty());
    for (std::uint32_t v = 0; v < 25; ++v) {
      const Vec3 wanted = mesh.vertices[v] - Vec3{0, 0, v < 13 ? 0 : 0.1};
      EXPECT_LT(norm(body.positions()[v] - wanted), 1e-12) << integrator << ' ' << v;
    }
  }
}

TEST(Contact, WhatBeginsInsideMayBeOnItsWayOut) {
  for (const double friction : {0.0, 0.3, 2.0}) {
    for (const Vec3& velocity : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{0.5, 0, 1}}) {
      SCOPED_TRACE(testing::Message() << friction << ' ' << velocity.x << ' ' << velocity.z);
      DynamicsScene scene;
      scene.floors.push_back({{0, 0, 0}, {0, 0, 1}, friction});
      const TetMesh mesh = cube(-0.25);
      SoftBody body(mesh, of_rubber("implicit-euler"), scene);
      body.set_state(mesh.vertices, std::vector<Vec3>(mesh.vertices.size(), velocity));
      for (int k = 0; k < 20; ++k) {
        body.step();
        ASSERT_GE(lowest(body), -1e-9);
      }
      for (const Vec3& p : body.positions()) EXPECT_TRUE(is_finite(p));
      EXPECT_LT(norm(test::center_of(body)), 5);
    }
  }
}

TEST(Contact, FloorsDoNotHoldWhatIsPulledUp) {
  SoftBodyOptions options = of_rubber("implicit-euler");
  DynamicsScene scene;
  scene.floors.push_back({{0, 0, 0}, {0, 0, 1}, 0.5});
  const TetMesh mesh = cube(0);
  VertexForce up{{}, {0, 0, 10}, 0.2};
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) up.vertices.push_back(v);
  scene.forces.push_back(up);
  SoftBody body(mesh, options, scene);
  EXPECT_EQ(body.advance(0.2).contacts, 25);
  EXPECT_EQ(body.advance(0.3).contacts, 0);
  EXPECT_GT(lowest(body), 0.1);
}

}  // namespace
}  // namespace sansmesh::inline v1
