#include "sansmesh/measure/mesh_signed_distance.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/data/group_rows.h"
#include "sansmesh/error.h"
#include "sansmesh/measure/points_signed_distance.h"
#include "sansmesh/search/equal_positions.h"

namespace sansmesh::inline v1 {

MeshDistance::MeshDistance(const TriangleMesh& mesh) : mesh_(mesh), closest_(mesh) {
  if (closest_.empty()) throw DataError("no triangles to measure distances to");
  same_ = first_equal_positions(mesh.vertices);
  const std::size_t n = mesh.vertices.size();
  const auto usable = [&](const Triangle& t) {
    return t[0] < n && t[1] < n && t[2] < n && is_finite(mesh.vertices[t[0]]) && is_finite(mesh.vertices[t[1]]) &&
           is_finite(mesh.vertices[t[2]]);
  };
  Box3f box;
  triangles_at_ = group_rows(n, [&](const auto& visit) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      if (!usable(mesh.triangles[i])) continue;
      for (const std::uint32_t v : mesh.triangles[i]) visit(same_[v], i), box.extend(mesh.vertices[v]);
    }
  });
  bounds_ = {mesh.origin + Vec3(box.lower), mesh.origin + Vec3(box.upper)};
}

Triangle MeshDistance::corners(std::uint32_t triangle) const {
  const Triangle& t = mesh_.triangles[triangle];
  return {same_[t[0]], same_[t[1]], same_[t[2]]};
}

Vec3 MeshDistance::face_normal(std::uint32_t triangle) const {
  const auto [a, b, c] = corners(triangle);
  return normalized(cross(position(b) - position(a), position(c) - position(a)));
}

/// Sum of the unit normals of the other triangles at an edge.
Vec3 MeshDistance::normals_across(std::uint32_t triangle, std::uint32_t a, std::uint32_t b) const {
  Vec3 sum;
  for (const std::uint32_t other : triangles_at_[a]) {
    if (other == triangle) continue;
    const Triangle t = corners(other);
    if (t[0] == b || t[1] == b || t[2] == b) sum += face_normal(other);
  }
  return sum;
}

Vec3 MeshDistance::edge_normal(std::uint32_t a, std::uint32_t b, bool& border) const {
  Vec3 sum;
  int faces = 0;
  for (const std::uint32_t triangle : triangles_at_[a]) {
    const Triangle t = corners(triangle);
    if (t[0] != b && t[1] != b && t[2] != b) continue;
    ++faces;
    const Vec3 normal = face_normal(triangle);
    sum += normal;
    if (squared_norm(normal) > 0) continue;
    // A triangle without area is replaced by its neighbours at the edge.
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = t[k], q = t[(k + 1) % 3];
      if (p != q && !(p == a && q == b) && !(p == b && q == a)) sum += normalized(normals_across(triangle, p, q));
    }
  }
  border = faces == 1;
  return sum;
}

Vec3 MeshDistance::vertex_normal(std::uint32_t corner, bool& border) const {
  Vec3 sum;
  border = false;
  for (const std::uint32_t triangle : triangles_at_[corner]) {
    const Triangle t = corners(triangle);
    const std::size_t k = t[0] == corner ? 0 : t[1] == corner ? 1 : 2;
    const std::uint32_t next = t[(k + 1) % 3], last = t[(k + 2) % 3];
    const Vec3 to_next = position(next) - position(corner), to_last = position(last) - position(corner);
    const double angle = std::atan2(norm(cross(to_next, to_last)), dot(to_next, to_last));
    const Vec3 normal = face_normal(triangle);
    sum +=
        (squared_norm(normal) > 0 || next == last ? normal : normalized(normals_across(triangle, next, last))) * angle;
    for (const std::uint32_t end : {next, last}) {
      if (end == corner || border) continue;
      int faces = 0;
      for (const std::uint32_t other : triangles_at_[corner]) {
        const Triangle o = corners(other);
        faces += o[0] == end || o[1] == end || o[2] == end;
      }
      border = faces == 1;
    }
  }
  return sum;
}

Vec3 MeshDistance::pseudo_normal(std::uint32_t triangle, TrianglePart part, bool& border) const {
  border = false;
  const auto [a, b, c] = corners(triangle);
  switch (part) {
    case TrianglePart::a:
      return vertex_normal(a, border);
    case TrianglePart::b:
      return vertex_normal(b, border);
    case TrianglePart::c:
      return vertex_normal(c, border);
    case TrianglePart::ab:
      return edge_normal(a, b, border);
    case TrianglePart::bc:
      return edge_normal(b, c, border);
    case TrianglePart::ca:
      return edge_normal(c, a, border);
    case TrianglePart::inside:
      break;
  }
  return face_normal(triangle);
}

void MeshDistance::measure(std::span<const Vec3> x, double, std::span<MeasuredPoint> found) const {
  ClosestTriangle::Hit hit;
  for (std::size_t i = 0; i < x.size(); ++i) {
    found[i] = {};
    const Vec3 query = x[i] - mesh_.origin;
    if (!is_finite(query)) continue;
    hit = closest_.closest(query, hit);
    const Triangle& t = mesh_.triangles[hit.triangle];
    const TrianglePoint at = locate_on_triangle(query, position(t[0]), position(t[1]), position(t[2]));
    const Vec3 normal = pseudo_normal(hit.triangle, at.part, found[i].border);
    const double distance = std::sqrt(hit.squared_distance);
    found[i].distance = dot(query - at.point, normal) < 0 ? -distance : distance;
    found[i].point = mesh_.origin + hit.point;
  }
}

std::unique_ptr<SignedDistance> signed_distance(const TriangleMesh& surface) {
  if (surface.triangles.empty()) return std::make_unique<PointsDistance>(surface);
  return std::make_unique<MeshDistance>(surface);
}

}  // namespace sansmesh::inline v1
