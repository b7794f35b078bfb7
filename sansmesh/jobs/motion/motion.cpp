// Motions of tetrahedral bodies, and the surfaces that they carry.
#include <fmt/core.h>

#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/dynamics/tet_embedding.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/simulate.h"

namespace sansmesh::inline v1 {

struct Motion::State {
  std::shared_ptr<const TetMesh> rest;
  Vec3 origin;
  KeptMotion kept;
  std::vector<double> times = {};
  std::vector<std::vector<Vec3f>> positions = {};  ///< relative to the origin
  std::vector<std::vector<Vec3f>> velocities = {};
};

struct CarriedSurface::State {
  TriangleMesh surface;
  std::vector<std::uint32_t> sources = {};  ///< vertices of the body, for its boundary
  std::optional<TetEmbedding> embedding = {};
  std::vector<Vec3> normals = {};
};

Motion::Motion() : Motion(std::make_shared<const TetMesh>(), {}) {}

Motion::Motion(const std::shared_ptr<const TetMesh>& rest, const KeptMotion& kept)
    : state_(std::make_shared<State>(State{.rest = rest, .origin = bounds(*rest).center(), .kept = kept})) {}

const TetMesh& Motion::rest() const { return *state_->rest; }
std::size_t Motion::frames() const { return state_->times.size(); }
double Motion::time(std::size_t frame) const { return state_->times[frame]; }
const std::vector<Vec3f>& Motion::velocities(std::size_t frame) const { return state_->velocities[frame]; }
const Vec3& Motion::origin() const { return state_->origin; }

double Motion::bytes(std::size_t frames) const {
  const int vectors = (state_->kept.positions ? 1 : 0) + (state_->kept.velocities ? 1 : 0);
  return static_cast<double>(vectors * sizeof(Vec3f)) * static_cast<double>(frames) *
         static_cast<double>(rest().vertices.size());
}

void Motion::add(double time, const std::vector<Vec3>& positions, const std::vector<Vec3>& velocities, double unit) {
  State& s = *state_;
  s.times.push_back(time);
  std::vector<Vec3f>& x = s.positions.emplace_back();
  if (s.kept.positions) {
    x.reserve(positions.size());
    for (const Vec3& p : positions) x.push_back(Vec3f(p / unit - s.origin));
  }
  std::vector<Vec3f>& v = s.velocities.emplace_back();
  if (!s.kept.velocities) return;
  v.reserve(velocities.size());
  for (const Vec3& p : velocities) v.push_back(Vec3f(p / unit));
}

std::vector<Vec3> Motion::positions(std::size_t frame) const {
  return world_points(origin(), state_->positions[frame]);
}

CarriedSurface::CarriedSurface(const TetMesh& rest) {
  State state;
  state.surface = boundary_mesh(rest, rest.vertices, &state.sources);
  state_ = std::make_shared<const State>(std::move(state));
}

CarriedSurface::CarriedSurface(const TetMesh& rest, TriangleMesh surface) {
  State state{.surface = std::move(surface)};
  state.embedding.emplace(rest, world_points(state.surface.origin, state.surface.vertices));
  for (const Vec3f& n : state.surface.normals) state.normals.push_back(Vec3(n));
  state_ = std::make_shared<const State>(std::move(state));
}

TriangleMesh CarriedSurface::at(const Motion& motion, std::size_t frame) const {
  const State& s = *state_;
  const std::vector<Vec3> x = motion.positions(frame);
  TriangleMesh m = s.surface;
  m.origin = motion.origin();
  if (!s.embedding) {
    for (std::size_t v = 0; v < m.vertices.size(); ++v) m.vertices[v] = Vec3f(x[s.sources[v]] - m.origin);
    return m;
  }
  const std::vector<Vec3> moved = s.embedding->positions(x);
  for (std::size_t v = 0; v < m.vertices.size(); ++v) m.vertices[v] = Vec3f(moved[v] - m.origin);
  if (!s.normals.empty()) {
    const std::vector<Vec3> turned = s.embedding->normals(x, s.normals);
    for (std::size_t v = 0; v < m.normals.size(); ++v) m.normals[v] = Vec3f(turned[v]);
  }
  return m;
}

std::vector<Note> CarriedSurface::notes() const {
  const auto& embedding = state_->embedding;
  if (!embedding || embedding->outside() == 0) return {};
  return {{.code = "outside",
           .text = fmt::format("{} of {} vertices are in no tetrahedron: they move with the nearest",
                               grouped(embedding->outside()), grouped(state_->surface.vertices.size()))}};
}

CarriedSurface read_carried(const std::string& file, const SimulationPlan& plan) {
  if (file.empty()) return with_file(plan.body_file, [&] { return CarriedSurface(*plan.rest); });
  return with_file(file, [&] { return CarriedSurface(*plan.rest, read_mesh(file)); });
}

}  // namespace sansmesh::inline v1
