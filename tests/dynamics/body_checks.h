// Small bodies, and measurements of them.
#pragma once

#include <random>
#include <vector>

#include "sansmesh/dynamics/soft_body.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "support/tet_shapes.h"

namespace sansmesh::test {

constexpr std::string_view kAllIntegrators[] = {"explicit-euler", "verlet", "velocity-verlet", "implicit-euler"};

inline TetMesh one_tet() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}, {}}; }

inline TetMesh small_bar() { return test::box_of_tets({0, 0, 0}, {2, 0.5, 0.5}, 8, 2, 2); }

/// Undamped, weightless, solved as exactly as possible.
inline SoftBodyOptions ideal(std::string_view integrator, double step) {
  SoftBodyOptions options;
  options.integrator = integrator, options.step = step, options.gravity = {}, options.damping = 0;
  options.tolerance = 1e-12;
  return options;
}

inline std::vector<Vec3> random_vectors(std::size_t n, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  std::vector<Vec3> v(n);
  for (Vec3& a : v) a = {uniform(random), uniform(random), uniform(random)};
  return v;
}

inline std::vector<Vec3> sum(std::vector<Vec3> a, const std::vector<Vec3>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

struct Momenta {
  Vec3 linear, angular;
};

inline Momenta momenta_of(const SoftBody& body) {
  Momenta all;
  const auto x = body.positions(), v = body.velocities();
  for (std::size_t i = 0; i < x.size(); ++i) {
    all.linear += v[i] * body.masses()[i];
    all.angular += cross(x[i], v[i]) * body.masses()[i];
  }
  return all;
}

inline Vec3 center_of(const SoftBody& body) {
  Vec3 moment;
  double mass = 0;
  const auto x = body.positions();
  for (std::size_t i = 0; i < x.size(); ++i) moment += x[i] * body.masses()[i], mass += body.masses()[i];
  return moment / mass;
}

}  // namespace sansmesh::test
