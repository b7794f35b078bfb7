#include "sansmesh/dynamics/stable_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "dynamics/body_checks.h"
#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/error.h"
#include "support/tet_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::ideal;
using test::random_vectors;
using test::small_bar;

constexpr std::string_view kExplicit[] = {"explicit-euler", "verlet", "velocity-verlet"};
constexpr SoftBodyModel kModels[] = {SoftBodyModel::springs, SoftBodyModel::corotational};

/// Largest energy in 400 steps relative to the initial energy; infinity if the body explodes.
double most_energy(const TetMesh& mesh, const SoftBodyOptions& options, const DynamicsScene& scene = {}) {
  SoftBody body(mesh, options, scene);
  body.set_state(body.positions(), random_vectors(mesh.vertices.size(), 1e-4, 5));
  const double start = body.energies().total();
  double most = 0;
  try {
    for (int k = 0; k < 400; ++k) {
      body.step();
      most = std::max(most, body.energies().total() / start);
    }
  } catch (const DataError&) {
    return std::numeric_limits<double>::infinity();
  }
  return most;
}

TEST(StableStep, OfVibrationsAndDecayIsWhereTheStepsTurn) {
  // One mass on a damped spring, with the methods as recurrences: stable just below the limit, unstable just above.
  const auto grows = [](std::string_view integrator, double w, double c, double h) {
    double x = 1, v = 0.3, a = -w * x - c * v;
    for (int k = 0; k < 20000; ++k) {
      if (integrator == "explicit-euler") {
        a = -w * x - c * v, x += h * v, v += h * a;
      } else if (integrator == "verlet") {
        v += h * (-w * x - c * v), x += h * v;
      } else {
        v += 0.5 * h * a, x += h * v, a = -w * x - c * (v + 0.5 * h * a), v += 0.5 * h * a;
      }
      if (std::abs(x) > 100) return true;
    }
    return false;
  };
  for (std::string_view integrator : kExplicit) {
    for (const double c : {0.0, 0.1, 1.5}) {
      SCOPED_TRACE(testing::Message() << integrator << ' ' << c);
      const double w = 4, h = stable_step(body_integrator(integrator), {w, 0, c, 0, c / w});
      if (integrator == "explicit-euler" && c == 0) {
        EXPECT_EQ(h, 0);
        continue;
      }
      EXPECT_FALSE(grows(integrator, w, c, 0.995 * h));
      EXPECT_TRUE(grows(integrator, w, c, (integrator == "explicit-euler" ? 1.2 : 1.01) * h));
    }
  }
  EXPECT_GT(stable_step(body_integrator("implicit-euler"), {4, 0, 0, 0, 0}), 1e300);
}

TEST(StableStep, NoBodyGainsEnergyWithIt) {
  const TetMesh fine = test::refine_uniformly(test::one_tet());
  for (std::string_view integrator : kExplicit) {
    for (const SoftBodyModel model : kModels) {
      for (const double damping : {0.0, 1e-4, 1e-2}) {  // s
        for (const bool light : {false, true}) {
          SCOPED_TRACE(testing::Message()
                       << integrator << ' ' << static_cast<int>(model) << ' ' << damping << ' ' << light);
          SoftBodyOptions options = ideal(integrator, 1);
          options.model = model, options.stiffness = 1e5;
          options.damping = damping * options.stiffness, options.stiffness_damping = damping;
          if (light) options.total_mass = 0.3;
          options.step = stable_step(light ? small_bar() : fine, options);
          if (damping == 0 && integrator == "explicit-euler") {
            EXPECT_EQ(options.step, 0);
            continue;
          }
          options.step *= 0.5;
          EXPECT_LT(most_energy(light ? small_bar() : fine, options), 1.3);
          // Damping of the elastic model is known exactly. A weakly damped explicit Euler grows slowly.
          if (model == SoftBodyModel::springs && damping > 0) continue;
          if (integrator == "explicit-euler" && damping < 1e-3) continue;
          options.step *= 2 * 1.25;
          EXPECT_GT(most_energy(light ? small_bar() : fine, options), 10);
        }
      }
    }
  }
}

TEST(StableStep, SpringsOfHandlesCount) {
  DynamicsScene scene;
  scene.handles.push_back({{0, 5}, {{}}, {}, 1e7});
  for (std::string_view integrator : {"verlet", "velocity-verlet"}) {
    SoftBodyOptions options = ideal(integrator, 1);
    const double without = stable_step(small_bar(), options), with = stable_step(small_bar(), options, scene);
    EXPECT_LT(with, 0.5 * without);
    options.step = with;
    EXPECT_LT(most_energy(small_bar(), options, scene), 10);
    options.step = 1.25 * with;
    EXPECT_GT(most_energy(small_bar(), options, scene), 100);
  }
  // Undamped springs of handles; Rayleigh's α would damp them.
  SoftBodyOptions options = ideal("explicit-euler", 1);
  options.model = SoftBodyModel::corotational, options.stiffness_damping = 1e-3;
  EXPECT_EQ(stable_step(small_bar(), options, scene), 0);
  options.mass_damping = 100;
  options.step = stable_step(small_bar(), options, scene);
  EXPECT_GT(options.step, 0);
  EXPECT_LT(most_energy(small_bar(), options, scene), 1.3);
}

TEST(StableStep, IsToldWhereABodyExplodes) {
  SoftBodyOptions options = ideal("explicit-euler", 0.1);
  const auto told = [&] {
    SoftBody body(small_bar(), options);
    body.set_state(body.positions(), random_vectors(body.rest().vertices.size(), 0.1, 5));
    try {
      body.advance(100);
    } catch (const DataError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(told().find("unstable without damping"), std::string::npos) << told();
  options.damping = 10;
  EXPECT_NE(told().find("take a `step` of 0.003 s"), std::string::npos) << told();
}

}  // namespace
}  // namespace sansmesh::inline v1
