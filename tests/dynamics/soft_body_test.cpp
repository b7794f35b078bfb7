#include "sansmesh/dynamics/soft_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "support/any_threads.h"

namespace sansmesh {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr DynamicsIntegrator kAllIntegrators[] = {DynamicsIntegrator::explicit_euler, DynamicsIntegrator::verlet,
                                                  DynamicsIntegrator::velocity_verlet,
                                                  DynamicsIntegrator::implicit_euler};

/// One tetrahedron with edges of about 1.
TetMesh one_tet() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}, {}}; }

TetMesh small_bar() { return box_of_tets({0, 0, 0}, {2, 0.5, 0.5}, 8, 2, 2); }

SoftBodyOptions without_gravity(DynamicsIntegrator integrator, double step) {
  SoftBodyOptions options;
  options.integrator = integrator, options.step = step, options.gravity = {}, options.damping = 0;
  options.tolerance = 1e-12;
  return options;
}

std::vector<Vec3> random_vectors(std::size_t n, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  std::vector<Vec3> v(n);
  for (Vec3& a : v) a = {uniform(random), uniform(random), uniform(random)};
  return v;
}

struct Momenta {
  Vec3 linear, angular;
};

Momenta momenta_of(const SoftBody& body) {
  Momenta sum;
  const auto x = body.positions(), v = body.velocities();
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum.linear += v[i] * body.masses()[i];
    sum.angular += cross(x[i], v[i]) * body.masses()[i];
  }
  return sum;
}

TEST(SoftBody, MomentumIsKeptWithoutForcesFromOutside) {
  for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::corotational}) {
    for (const DynamicsIntegrator integrator : kAllIntegrators) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(model) << ' ' << static_cast<int>(integrator));
      SoftBodyOptions options = without_gravity(integrator, 1e-3);
      options.model = model, options.damping = 0.5, options.stiffness_damping = 1e-3;
      SoftBody body(small_bar(), options);
      body.set_state(body.positions(), random_vectors(body.rest().vertices.size(), 1, 7));
      const Momenta before = momenta_of(body);
      const double size = norm(before.linear) + norm(before.angular);
      for (int k = 0; k < 50; ++k) body.step();
      const Momenta after = momenta_of(body);
      EXPECT_LT(norm(after.linear - before.linear), 1e-10 * size);
      // Implicit and forward Euler keep the angular momentum only as far as they follow the motion.
      const bool exact = integrator == DynamicsIntegrator::verlet;
      if (exact && model == SoftBodyModel::springs) EXPECT_LT(norm(after.angular - before.angular), 1e-2 * size);
    }
  }
}

}  // namespace
}  // namespace sansmesh
