#include "sansmesh/local_frame.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sansmesh/core/length_limits.h"
#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kTransformed = 1 << 15;
constexpr double kFlat = 1e-12;  // bound for the determinant of the unit directions

void check_invertible(const AffineMap& map) {
  if (!is_finite(map.x) || !is_finite(map.y) || !is_finite(map.z) || !is_finite(map.shift))
    throw ArgumentError("a transformation has numbers that are not finite");
  // Uses only the directions, so that tiny and huge scales are valid.
  const auto direction = [](const Vec3& v) {
    const double most = std::fmax(std::fmax(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
    return most > 0 ? normalized(v / most) : Vec3{};
  };
  const AffineMap directions{direction(map.x), direction(map.y), direction(map.z), {}};
  if (!(std::abs(directions.determinant()) > kFlat))
    throw ArgumentError("a transformation flattens space: its matrix has no inverse");
}

void check_reach(const std::vector<Vec3f>& positions, const Vec3& origin, const AffineMap& map) {
  double farthest = 0;
  for (const Vec3f& p : positions) farthest = std::fmax(farthest, norm(Vec3(p)));
  const double length = norm(map.x) + norm(map.y) + norm(map.z);
  if (!(farthest * length + norm(map(origin)) <= kLargestCoordinate))
    throw ArgumentError("a transformation moves positions beyond 1e18");
  if (farthest > kSmallestExtent && !(farthest * length > kSmallestExtent))
    throw ArgumentError("a transformation shrinks all lengths below 1e-12");
}

void transform_positions(std::vector<Vec3f>& positions, const AffineMap& map) {
  parallel_for(0, positions.size(), kTransformed,
               [&](std::size_t i) { positions[i] = Vec3f(map.linear(Vec3(positions[i]))); });
}

/// Normals transform by the inverse transpose, with the sign of the determinant, so that the outside stays outside.
void transform_normals(std::vector<Vec3f>& normals, const AffineMap& map) {
  const Matrix3 a{map.x, map.y, map.z};
  parallel_for(0, normals.size(), kTransformed, [&](std::size_t i) {
    if (normals[i] != Vec3f{}) normals[i] = Vec3f(normalized(a.solve_transposed(Vec3(normals[i]))));
  });
}

void swap_corners(std::vector<std::array<std::uint32_t, 3>>& triangles) {
  for (auto& t : triangles) std::swap(t[1], t[2]);
}

}  // namespace

AffineMap AffineMap::after(const AffineMap& first) const {
  return {linear(first.x), linear(first.y), linear(first.z), (*this)(first.shift)};
}

AffineMap AffineMap::inverse() const {
  check_invertible(*this);
  const Matrix3 a{x, y, z};
  return {a.solve({1, 0, 0}), a.solve({0, 1, 0}), a.solve({0, 0, 1}), -a.solve(shift)};
}

AffineMap AffineMap::about(const Vec3& center) const { return {x, y, z, center + shift - linear(center)}; }

AffineMap AffineMap::rotation(const Vec3& axis, double degrees) {
  const Vec3 n = normalized(axis);
  if (!is_finite(n) || n == Vec3{} || !std::isfinite(degrees))
    throw ArgumentError("a rotation needs an axis with a direction and a finite angle");
  const double quarters = degrees / 90, whole = std::round(quarters);
  double c = std::cos(degrees * (std::numbers::pi / 180)), s = std::sin(degrees * (std::numbers::pi / 180));
  if (quarters == whole) {
    const int k = static_cast<int>(std::fmod(std::fmod(whole, 4) + 4, 4));
    c = k == 0 ? 1 : k == 2 ? -1 : 0;
    s = k == 1 ? 1 : k == 3 ? -1 : 0;
  }
  const auto turned = [&](const Vec3& v) { return v * c + cross(n, v) * s + n * (dot(n, v) * (1 - c)); };
  return {turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}), {}};
}

void transform(PointSet& points, const AffineMap& map) {
  check_invertible(map);
  check_reach(points.positions, points.origin, map);
  points.origin = map(points.origin);
  if (map.is_translation()) return;
  transform_positions(points.positions, map);
  transform_positions(points.scanners, map);
  transform_normals(points.normals, map);
  transform_normals(points.grid_normals, map);
  if (map.determinant() < 0) swap_corners(points.triangles);
}

void transform(TriangleMesh& mesh, const AffineMap& map) {
  check_invertible(map);
  check_reach(mesh.vertices, mesh.origin, map);
  mesh.origin = map(mesh.origin);
  if (map.is_translation()) return;
  transform_positions(mesh.vertices, map);
  transform_normals(mesh.normals, map);
  if (map.determinant() < 0) swap_corners(mesh.triangles);
}

}  // namespace sansmesh::inline v1
