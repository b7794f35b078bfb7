#include "sansmesh/render/scene/mesh_wires.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "sansmesh/search/equal_positions.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kNoOther = std::numeric_limits<std::uint32_t>::max();

struct WireEdge {
  std::uint32_t a, b, triangle, corner;
  bool operator<(const WireEdge& o) const {
    return std::tie(a, b, triangle, corner) < std::tie(o.a, o.b, o.triangle, o.corner);
  }
};

}  // namespace

MeshWires::MeshWires(const TriangleMesh& mesh, const Camera& camera, int height, int samples, double width)
    : mesh_(&mesh),
      camera_(camera),
      pixel_(2 * camera.half_height / static_cast<float>(height)),
      half_(static_cast<float>(0.5 * width)),
      sharpness_(static_cast<float>(samples)),
      others_(mesh.triangles.size(), {kNoOther, kNoOther, kNoOther}) {
  // Seams are no borders.
  const std::vector<std::uint32_t> representative = first_equal_positions(mesh.vertices);
  std::vector<WireEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = representative[mesh.triangles[t][(k + 1) % 3]],
                          b = representative[mesh.triangles[t][(k + 2) % 3]];
      edges.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  std::sort(edges.begin(), edges.end());
  // Where more than two triangles meet, their lines are drawn in full.
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].a == edges[i].a && edges[end].b == edges[i].b) ++end;
    if (end == i + 2) {
      others_[edges[i].triangle][edges[i].corner] = edges[i + 1].triangle;
      others_[edges[i + 1].triangle][edges[i + 1].corner] = edges[i].triangle;
    }
    i = end;
  }
}

Vec3f MeshWires::normal(std::uint32_t triangle) const {
  const Triangle& t = mesh_->triangles[triangle];
  const std::vector<Vec3f>& v = mesh_->vertices;
  return cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]);
}

float MeshWires::cover(const RayHit& hit, const Vec3f& origin, const Vec3f& direction) const {
  const Triangle& t = mesh_->triangles[hit.primitive];
  const Vec3f corners[3] = {mesh_->vertices[t[0]], mesh_->vertices[t[1]], mesh_->vertices[t[2]]};
  const Vec3f n = normal(hit.primitive);
  const float area = squared_norm(n);  // four times its square
  const float ahead = -dot(direction, camera_.backward), facing = dot(n, direction);
  if (!(area > 0) || !(ahead > 0) || facing == 0) return 0;
  // Displacement on the triangle's plane for one pixel to the right and one pixel up.
  const float step = pixel_ * camera_.shrink(hit.distance * ahead);
  const auto moved = [&](const Vec3f& axis) { return step * (axis - direction * (dot(n, axis) / facing)); };
  const Vec3f right = moved(camera_.right), up = moved(camera_.up);
  const float weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
  const Vec3f at = origin + hit.distance * direction;
  float most = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    // The weight of a corner decreases to 0 at the opposite edge.
    const Vec3f slope = cross(n, corners[(k + 2) % 3] - corners[(k + 1) % 3]);
    const float a_pixel = std::hypot(dot(slope, right), dot(slope, up)) / area;
    if (!(a_pixel > 0)) continue;
    const float pixels = std::max(0.0f, weights[k]) / a_pixel;
    if (pixels > 2 * half_ + 1) continue;
    const std::uint32_t other = others_[hit.primitive][k];
    bool shared = other != kNoOther;
    if (shared) {
      // Oriented like this one, and visible from the same side.
      const Vec3f ray = camera_.parallel ? direction : at - origin;
      shared = (dot(normal(other), ray) > 0) == (facing > 0);
    }
    const float reach = shared ? half_ : 2 * half_;
    most = std::max(most, std::clamp((reach - pixels) * sharpness_ + 0.5f, 0.0f, 1.0f));
  }
  return most;
}

}  // namespace sansmesh::inline v1
