#include "sansmesh/jobs/motion.h"

#include <fmt/core.h>

#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/dynamics/tet_geometry.h"

namespace sansmesh::inline v1 {

Motion::Motion(std::shared_ptr<const TetMesh> rest, const KeptMotion& kept)
    : rest_(std::move(rest)), origin_(bounds(*rest_).center()), kept_(kept) {}

double Motion::bytes(std::size_t frames) const {
  const int vectors = (kept_.positions ? 1 : 0) + (kept_.velocities ? 1 : 0);
  return static_cast<double>(vectors * sizeof(Vec3f)) * static_cast<double>(frames) *
         static_cast<double>(rest_->vertices.size());
}

void Motion::add(double time, const std::vector<Vec3>& positions, const std::vector<Vec3>& velocities, double unit) {
  times_.push_back(time);
  std::vector<Vec3f>& x = positions_.emplace_back();
  if (kept_.positions) {
    x.reserve(positions.size());
    for (const Vec3& p : positions) x.push_back(Vec3f(p / unit - origin_));
  }
  std::vector<Vec3f>& v = velocities_.emplace_back();
  if (!kept_.velocities) return;
  v.reserve(velocities.size());
  for (const Vec3& p : velocities) v.push_back(Vec3f(p / unit));
}

std::vector<Vec3> Motion::positions(std::size_t frame) const {
  std::vector<Vec3> x;
  x.reserve(positions_[frame].size());
  for (const Vec3f& p : positions_[frame]) x.push_back(origin_ + Vec3(p));
  return x;
}

CarriedSurface::CarriedSurface(const TetMesh& rest) { surface_ = boundary_mesh(rest, rest.vertices, &sources_); }

CarriedSurface::CarriedSurface(const TetMesh& rest, TriangleMesh surface) : surface_(std::move(surface)) {
  std::vector<Vec3> x;
  x.reserve(surface_.vertices.size());
  for (const Vec3f& p : surface_.vertices) x.push_back(surface_.origin + Vec3(p));
  embedding_.emplace(rest, x);
  for (const Vec3f& n : surface_.normals) normals_.push_back(Vec3(n));
}

TriangleMesh CarriedSurface::at(const Motion& motion, std::size_t frame) const {
  const std::vector<Vec3> x = motion.positions(frame);
  TriangleMesh m = surface_;
  m.origin = motion.origin();
  if (!embedding_) {
    for (std::size_t v = 0; v < m.vertices.size(); ++v) m.vertices[v] = Vec3f(x[sources_[v]] - m.origin);
    return m;
  }
  const std::vector<Vec3> moved = embedding_->positions(x);
  for (std::size_t v = 0; v < m.vertices.size(); ++v) m.vertices[v] = Vec3f(moved[v] - m.origin);
  if (!normals_.empty()) {
    const std::vector<Vec3> turned = embedding_->normals(x, normals_);
    for (std::size_t v = 0; v < m.normals.size(); ++v) m.normals[v] = Vec3f(turned[v]);
  }
  return m;
}

std::vector<Note> CarriedSurface::notes() const {
  if (!embedding_ || embedding_->outside() == 0) return {};
  return {{.code = "outside",
           .text = fmt::format("{} of {} vertices lie in no tetrahedron: they go on with the nearest",
                               grouped(embedding_->outside()), grouped(surface_.vertices.size())),
           .remedy = {}}};
}

}  // namespace sansmesh::inline v1
