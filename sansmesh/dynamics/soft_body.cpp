#include "sansmesh/dynamics/soft_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dynamics/body_state.h"
#include "sansmesh/dynamics/corotational_model.h"
#include "sansmesh/dynamics/spring_model.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/error.h"
#include "sansmesh/search/space_order.h"

namespace sansmesh::inline v1 {
namespace {

/// A quarter of each tetrahedron's mass at its corners, or equal shares; 0 where there is no tetrahedron.
std::vector<double> lumped_masses(const TetMesh& mesh, const SoftBodyOptions& options) {
  std::vector<double> masses(mesh.vertices.size(), 0);
  double volume = 0;
  for (const Tet& t : mesh.tets) {
    const double own = tet_volume(t, mesh.vertices);
    volume += own;
    for (const std::uint32_t v : t) masses[v] += own / 4;
  }
  const double density = options.total_mass ? *options.total_mass / volume : options.density;
  const auto used = static_cast<double>(std::count_if(masses.begin(), masses.end(), [](double m) { return m > 0; }));
  for (double& m : masses) m = options.equal_masses ? (m > 0 ? density * volume / used : 0) : m * density;
  return masses;
}

}  // namespace

struct SoftBody::State {
  TetMesh mesh;
  DynamicsScene scene;
  std::vector<double> masses;        ///< masses of the mesh's vertices
  std::vector<std::uint32_t> order;  ///< mesh vertex of each vertex of the body
  std::vector<std::uint32_t> place;  ///< inverse of `order`
  std::unique_ptr<BodyState> body;
  std::unique_ptr<BodyStepper> stepper;

  std::vector<Vec3> in_order(std::span<const Vec3> values) const {
    std::vector<Vec3> sorted(values.size());
    for (std::size_t i = 0; i < sorted.size(); ++i) sorted[i] = values[order[i]];
    return sorted;
  }
  std::vector<Vec3> as_given(std::span<const Vec3> sorted) const {
    std::vector<Vec3> values(sorted.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[order[i]] = sorted[i];
    return values;
  }
};

SoftBody::SoftBody(TetMesh mesh, const SoftBodyOptions& options, DynamicsScene scene)
    : state_(std::make_unique<State>()) {
  options.validate();
  check_tets(mesh);
  scene.validate(mesh.vertices.size());
  State& s = *state_;
  s.mesh = std::move(mesh), s.scene = std::move(scene);
  s.masses = lumped_masses(s.mesh, options);
  s.order = space_order(s.mesh.vertices);
  const std::size_t n = s.order.size();
  s.place.resize(n);
  for (std::size_t i = 0; i < n; ++i) s.place[s.order[i]] = static_cast<std::uint32_t>(i);
  std::vector<Vec3> rest = s.in_order(s.mesh.vertices);
  std::vector<std::uint32_t> loose;
  for (std::size_t v = 0; v < n; ++v) {
    if (s.masses[v] == 0) loose.push_back(static_cast<std::uint32_t>(v));
  }

  s.body = std::make_unique<BodyState>(options, s.scene, SceneDrive(s.scene, rest, s.place, loose));
  BodyState& body = *s.body;
  s.stepper = body.integrator.make();
  body.names = s.order;
  body.is_held.assign(n, 0);
  for (const std::uint32_t i : body.drive.held()) body.is_held[i] = 1;
  for (const std::uint32_t v : s.order) {
    body.masses.push_back(s.masses[v] > 0 ? s.masses[v] : 1);
    body.weights.push_back(options.gravity * s.masses[v]);
  }
  std::vector<Tet> tets = s.mesh.tets;
  for (Tet& t : tets) {
    for (std::uint32_t& v : t) v = s.place[v];
  }
  // Improves locality; also the order of sums over tetrahedra.
  std::sort(tets.begin(), tets.end(), [](const Tet& a, const Tet& b) {
    const auto first = [](const Tet& t) { return *std::min_element(t.begin(), t.end()); };
    return first(a) != first(b) ? first(a) < first(b) : a < b;
  });
  if (options.model == SoftBodyModel::springs) {
    body.model = std::make_unique<SpringModel>(vertex_graph(tets, n), rest, options.stiffness, options.damping);
  } else {
    body.model = std::make_unique<CorotationalModel>(std::move(tets), rest, options.young, options.poisson,
                                                     options.stiffness_damping);
  }
  const double diagonal = bounds(s.mesh).diagonal();
  body.near = 1e-9 * diagonal, body.longest = ElasticModel::kMostStretch * diagonal;
  body.x = rest, body.rest = std::move(rest), body.v.resize(n);
}

SoftBody::~SoftBody() = default;
SoftBody::SoftBody(SoftBody&&) noexcept = default;
SoftBody& SoftBody::operator=(SoftBody&&) noexcept = default;

StepReport SoftBody::step() { return advance(options().step); }

StepReport SoftBody::advance(double duration) {
  check_argument(std::isfinite(duration) && duration > 0, "`duration` must be a positive time");
  const double steps = std::max(1.0, std::ceil(duration / options().step * (1 - 1e-12)));
  const double h = duration / steps;
  StepReport report;
  for (double k = 0; k < steps; ++k) state_->stepper->step(*state_->body, h, report);
  return report;
}

double SoftBody::stable_step() const { return state_->body->stable_step(); }

std::vector<std::uint32_t> SoftBody::within_obstacles() const {
  const BodyState& body = *state_->body;
  std::vector<std::uint32_t> within;
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (!body.is_held[i] && body.obstacles.holds(body.x[i], body.near)) within.push_back(body.names[i]);
  }
  std::sort(within.begin(), within.end());
  return within;
}

double SoftBody::time() const { return state_->body->time; }
std::vector<Vec3> SoftBody::positions() const { return state_->as_given(state_->body->x); }
std::vector<Vec3> SoftBody::velocities() const { return state_->as_given(state_->body->velocities_now()); }
const std::vector<double>& SoftBody::masses() const { return state_->masses; }
const TetMesh& SoftBody::rest() const { return state_->mesh; }
const SoftBodyOptions& SoftBody::options() const { return state_->body->options; }
const DynamicsScene& SoftBody::scene() const { return state_->scene; }

BodyEnergies SoftBody::energies() const {
  BodyState& body = *state_->body;
  const std::vector<Vec3> v = body.velocities_now();
  BodyEnergies sum;
  for (std::size_t i = 0; i < v.size(); ++i) {
    sum.kinetic += 0.5 * body.masses[i] * squared_norm(v[i]);
    sum.gravity -= dot(body.weights[i], body.x[i]);
  }
  sum.elastic = body.model->energy(body.x);
  const auto targets = body.drive.targets(body.time);
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const auto [vertex, stiffness] = body.drive.pulled()[k];
    sum.elastic += 0.5 * stiffness * squared_norm(targets[k] - body.x[vertex]);
  }
  return sum;
}

void SoftBody::set_state(std::span<const Vec3> positions, std::span<const Vec3> velocities) {
  BodyState& body = *state_->body;
  check_argument(positions.size() == body.size() && velocities.size() == body.size(),
                 "`positions` and `velocities` must have an entry for each vertex");
  const auto finite = [](const Vec3& p) { return is_finite(p); };
  check_argument(std::all_of(positions.begin(), positions.end(), finite) &&
                     std::all_of(velocities.begin(), velocities.end(), finite),
                 "`positions` and `velocities` must be finite");
  body.x = state_->in_order(positions), body.v = state_->in_order(velocities);
  const auto held = body.drive.held_positions(body.time);
  for (std::size_t k = 0; k < held.size(); ++k) {
    body.x[body.drive.held()[k]] = held[k], body.v[body.drive.held()[k]] = {};
  }
  body.lag = 0;
  state_->stepper->reset();
}

namespace {

constexpr ReportRow kBodyEnergiesRows[] = {
    reported<&BodyEnergies::kinetic>({.text = "Kinetic energy", .unit = "J"}),
    reported<&BodyEnergies::elastic>({.text = "Elastic energy", .unit = "J"}),
    reported<&BodyEnergies::gravity>({.text = "Potential energy of gravity", .unit = "J"}),
    reported<&BodyEnergies::total>({.text = "Total energy", .unit = "J"})};

}  // namespace

const ReportSchema& BodyEnergies::schema() {
  static constexpr ReportSchema schema{kBodyEnergiesRows};
  return schema;
}

}  // namespace sansmesh::inline v1
