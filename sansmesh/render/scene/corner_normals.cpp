#include "sansmesh/render/scene/corner_normals.h"

#include <cmath>
#include <numbers>
#include <span>

#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/vertex_corners.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr std::size_t kMostAround = 512;  // limit, because all pairs of triangles around a vertex are compared
const float kVertexCosine = std::cos(30 * std::numbers::pi_v<float> / 180);
const float kCreaseCosine = std::cos(35 * std::numbers::pi_v<float> / 180);

float corner_angle(const Vec3f& at, const Vec3f& b, const Vec3f& c) {
  const Vec3f u = b - at, v = c - at;
  return std::atan2(norm(cross(u, v)), dot(u, v));
}

}  // namespace

std::vector<Vec3f> corner_normals(const TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<Vec3f> face(count), result(3 * count);
  parallel_for(0, count, kGrain, [&](std::size_t i) {
    const Triangle& t = mesh.triangles[i];
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    face[i] = Vec3f(normalized(cross(b - a, c - a)));
  });

  const VertexCorners corners(mesh.triangles, mesh.vertices.size());
  const bool have = mesh.normals.size() == mesh.vertices.size();
  parallel_ranges(0, mesh.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3f> weighted;
    for (std::size_t v = begin; v < end; ++v) {
      const std::span<const std::uint32_t> around = corners[v];
      weighted.clear();
      for (const std::uint32_t c : around) {
        const Triangle& t = mesh.triangles[c / 3];
        const std::size_t k = c % 3;
        weighted.push_back(face[c / 3] * corner_angle(mesh.vertices[t[k]], mesh.vertices[t[(k + 1) % 3]],
                                                      mesh.vertices[t[(k + 2) % 3]]));
      }
      for (const std::uint32_t c : around) {
        const Vec3f& own = face[c / 3];
        if (have && dot(mesh.normals[v], own) >= kVertexCosine) {
          result[c] = normalized(mesh.normals[v]);
          continue;
        }
        if (around.size() > kMostAround) {
          result[c] = own;
          continue;
        }
        Vec3f sum;
        for (std::size_t o = 0; o < around.size(); ++o)
          if (dot(face[around[o] / 3], own) >= kCreaseCosine) sum += weighted[o];
        result[c] = squared_norm(sum) > 0 ? normalized(sum) : own;
      }
    }
  });
  return result;
}

}  // namespace sansmesh::inline v1
