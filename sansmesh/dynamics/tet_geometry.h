// Tetrahedral meshes: validation, volume, boundary.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/tet_mesh.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Corners of the edges of a tetrahedron.
inline constexpr std::uint8_t kTetEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/// Signed volume of tetrahedron `t` with its vertices at `x`; negative if it is inverted.
double tet_volume(const Tet& t, std::span<const Vec3> x);

/// Gradients of linear functions on a tetrahedron.
struct TetGradients {
  std::array<Vec3, 3> of;  ///< gradients of the barycentric coordinates of corners 1 to 3; that of corner 0 is minus
                           ///< their sum. Not finite where the volume is 0
  double volume = 0;       ///< signed
};
inline TetGradients tet_gradients(const Tet& t, std::span<const Vec3> x) {
  const Vec3 a = x[t[1]] - x[t[0]], b = x[t[2]] - x[t[0]], d = x[t[3]] - x[t[0]];
  const double six = dot(a, cross(b, d));
  return {{cross(b, d) / six, cross(d, a) / six, cross(a, b) / six}, six / 6};
}

/// Columns ∂y/∂x_k of the affine map that takes the corners to y; `gradients` are those of the undeformed corners.
inline Matrix3 tet_jacobian(const Tet& t, const std::array<Vec3, 3>& gradients, std::span<const Vec3> y) {
  const auto& g = gradients;
  const Vec3 a = y[t[1]] - y[t[0]], b = y[t[2]] - y[t[0]], d = y[t[3]] - y[t[0]];
  return {a * g[0].x + b * g[1].x + d * g[2].x, a * g[0].y + b * g[1].y + d * g[2].y,
          a * g[0].z + b * g[1].z + d * g[2].z};
}

/// Throws DataError that names the tetrahedron or vertex (counted from 0), the cause and a remedy: no tetrahedra,
/// positions that are not finite, indices out of range, repeated vertices, volumes that are negative (inverted) or zero
/// (below 1e-12 of the longest edge's cube).
void check_tets(const TetMesh& mesh);

/// The faces of exactly one tetrahedron, counter-clockwise seen from outside, by ascending tetrahedron. `owners`, if
/// given, receives the tetrahedron of each.
std::vector<Triangle> boundary_faces(const TetMesh& mesh, std::vector<std::uint32_t>* owners = nullptr);

/// The boundary as a mesh: only vertices of boundary faces, in ascending order, at `x` (one per vertex of the mesh),
/// relative to the centre of their box. `sources`, if given, receives the index in `mesh` of each vertex.
TriangleMesh boundary_mesh(const TetMesh& mesh, std::span<const Vec3> x, std::vector<std::uint32_t>* sources = nullptr);

}  // namespace sansmesh::inline v1
