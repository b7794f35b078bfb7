// Internal state of a soft body, on which its integrators operate. Vertices are reordered so that neighbours in space
// are neighbours in memory.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/dynamics/elastic_model.h"
#include "sansmesh/dynamics/obstacle_set.h"
#include "sansmesh/dynamics/scene_drive.h"
#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

struct BodyState {
  BodyState(const SoftBodyOptions& with, const DynamicsScene& scene, SceneDrive driven)
      : options(with), integrator(body_integrator(with.integrator)), obstacles(scene), drive(std::move(driven)) {}

  SoftBodyOptions options;
  const BodyIntegrator& integrator;
  std::unique_ptr<ElasticModel> model;
  ObstacleSet obstacles;
  SceneDrive drive;
  std::vector<std::uint32_t> names;   ///< original vertex indices
  std::vector<double> masses;         ///< kg; 1 for vertices without a tetrahedron, which are held
  std::vector<Vec3> weights;          ///< N; zero for those
  std::vector<std::uint8_t> is_held;  ///< 1: its motion is prescribed

  double time = 0;
  std::vector<Vec3> x, v;
  std::vector<Vec3> rest;  ///< positions
  double lag = 0;          ///< v refers to `time` − lag: half a step in Verlet's method, else 0

  double near = 0;     ///< contact distance (length)
  double longest = 0;  ///< displacement per step (length) above which the body counts as exploded

  std::size_t size() const { return x.size(); }

  /// All forces at positions x, velocities v and time t. Throws DataError if the body has exploded.
  void forces(std::span<const Vec3> at, std::span<const Vec3> velocities, double t, std::span<Vec3> f);
  /// Velocities at the time of the positions.
  std::vector<Vec3> velocities_now();
  /// SoftBody::stable_step.
  double stable_step();
  /// Throws DataError that describes the failure and the remedy.
  [[noreturn]] void explode(std::span<const Vec3> at);

 private:
  /// Largest eigenvalue of M⁻¹ (A + handles K), with the model's matrix A for the step h divided by `unit`, and held
  /// vertices at rest.
  double largest_eigenvalue(double h, double unit, bool handles);
};

}  // namespace sansmesh::inline v1
