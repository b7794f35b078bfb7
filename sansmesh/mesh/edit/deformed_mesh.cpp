#include "sansmesh/mesh/edit/deformed_mesh.h"
#include "sansmesh/core/edge_key.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/refine_edges.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kMostDeformRounds = 24;

std::vector<Vec3> in_world(const Vec3& origin, std::span<const Vec3f> positions) {
  std::vector<Vec3> x;
  x.reserve(positions.size());
  for (const Vec3f& p : positions) x.push_back(origin + Vec3(p));
  return x;
}

/// Image of a surface normal: the direction of J^−T n, with the length of n, on the side to which triangles turn.
Vec3f moved_normal(const Jacobian& j, const Vec3f& normal) {
  const Vec3 n(normal), m = cross(j[1], j[2]) * n.x + cross(j[2], j[0]) * n.y + cross(j[0], j[1]) * n.z;
  const double length = norm(m);
  return length > 0 && std::isfinite(length) ? Vec3f(m * (norm(n) / length)) : normal;
}

/// Offsets for evaluating the map at the vertices; empty if all are zero.
std::vector<Vec3> sides_of(const TriangleMesh& mesh) {
  const Attribute* const found = mesh.attributes.find(kCutSide);
  std::vector<Vec3> sides;
  if (!found || found->components != 3) return sides;
  sides.resize(found->rows());
  for (std::size_t i = 0; i < sides.size(); ++i)
    sides[i] = {found->number(3 * i), found->number(3 * i + 1), found->number(3 * i + 2)};
  return sides;
}

/// Maps positions and surface normals, and updates the origin.
void move_all(const SpaceMap& forward, Vec3& origin, std::vector<Vec3f>& positions, const std::vector<Vec3>& sides,
              std::span<std::vector<Vec3f>* const> normals, MeshDeformReport& report) {
  std::vector<Vec3> x = in_world(origin, positions);
  for (std::size_t i = 0; i < sides.size(); ++i) x[i] += sides[i];
  std::vector<Vec3> moved(x.size());
  std::vector<Jacobian> jacobians(x.size());
  forward.map(x, {moved, jacobians, {}, {}});
  Box3 box;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_finite(moved[i])) {
      moved[i] = origin + Vec3(positions[i]);
      report.undefined += is_finite(x[i]);
      continue;
    }
    const Jacobian& j = jacobians[i];
    if (!sides.empty()) moved[i] -= j[0] * sides[i].x + j[1] * sides[i].y + j[2] * sides[i].z;
    box.extend(moved[i]);
    report.turned += !(dot(j[0], cross(j[1], j[2])) > 0);
    for (std::vector<Vec3f>* const n : normals)
      if (!n->empty()) (*n)[i] = moved_normal(j, (*n)[i]);
  }
  if (!box.empty() && norm(box.center() - origin) > box.diagonal()) origin = box.center();
  for (std::size_t i = 0; i < x.size(); ++i) positions[i] = Vec3f(moved[i] - origin);
}

/// Bisects edges that bend too much; returns false if some remain.
bool refine_bent(TriangleMesh& mesh, const SpaceMap& forward, const MeshDeformOptions& options) {
  std::vector<Vec3> moved;
  std::unordered_map<std::uint64_t, bool> bends;  // bent edges of this and previous rounds
  for (int round = 0; round < kMostDeformRounds; ++round) {
    const std::size_t known = moved.size();
    std::vector<Vec3> fresh = in_world(mesh.origin, std::span(mesh.vertices).subspan(known));
    const std::vector<Vec3> sides = sides_of(mesh);
    for (std::size_t i = known; i < sides.size(); ++i) fresh[i - known] += sides[i];
    moved.resize(mesh.vertices.size());
    forward.map(fresh, {std::span(moved).subspan(known), {}, {}, {}});
    std::vector<std::uint64_t> edges;
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        if (a < moved.size() && b < moved.size() && bends.try_emplace(edge_key(a, b), false).second)
          edges.push_back(edge_key(a, b));
      }
    std::vector<Vec3> middles;
    middles.reserve(edges.size());
    const auto ends = [](std::uint64_t key) {
      return std::pair(static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key));
    };
    for (const std::uint64_t e : edges) {
      const auto [a, b] = ends(e);
      middles.push_back(mesh.origin + (Vec3(mesh.vertices[a]) + Vec3(mesh.vertices[b])) * 0.5);
      if (!sides.empty()) middles.back() += (sides[a] + sides[b]) * 0.5;
    }
    std::vector<Vec3> images(middles.size());
    forward.map(middles, {images, {}, {}, {}});
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto [a, b] = ends(edges[i]);
      bends[edges[i]] = norm(images[i] - (moved[a] + moved[b]) * 0.5) > *options.bend;  // false for NaN
    }
    const auto added = split_edges(
        mesh, [&](std::uint32_t a, std::uint32_t b) { return bends.at(edge_key(a, b)); }, options.most_triangles);
    if (!added) return false;
    if (*added == 0) return true;
  }
  return false;
}

}  // namespace

void MeshDeformOptions::validate() const {
  if (bend && !(*bend > 0 && std::isfinite(*bend)))
    throw ArgumentError("`bend` must be a positive length, not " + std::to_string(*bend));
}

TriangleMesh deform_mesh(TriangleMesh mesh, const SpaceMap& forward, const MeshDeformOptions& options,
                         MeshDeformReport* report) {
  options.validate();
  MeshDeformReport own;
  MeshDeformReport& r = report ? *report : own;
  r = {};
  const std::size_t before = mesh.triangles.size();
  if (options.bend) r.fine = refine_bent(mesh, forward, options);
  r.added = mesh.triangles.size() - before;
  std::vector<Vec3f>* const normals[] = {&mesh.normals};
  move_all(forward, mesh.origin, mesh.vertices, sides_of(mesh), normals, r);
  mesh.attributes.erase(kCutSide);
  return mesh;
}

PointSet deform_points(PointSet points, const SpaceMap& forward, MeshDeformReport* report) {
  MeshDeformReport own;
  MeshDeformReport& r = report ? *report : own;
  r = {};
  std::vector<Vec3f>* const normals[] = {&points.normals, &points.grid_normals};
  move_all(forward, points.origin, points.positions, {}, normals, r);
  points.scanners.clear();
  return points;
}

}  // namespace sansmesh::inline v1
