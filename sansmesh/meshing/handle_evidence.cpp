#include "sansmesh/meshing/handle_evidence.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/points/statistics/spacing.h"

namespace sansmesh::inline v1::detail {
namespace {

/// A handle is narrow up to this width: in local spacings, and in standard deviations of the noise.
constexpr double kNarrowSpacings = 2, kNarrowNoises = 4;
/// Largest misfit, likewise.
constexpr double kReachSpacings = 1, kReachNoises = 2;
/// Misfit over the reach for normals at an angle α: this factor times 1 − cos α. Beyond 60° it is the largest one.
constexpr double kTurn = 2;
/// Samples that may support a point of the surface: the nearest ones, within this multiple of the reach.
constexpr std::size_t kWitnesses = 8;
constexpr double kWitnessReach = 1.5;

}  // namespace

HandleEvidence::HandleEvidence(const TriangleMesh& mesh, const PointSet& points, const KdTree& samples, double spacing,
                               double noise)
    : mesh_(mesh),
      points_(points),
      samples_(samples),
      shift_(mesh.origin - points.origin),
      spacing_(spacing),
      noise_(noise),
      spacing_of_(points.size(), -1) {}

double HandleEvidence::spacing_at(const Vec3& x) const {
  const auto nearest = samples_.nearest(Vec3f(x + shift_));
  if (!nearest) return spacing_;
  const std::atomic_ref<double> known(spacing_of_[nearest->index]);
  if (const double found = known.load(std::memory_order_relaxed); found >= 0) return found;
  std::array<Neighbour, kLocalNeighbours> around;
  const std::size_t count = samples_.nearest(points_.positions[nearest->index], around);
  const double local =
      count < around.size() ? spacing_ : local_spacing(static_cast<double>(around.back().squared_distance), spacing_);
  known.store(local, std::memory_order_relaxed);
  return local;
}

double HandleEvidence::narrow_width(const Vec3& x) const {
  return std::max(kNarrowSpacings * spacing_at(x), kNarrowNoises * noise_);
}

double HandleEvidence::reach(const Vec3& x) const {
  return std::max(kReachSpacings * spacing_at(x), kReachNoises * noise_);
}

void HandleEvidence::add_face(const Vec3& a, const Vec3& b, const Vec3& c, std::vector<Face>& faces) {
  const Vec3 normal = cross(b - a, c - a);
  if (squared_norm(normal) > 0) faces.push_back({a, b, c, normalized(normal)});
}

void HandleEvidence::add_face(std::uint32_t triangle, std::vector<Face>& faces) const {
  const auto& [a, b, c] = mesh_.triangles[triangle];
  add_face(Vec3(mesh_.vertices[a]), Vec3(mesh_.vertices[b]), Vec3(mesh_.vertices[c]), faces);
}

std::vector<HandleEvidence::Face> HandleEvidence::faces_of(const HandleCap& cap) const {
  std::vector<Face> faces;
  for (const Triangle& t : cap.triangles)
    add_face(cap.position(mesh_, t[0]), cap.position(mesh_, t[1]), cap.position(mesh_, t[2]), faces);
  return faces;
}

double HandleEvidence::misfit(std::uint32_t sample, const std::vector<Face>& faces, double reach) const {
  const Vec3 x = Vec3(points_.positions[sample]) - shift_, normal(points_.normals[sample]);
  double least = reach * reach;
  for (const Face& f : faces) {
    const double turn = reach * kTurn * (1 - dot(normal, f.normal)), rest = least - turn * turn;
    if (rest <= 0) continue;
    const double far = dot(x - f.a, f.normal);
    if (far * far >= rest) continue;
    least = std::min(least, turn * turn + squared_norm(closest_on_triangle(x, f.a, f.b, f.c) - x));
  }
  return std::sqrt(least);
}

double HandleEvidence::support(const Vec3& x, const Vec3& normal) const {
  const double limit = reach(x), radius = kWitnessReach * limit;
  std::array<Neighbour, kWitnesses> near;
  const std::size_t count = samples_.nearest(Vec3f(x + shift_), near);
  double least = 1;
  for (std::size_t i = 0; i < count; ++i) {
    if (static_cast<double>(near[i].squared_distance) > radius * radius) break;
    const Vec3 across(points_.normals[near[i].index]);
    const double turn = kTurn * (1 - dot(across, normal));
    const double height = dot(x + shift_ - Vec3(points_.positions[near[i].index]), across) / limit;
    least = std::min(least, std::sqrt(turn * turn + height * height));
  }
  return 1 - least;
}

double HandleEvidence::support(const HandleClasses& classes, const HandleLoop& loop) const {
  const VertexCorners& corners = classes.corners();
  const std::size_t n = loop.vertices.size();
  double sum = 0;
  std::vector<Face> faces;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t v = loop.vertices[i], w = loop.vertices[(i + 1) % n];
    const Vec3 a(mesh_.vertices[v]), b(mesh_.vertices[w]);
    faces.clear();
    for (std::uint32_t k = corners.first[v]; k < corners.first[v + 1]; ++k) {
      const std::uint32_t h = corners.entries[k];
      if (classes.to(h) == w || classes.from(HandleClasses::previous(h)) == w) add_face(h / 3, faces);
    }
    Vec3 normal;
    for (const Face& f : faces) normal += cross(f.b - f.a, f.c - f.a);
    if (squared_norm(normal) > 0) sum += norm(b - a) * support((a + b) / 2, normalized(normal));
  }
  return loop.length > 0 ? sum / loop.length : 0;
}

std::vector<std::uint32_t> HandleEvidence::triangles_around(const HandleClasses& classes, const Vec3& center,
                                                            double radius) const {
  if (!vertices_) vertices_.emplace(mesh_.vertices);
  std::vector<Neighbour> near;
  vertices_->within(Vec3f(center), static_cast<float>(radius), near);
  std::vector<std::uint32_t> around;
  const VertexCorners& corners = classes.corners();
  for (const Neighbour& v : near)
    for (std::uint32_t k = corners.first[v.index]; k < corners.first[v.index + 1]; ++k)
      around.push_back(corners.entries[k] / 3);
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  return around;
}

HandleEvidence::Change HandleEvidence::change(const HandleClasses& classes, const HandleCut& cut) const {
  std::vector<Face> band, caps;
  for (const std::uint32_t t : cut.band) add_face(t, band);
  for (const HandleCap& cap : cut.caps) {
    const std::vector<Face> faces = faces_of(cap);
    caps.insert(caps.end(), faces.begin(), faces.end());
  }
  Change change;
  Vec3 center;
  const double count = static_cast<double>(band.size() + caps.size());
  if (count == 0) return change;
  for (const std::vector<Face>* list : {&band, &caps})
    for (const Face& f : *list) center += (f.a + f.b + f.c) / (3 * count);
  double radius = 0;
  for (const std::vector<Face>* list : {&band, &caps})
    for (const Face& f : *list) radius = std::max({radius, norm(f.a - center), norm(f.b - center), norm(f.c - center)});
  const double limit = reach(center);
  std::vector<Neighbour> near;
  samples_.within(Vec3f(center + shift_), static_cast<float>(radius + limit), near);
  change.around = triangles_around(classes, center, radius + 3 * limit);
  std::vector<Face> outside;
  for (const std::uint32_t t : change.around)
    if (!std::binary_search(cut.band.begin(), cut.band.end(), t)) add_face(t, outside);
  for (const Neighbour& s : near) {
    const double before = misfit(s.index, band, limit), after = misfit(s.index, caps, limit);
    change.samples += before < limit || after < limit;
    if (before == after) continue;
    const double other = misfit(s.index, outside, limit);
    change.gain += (std::min(before, other) - std::min(after, other)) / limit;
  }
  return change;
}

bool HandleEvidence::covers(const HandleCut& cut, double share) const {
  for (const HandleCap& cap : cut.caps) {
    double all = 0, covered = 0;
    for (const Face& f : faces_of(cap)) {
      const double area = norm(cross(f.b - f.a, f.c - f.a));
      all += area;
      if (support((f.a + f.b + f.c) / 3, f.normal) > 0) covered += area;
    }
    if (!(covered >= share * all)) return false;
  }
  return true;
}

}  // namespace sansmesh::inline v1::detail
