#include "sansmesh/dynamics/soft_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "dynamics/body_checks.h"
#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/dynamics/body_state.h"
#include "sansmesh/error.h"
#include "support/any_threads.h"
#include "support/tet_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::ideal;
using test::kAllIntegrators;
using test::Momenta;
using test::momenta_of;
using test::one_tet;
using test::random_vectors;
using test::small_bar;

/// An additional integrator that moves nothing.
class RestingStepper : public BodyStepper {
 public:
  void step(BodyState& body, double h, StepReport& report) override {
    body.time += h;
    report.time = body.time, report.parts += 1, report.shortest = h;
  }
};

TEST(BodyIntegrators, ProgramsAddTheirOwn) {
  const auto add = [](std::string_view name) {
    BodyIntegrator::registry().add({.name = name, .summary = "at rest", .make = []() -> std::unique_ptr<BodyStepper> {
                                      return std::make_unique<RestingStepper>();
                                    }});
  };
  EXPECT_THROW(add("verlet"), ArgumentError);
  add("resting");
  SoftBodyOptions options = ideal("resting", 0.1);
  options.gravity = {0, 0, -9.81};
  SoftBody body(small_bar(), options);
  EXPECT_EQ(body.advance(1).parts, 10);
  EXPECT_EQ(body.positions(), small_bar().vertices);
  EXPECT_EQ(body.stable_step(), std::numeric_limits<double>::infinity());
  options.integrator = "leapfrog";
  try {
    const SoftBody none(small_bar(), options);
    ADD_FAILURE();
  } catch (const ArgumentError& error) {
    EXPECT_EQ(error.what(), std::string("`integrator` must be one of implicit-euler, explicit-euler, verlet, "
                                        "velocity-verlet, resting, not 'leapfrog'"));
  }
}

TEST(SoftBody, MomentumIsKeptWithoutForcesFromOutside) {
  for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
    for (std::string_view integrator : kAllIntegrators) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(model) << ' ' << integrator);
      SoftBodyOptions options = ideal(integrator, 1e-3);
      options.model = model, options.damping = 0.5, options.stiffness_damping = 1e-3;
      SoftBody body(small_bar(), options);
      body.set_state(body.positions(), random_vectors(body.rest().vertices.size(), 1, 7));
      const Momenta before = momenta_of(body);
      for (int k = 0; k < 50; ++k) body.step();
      EXPECT_LT(norm(momenta_of(body).linear - before.linear), 1e-10 * norm(before.linear));
    }
  }
}

// Forces along edges, and symmetric stresses, have no torque; Verlet's method preserves angular momentum.
TEST(SoftBody, VerletKeepsTheAngularMomentum) {
  for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
    SoftBodyOptions options = ideal("verlet", 1e-3);
    options.model = model;
    SoftBody body(small_bar(), options);
    body.set_state(body.positions(), random_vectors(body.rest().vertices.size(), 1, 7));
    const Momenta before = momenta_of(body);
    for (int k = 0; k < 100; ++k) body.step();
    EXPECT_LT(norm(momenta_of(body).angular - before.angular), 1e-9 * norm(before.angular));
  }
}

SoftBody shaken_bar(const SoftBodyOptions& options) {
  SoftBody body(small_bar(), options);
  const std::size_t n = body.rest().vertices.size();
  body.set_state(test::sum(body.positions(), random_vectors(n, 0.02, 3)), random_vectors(n, 0.3, 5));
  return body;
}

TEST(SoftBody, EnergyOfVerletDoesNotDrift) {
  for (std::string_view integrator : {"verlet", "velocity-verlet"}) {
    SoftBodyOptions options = ideal(integrator, 1e-3);
    options.stiffness = 2000;
    SoftBody body = shaken_bar(options);
    const double start = body.energies().total();
    // Between 20 and 80 periods of the fastest vibrations per block.
    double worst[6] = {}, mean[6] = {};
    for (int block = 0; block < 6; ++block) {
      for (int k = 0; k < 1000; ++k) {
        body.step();
        const double error = body.energies().total() / start - 1;
        worst[block] = std::max(worst[block], std::abs(error)), mean[block] += error / 1000;
      }
    }
    EXPECT_LT(*std::max_element(worst, worst + 6), 0.02);
    EXPECT_LT(std::abs(mean[5] - mean[0]), 1e-3);
  }
}

TEST(SoftBody, ImplicitEulerNeverGainsEnergy) {
  for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
    for (const double h : {1e-3, 1e-2, 0.1}) {
      SoftBodyOptions options = ideal("implicit-euler", h);
      options.model = model;
      SoftBody body = shaken_bar(options);
      double before = body.energies().total();
      for (int k = 0; k < 60; ++k) {
        body.step();
        const double now = body.energies().total();
        ASSERT_LE(now, before * (1 + 1e-9)) << h << ' ' << k;
        before = now;
      }
    }
  }
}

/// A stretched and spinning tetrahedron after a tenth of a second.
std::vector<Vec3> one_tet_after(std::string_view integrator, double h, double damping) {
  SoftBodyOptions options = ideal(integrator, h);
  options.total_mass = 4, options.stiffness = 400, options.damping = damping;
  SoftBody body(one_tet(), options);
  body.set_state(test::sum(body.positions(), random_vectors(4, 0.2, 1)), random_vectors(4, 1, 2));
  body.advance(0.1);
  return body.positions();
}

double order_of(std::string_view integrator, double damping) {
  const auto truth = one_tet_after("velocity-verlet", 2e-6, damping);
  const auto error = [&](double h) {
    const auto x = one_tet_after(integrator, h, damping);
    double worst = 0;
    for (std::size_t i = 0; i < 4; ++i) worst = std::max(worst, norm(x[i] - truth[i]));
    return worst;
  };
  return std::log2(error(4e-4) / error(2e-4));
}

TEST(SoftBody, ErrorsFallByTheOrder) {
  for (const double damping : {0.0, 2.0}) {
    EXPECT_NEAR(order_of("explicit-euler", damping), 1, 0.1);
    EXPECT_NEAR(order_of("velocity-verlet", damping), 2, 0.1);
    EXPECT_NEAR(order_of("implicit-euler", damping), 1, 0.1);
  }
  EXPECT_NEAR(order_of("verlet", 0), 2, 0.1);
  EXPECT_NEAR(order_of("verlet", 2), 1, 0.15);  // damping of half a step before
}

/// A bar of 80 cells, as in the source, with one end fixed and the other pulled; whether it is stable for 400 steps.
bool lasts(std::string_view integrator, double stiffness, double h) {
  SoftBodyOptions options;
  options.integrator = integrator, options.stiffness = stiffness, options.step = h, options.damping = 3;
  const TetMesh bar = test::box_of_tets({0, 0, 0}, {2, 0.5, 0.5}, 8, 1, 2);
  options.total_mass = 0.15 * static_cast<double>(bar.vertices.size());
  DynamicsScene scene;
  VertexForce pull{{}, {0, 0, -5}};
  for (std::uint32_t v = 0; v < bar.vertices.size(); ++v) {
    if (bar.vertices[v].x == 0) scene.fixed.push_back(v);
    if (bar.vertices[v].x == 2) pull.vertices.push_back(v);
  }
  scene.forces.push_back(pull);
  SoftBody body(bar, options, scene);
  try {
    for (int k = 0; k < 400; ++k) body.step();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("explodes"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("implicit-euler"), std::string::npos) << error.what();
    return false;
  }
  const auto x = body.positions();
  return std::all_of(x.begin(), x.end(), [](const Vec3& p) { return is_finite(p) && norm(p) < 10; });
}

// tejada2008, 6.4.5: explicit methods took no more than h = 0.001 s with k_s = 3000, while with the implicit one and h
// = 0.01 s "no stability problem was found" for more than 30,000.
TEST(SoftBody, ImplicitEulerIsStableWhereExplicitMethodsExplode) {
  for (std::string_view integrator : kAllIntegrators) {
    SCOPED_TRACE(integrator);
    const bool is_implicit = integrator == "implicit-euler";
    EXPECT_TRUE(lasts(integrator, 3000, 0.001));
    EXPECT_EQ(lasts(integrator, 3000, 0.01), is_implicit);
    EXPECT_EQ(lasts(integrator, 40000, 0.01), is_implicit);
    EXPECT_EQ(lasts(integrator, 1e6, 0.01), is_implicit);
  }
}

SoftBody hanging_bar(const SoftBodyOptions& options) {
  const TetMesh bar = small_bar();
  DynamicsScene scene;
  PulledHandle pull{{}, {{0, {}, {}}, {0.2, {0.3, 0, 0.2}, {0.5, 0, 0}}}, {}, {}};
  for (std::uint32_t v = 0; v < bar.vertices.size(); ++v) {
    if (bar.vertices[v].x == 0) scene.fixed.push_back(v);
    if (bar.vertices[v].x == 2) pull.vertices.push_back(v);
  }
  scene.handles.push_back(pull);
  return {bar, options, scene};
}

TEST(SoftBody, HandlesGoWhereTheyAreSent) {
  for (std::string_view integrator : kAllIntegrators) {
    SoftBodyOptions options;
    options.integrator = integrator, options.step = 1e-3, options.damping = 5, options.gravity = {};
    SoftBody body = hanging_bar(options);
    body.advance(0.25);
    const auto x = body.positions();
    for (std::uint32_t v = 0; v < x.size(); ++v) {
      const Vec3 p = body.rest().vertices[v];
      if (p.x == 0) EXPECT_EQ(x[v], p);
      if (p.x != 2) continue;
      const double c = std::cos(0.5), s = std::sin(0.5), y = p.y - 0.25, z = p.z - 0.25;
      EXPECT_LT(norm(x[v] - Vec3{2.3, 0.25 + c * y - s * z, 0.45 + s * y + c * z}), 1e-12);
    }
  }
}

TEST(SoftBody, StepsThatDoNotConvergeAreHalvedAndBecomeLongAgain) {
  SoftBodyOptions options;
  options.stiffness = 1e5, options.damping = 100, options.iterations = 12, options.tolerance = 1e-6;
  SoftBody body = hanging_bar(options);
  const StepReport first = body.step();
  EXPECT_GT(first.halvings, 0);
  EXPECT_GT(first.parts, 1);
  EXPECT_LT(first.shortest, options.step);
  EXPECT_DOUBLE_EQ(first.time, options.step);
  // As it comes to rest, fewer iterations are needed.
  for (int k = 0; k < 250; ++k) body.step();
  for (int k = 0; k < 50; ++k) EXPECT_EQ(body.step().parts, 1);

  options.iterations = 1, options.halvings = 2, options.tolerance = 1e-12;
  SoftBody never = hanging_bar(options);
  try {
    never.step();
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("`iterations`"), std::string::npos) << error.what();
  }
}

/// Shape of the bar in the moving frame after 40 steps: one end is pulled along at the speed of the whole bar.
std::vector<Vec3> carried_bar(double h, const Vec3& velocity) {
  SoftBodyOptions options;
  options.step = h;
  const TetMesh bar = small_bar();
  DynamicsScene scene;
  scene.handles.push_back({{}, {{0, {}, {}}, {1, velocity, {}}}, {}, {}});
  for (std::uint32_t v = 0; v < bar.vertices.size(); ++v) {
    if (bar.vertices[v].x == 0) scene.handles[0].vertices.push_back(v);
  }
  SoftBody body(bar, options, scene);
  body.set_state(bar.vertices, std::vector<Vec3>(bar.vertices.size(), velocity));
  for (int k = 0; k < 40; ++k) body.step();
  auto x = body.positions();
  for (Vec3& p : x) p -= velocity * body.time();
  return x;
}

// A force acts on a moving body as on one at rest, however small its impulse in a step beside the momentum.
TEST(SoftBody, ImplicitEulerDoesNotKnowWhetherItMoves) {
  for (const double h : {1e-2, 1e-3, 1e-4}) {
    const auto at_rest = carried_bar(h, {}), fast = carried_bar(h, {30, 200, -100});
    double sag = 0, difference = 0;
    for (std::size_t v = 0; v < at_rest.size(); ++v) {
      sag = std::max(sag, norm(at_rest[v] - small_bar().vertices[v]));
      difference = std::max(difference, norm(at_rest[v] - fast[v]));
    }
    EXPECT_GT(sag, 5 * 1600 * h * h) << h;
    EXPECT_LT(difference, 1e-5 * sag) << h;
  }
}

TEST(SoftBody, WhatFallsFallsFasterAndFaster) {
  for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
    for (const double h : {1e-2, 1e-3, 1e-4}) {
      SoftBodyOptions options;  // default tolerance
      options.model = model, options.step = h, options.damping = 0;
      SoftBody body(small_bar(), options);
      // It also vibrates.
      auto v = random_vectors(body.rest().vertices.size(), 1, 7);
      for (Vec3& a : v) a.z -= 300;
      body.set_state(body.positions(), v);
      const Vec3 before = momenta_of(body).linear;
      for (int k = 0; k < 30; ++k) body.step();
      const Vec3 gained = momenta_of(body).linear - before, right = options.gravity * (500 * 30 * h);
      EXPECT_LT(norm(gained - right), 1e-8 * norm(right)) << h;
    }
  }
}

TEST(SoftBody, ForcesTooLargeForNumbersAreErrors) {
  for (std::string_view integrator : kAllIntegrators) {
    SoftBodyOptions options;
    options.integrator = integrator;
    DynamicsScene scene;
    scene.fixed = {0};
    scene.forces.push_back({{1}, {1e300, 0, 0}});
    SoftBody body(small_bar(), options, scene);
    try {
      body.advance(0.1);
      FAIL() << integrator;
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find("explodes"), std::string::npos) << error.what();
    }
  }
}

TEST(SoftBody, AdvanceTakesWholeSteps) {
  SoftBodyOptions options;
  options.step = 0.01;
  SoftBody body(one_tet(), options);
  EXPECT_EQ(body.advance(0.05).parts, 5);
  EXPECT_EQ(body.advance(0.055).parts, 6);
  EXPECT_NEAR(body.time(), 0.105, 1e-15);
  EXPECT_THROW(body.advance(0), ArgumentError);
}

TEST(SoftBody, TheSameBitsForAnyNumberOfThreads) {
  for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
    for (std::string_view integrator : {"velocity-verlet", "implicit-euler"}) {
      test::expect_equal_for_any_threads([&] {
        SoftBodyOptions options;
        options.model = model, options.integrator = integrator, options.step = 1e-3;
        const TetMesh mesh = test::box_of_tets({0, 0, 0}, {1, 1, 1}, 16, 16, 16);
        DynamicsScene scene;
        scene.floors.push_back({{0, 0, 0}, {0, 0, 1}, 0.5});
        SoftBody body(mesh, options, scene);
        for (int k = 0; k < 5; ++k) body.step();
        auto state = body.positions();
        for (const Vec3& v : body.velocities()) state.push_back(v);
        return state;
      });
    }
  }
}

TEST(SoftBody, MassesAreThoseOfTheVolumeOrEqual) {
  SoftBodyOptions options;
  options.density = 3;
  const TetMesh bar = small_bar();
  const SoftBody around(bar, options);
  double mass = 0;
  for (const double m : around.masses()) mass += m;
  EXPECT_NEAR(mass, 3 * 2 * 0.5 * 0.5, 1e-12);
  EXPECT_LT(*std::min_element(around.masses().begin(), around.masses().end()), 0.5 * mass / 81);
  options.total_mass = 8.1, options.equal_masses = true;
  const SoftBody equal(bar, options);
  for (const double m : equal.masses()) EXPECT_NEAR(m, 0.1, 1e-12);
}

/// Message of the exception that the constructor throws for these arguments.
template <class Expected>
std::string refused(const TetMesh& mesh, const SoftBodyOptions& options, const DynamicsScene& scene = {}) {
  try {
    const SoftBody body(mesh, options, scene);
  } catch (const Expected& error) {
    return error.what();
  }
  return "";
}

TEST(SoftBody, BadInputIsNamed) {
  const auto expect = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  SoftBodyOptions options;
  options.step = 0;
  expect(refused<ArgumentError>(one_tet(), options), "`step`");
  options = {}, options.poisson = 0.5;
  expect(refused<ArgumentError>(one_tet(), options), "poisson");
  options = {};
  TetMesh mesh = one_tet();
  mesh.tets[0] = {0, 2, 1, 3};
  expect(refused<DataError>(mesh, options), "tetrahedron 0 (counted from 0) is inside out");
  mesh.tets[0] = {1, 2, 3, 4};
  expect(refused<DataError>(mesh, options), "vertex 4");
  mesh = one_tet(), mesh.vertices[3] = {0.5, 0.5, 0};
  expect(refused<DataError>(mesh, options), "no volume");
  mesh.tets.clear();
  expect(refused<DataError>(mesh, options), "no tetrahedra");
  DynamicsScene scene;
  scene.fixed = {0, 9};
  expect(refused<ArgumentError>(one_tet(), options, scene), "`fixed` 1");
  scene = {}, scene.handles.push_back({{1}, {{1, {}, {}}, {1, {}, {}}}, {}, {}});
  expect(refused<ArgumentError>(one_tet(), options, scene), "times");
  scene.handles[0].keys.pop_back(), scene.fixed = {1};
  expect(refused<ArgumentError>(one_tet(), options, scene), "fixed or pulled already");
  scene = {}, scene.spheres.push_back({{}, -1, 0});
  expect(refused<ArgumentError>(one_tet(), options, scene), "`spheres` 0");
  scene = {}, scene.forces.push_back({{7}, {1, 0, 0}});
  expect(refused<ArgumentError>(one_tet(), options, scene), "there is no vertex 7");
}

TEST(SoftBody, VerticesWithoutTetrahedraStay) {
  TetMesh mesh = one_tet();
  mesh.vertices.insert(mesh.vertices.begin(), Vec3{3, 3, 3});
  mesh.tets[0] = {1, 2, 3, 4};
  for (std::string_view integrator : kAllIntegrators) {
    SoftBodyOptions options;
    options.integrator = integrator, options.step = 1e-3;
    SoftBody body(mesh, options);
    body.advance(0.1);
    const auto x = body.positions();
    EXPECT_EQ(x[0], mesh.vertices[0]);
    EXPECT_NEAR(x[1].z, -0.5 * 9.81 * 0.01, 1e-3);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
