#include "sansmesh/dynamics/tet_embedding.h"

#include <string>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/dynamics/tet_map.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_closest.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kEmbeddedRange = 1024;  ///< points per task

}  // namespace

TetEmbedding::TetEmbedding(const TetMesh& rest, std::span<const Vec3> points)
    : tets_(points.size()), weights_(points.size()), corners_(points.size()), gradients_(points.size()) {
  check_tets(rest);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_finite(points[i])) {
      throw DataError("point " + std::to_string(i) + " (counted from 0) has a position that is not finite");
    }
  }
  const TetMap tets(rest.tets, rest.vertices, rest.vertices);
  tets.find(points, tets_);

  std::vector<std::size_t> beyond;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (tets_[i] == TetMap::kNowhere) beyond.push_back(i);
  }
  outside_ = beyond.size();
  if (!beyond.empty()) {
    std::vector<std::uint32_t> owners;
    TriangleMesh boundary;
    boundary.triangles = boundary_faces(rest, &owners);
    boundary.origin = bounds(rest).center();
    for (const Vec3& p : rest.vertices) boundary.vertices.emplace_back(p - boundary.origin);
    const ClosestTriangle closest(boundary);
    parallel_for(0, beyond.size(), 256, [&](std::size_t k) {
      tets_[beyond[k]] = owners[closest.closest(points[beyond[k]] - boundary.origin).triangle];
    });
  }

  parallel_for(0, points.size(), kEmbeddedRange, [&](std::size_t i) {
    const Tet& c = rest.tets[tets_[i]];
    const Vec3 p = points[i] - rest.vertices[c[0]];
    corners_[i] = c;
    gradients_[i] = tet_gradients(c, rest.vertices).of;
    const double u = dot(gradients_[i][0], p), v = dot(gradients_[i][1], p), w = dot(gradients_[i][2], p);
    weights_[i] = {1 - u - v - w, u, v, w};
  });
}

std::vector<Vec3> TetEmbedding::positions(std::span<const Vec3> x) const {
  std::vector<Vec3> found(corners_.size());
  parallel_for(0, found.size(), kEmbeddedRange, [&](std::size_t i) {
    const Tet& c = corners_[i];
    const auto& w = weights_[i];
    found[i] = x[c[0]] * w[0] + x[c[1]] * w[1] + x[c[2]] * w[2] + x[c[3]] * w[3];
  });
  return found;
}

std::vector<Vec3> TetEmbedding::normals(std::span<const Vec3> x, std::span<const Vec3> at_rest) const {
  std::vector<Vec3> found(corners_.size());
  parallel_for(0, found.size(), kEmbeddedRange, [&](std::size_t i) {
    // Cofactors of J: its inverse transpose times its determinant, whose sign matters in inverted tetrahedra.
    const Matrix3 j = tet_jacobian(corners_[i], gradients_[i], x);
    const Vec3 n = at_rest[i];
    found[i] = normalized(cross(j.b, j.c) * n.x + cross(j.c, j.a) * n.y + cross(j.a, j.b) * n.z);
  });
  return found;
}

}  // namespace sansmesh::inline v1
