#include "sansmesh/mesh/edit/arrows.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "sansmesh/box.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/points/sampling/poisson_discs.h"

namespace sansmesh::inline v1 {
namespace {

/// Arrow from 0 to (0, 0, 1), transformed for each vector.
struct ArrowTemplate {
  std::vector<Vec3> positions, normals;
  std::vector<Triangle> triangles;
};

ArrowTemplate arrow_template(const ArrowOptions& o) {
  ArrowTemplate a;
  const auto n = static_cast<std::uint32_t>(o.sides);
  const double neck = 1 - o.head_length, slant = std::hypot(o.head_length, o.head_radius);
  const double radii[] = {o.shaft_radius, o.shaft_radius, o.head_radius}, heights[] = {0, neck, neck};
  for (std::size_t ring = 0; ring < 3; ++ring)
    for (std::uint32_t k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * k / n;
      const Vec3 w{std::cos(angle), std::sin(angle), 0};
      a.positions.push_back(radii[ring] * w + Vec3{0, 0, heights[ring]});
      a.normals.push_back(ring < 2 ? w : o.head_length / slant * w + Vec3{0, 0, o.head_radius / slant});
    }
  a.positions.emplace_back(0, 0, 1);
  a.normals.emplace_back(0, 0, 1);
  for (std::uint32_t k = 1; k + 1 < n; ++k) a.triangles.push_back({0, k + 1, k});
  for (std::uint32_t ring = 0; ring < 2; ++ring)
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t p = ring * n + k, q = ring * n + (k + 1) % n;
      a.triangles.push_back({p, q, q + n});
      a.triangles.push_back({p, q + n, p + n});
    }
  for (std::uint32_t k = 0; k < n; ++k) a.triangles.push_back({2 * n + k, 2 * n + (k + 1) % n, 3 * n});
  return a;
}

}  // namespace

void ArrowOptions::validate() const {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  check_argument(!length || positive(*length), "`length` must be positive");
  check_argument(positive(scale), "`scale` must be positive");
  check_argument(positive(shaft_radius), "`shaft_radius` must be positive");
  check_argument(positive(head_radius) && head_radius > shaft_radius,
                 "`head_radius` must be larger than `shaft_radius`");
  check_argument(head_length > 0 && head_length < 1, "`head_length` must lie between 0 and 1");
  check_range("sides", sides, 3, 256);
}

TriangleMesh arrows(std::span<const Vec3> positions, std::span<const Vec3> vectors, const ArrowOptions& options,
                    const AttributeTable& attributes) {
  options.validate();
  check_argument(positions.size() == vectors.size(), "there must be as many vectors as positions");
  attributes.check_rows(positions.size(), "positions");
  const ArrowTemplate shape = arrow_template(options);
  const std::size_t each = shape.positions.size(), triangles = shape.triangles.size();
  if (positions.size() > std::numeric_limits<std::uint32_t>::max() / each)
    throw DataError("too many arrows for a mesh");

  std::vector<std::uint32_t> drawn;
  Box3 box;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (is_finite(positions[i]) && std::isfinite(norm(vectors[i])) && norm(vectors[i]) > 0) {
      drawn.push_back(static_cast<std::uint32_t>(i));
      box.extend(positions[i]);
    }
  TriangleMesh mesh;
  if (!drawn.empty()) mesh.origin = box.center();
  mesh.vertices.resize(each * drawn.size());
  mesh.normals.resize(mesh.vertices.size());
  mesh.triangles.resize(triangles * drawn.size());
  std::vector<std::uint32_t> rows(mesh.vertices.size());
  parallel_for(0, drawn.size(), 64, [&](std::size_t a) {
    const std::uint32_t i = drawn[a];
    const double size = norm(vectors[i]), length = options.length.value_or(options.scale * size);
    const Vec3 w = vectors[i] / size;
    Vec3 u, v;
    tangent_frame(w, u, v);
    const auto turned = [&](const Vec3& x) { return x.x * u + x.y * v + x.z * w; };
    for (std::size_t k = 0; k < each; ++k) {
      mesh.vertices[a * each + k] = Vec3f(positions[i] - mesh.origin + length * turned(shape.positions[k]));
      mesh.normals[a * each + k] = Vec3f(turned(shape.normals[k]));
      rows[a * each + k] = i;
    }
    const auto first = static_cast<std::uint32_t>(a * each);
    for (std::size_t t = 0; t < triangles; ++t)
      for (std::size_t c = 0; c < 3; ++c) mesh.triangles[a * triangles + t][c] = shape.triangles[t][c] + first;
  });
  mesh.attributes = attributes.taken(rows);
  return mesh;
}

std::vector<std::uint32_t> spread_vertices(const TriangleMesh& mesh, double spacing) {
  check_argument(std::isfinite(spacing) && spacing > 0, "`spacing` must be positive");
  const std::size_t count = mesh.vertices.size();
  std::vector<char> used(count, mesh.triangles.empty());
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (v < count) used[v] = 1;
  std::vector<Vec3> points;
  std::vector<std::uint32_t> numbers;
  for (std::size_t v = 0; v < count; ++v)
    if (used[v] && is_finite(mesh.vertices[v])) {
      points.emplace_back(mesh.vertices[v]);
      numbers.push_back(static_cast<std::uint32_t>(v));
    }
  std::vector<std::uint32_t> chosen = poisson_discs(points, spacing);
  for (std::uint32_t& c : chosen) c = numbers[c];
  return chosen;
}

}  // namespace sansmesh::inline v1
