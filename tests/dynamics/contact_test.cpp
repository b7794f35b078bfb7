// Bodies and obstacles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dynamics/body_checks.h"
#include "sansmesh/dynamics/obstacle_set.h"

namespace sansmesh {
namespace {

using test::kAllIntegrators;

/// A cube with its bottom at z = `bottom`.
TetMesh cube(double bottom) { return box_of_tets({-0.5, -0.5, bottom}, {0.5, 0.5, bottom + 1}, 4, 4, 4); }

SoftBodyOptions of_rubber(DynamicsIntegrator integrator) {
  SoftBodyOptions options;
  options.integrator = integrator, options.step = integrator == DynamicsIntegrator::implicit_euler ? 0.01 : 4e-4;
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
    for (const DynamicsIntegrator integrator : kAllIntegrators) {
      if (model == SoftBodyModel::corotational && integrator != DynamicsIntegrator::implicit_euler) continue;
      SCOPED_TRACE(testing::Message() << static_cast<int>(model) << ' ' << static_cast<int>(integrator));
      SoftBodyOptions options = of_rubber(integrator);
      options.model = model, options.youngs_modulus = 2e4, options.stiffness_damping = 0.004;
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
  for (const DynamicsIntegrator integrator : kAllIntegrators) {
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
  // Gravity leans instead of the floor: tan of the angle is 0.4.
  const double lean = std::atan(0.4);
  for (const DynamicsIntegrator integrator :
       {DynamicsIntegrator::velocity_verlet, DynamicsIntegrator::implicit_euler}) {
    for (const double friction : {0.0, 0.2, 0.5}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(integrator) << ' ' << friction);
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

TEST(Contact, FloorsDoNotHoldWhatIsPulledUp) {
  SoftBodyOptions options = of_rubber(DynamicsIntegrator::implicit_euler);
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
}  // namespace sansmesh
