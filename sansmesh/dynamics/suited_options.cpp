#include "sansmesh/dynamics/suited_options.h"

#include <fmt/core.h>

#include <algorithm>

#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/dynamics/stable_step.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kSuitedStiffness = 25;   ///< Young's modulus over density × gravity × size
constexpr double kSuitedDamping = 0.004;  ///< s, damping over stiffness
/// Relative residual of conjugate gradients: half the time of 0.001, without visible difference.
constexpr double kSuitedTolerance = 0.01;
constexpr double kSuitedStep = 0.01;  ///< s, of implicit methods
constexpr double kSafeStep = 0.5;     ///< fraction of the longest stable step
constexpr double kEarth = 9.81;
constexpr double kLargestSuited = 20;  ///< m, for a body without a unit

double mean_edge(const TetMesh& mesh) {
  double sum = 0;
  for (const Tet& t : mesh.tets)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) sum += norm(mesh.vertices[t[i]] - mesh.vertices[t[j]]);
  return mesh.tets.empty() ? 1 : sum / (6 * static_cast<double>(mesh.tets.size()));
}

}  // namespace

double suited_unit(const SceneScript& s, const TetMesh& mesh) {
  if (s.unit) return *s.unit;
  if (s.stiffness || s.young || s.density || s.mass) return 1;
  const double size = bounds(mesh).diagonal();
  for (const double metres : {1.0, 0.01})
    if (size * metres <= kLargestSuited) return metres;
  return 0.001;
}

SoftBodyOptions suited_options(const SceneScript& s, const TetMesh& mesh) {
  SoftBodyOptions o;
  const bool elastic = s.young || s.poisson;
  o.model = s.model.value_or(elastic ? SoftBodyModel::corotational : SoftBodyModel::springs);
  o.integrator = s.integrator.value_or(o.integrator);
  const double down = s.downwards.value_or(kEarth);
  o.gravity = s.gravity.value_or(s.z_up.value_or(false) ? Vec3{0, 0, -down} : Vec3{0, -down, 0});
  o.density = s.density.value_or(o.density);
  o.total_mass = s.mass;
  o.tolerance = s.tolerance.value_or(kSuitedTolerance);
  o.iterations = s.iterations.value_or(o.iterations);
  o.halvings = s.halvings.value_or(o.halvings);

  double volume = 0;
  for (const Tet& t : mesh.tets) volume += tet_volume(t, mesh.vertices);
  const double density = s.mass && volume > 0 ? *s.mass / volume : o.density;
  const double pull = norm(o.gravity) > 0 ? norm(o.gravity) : kEarth;
  const double young = kSuitedStiffness * density * pull * bounds(mesh).diagonal();
  o.young = s.young.value_or(young > 0 ? young : o.young);
  o.poisson = s.poisson.value_or(o.poisson);
  o.stiffness = s.stiffness.value_or(o.young * mean_edge(mesh));
  o.damping = s.damping.value_or(kSuitedDamping * o.stiffness);
  o.mass_damping = s.mass_damping.value_or(o.mass_damping);
  o.stiffness_damping = s.stiffness_damping.value_or(kSuitedDamping);
  o.step = s.step.value_or(kSuitedStep);
  if (!s.step && body_integrator(o.integrator).stable_step) {
    const double stable = stable_step(mesh, o, scaled(s.scene, s.unit.value_or(1)));
    if (!(stable > 0))
      throw ArgumentError(
          fmt::format("{} is unstable for any step without damping, or with handles on springs: take "
                      "velocity-verlet, or more damping",
                      o.integrator));
    o.step = std::min(kSuitedStep, kSafeStep * stable);
  }
  return o;
}

}  // namespace sansmesh::inline v1
