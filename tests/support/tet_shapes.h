// Tetrahedral meshes of boxes, and refined meshes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "sansmesh/core/edge_key.h"
#include "sansmesh/dynamics/tet_geometry.h"

namespace sansmesh::test {

/// A box from `lower` to `upper` divided into nx × ny × nz cells of six tetrahedra each; vertex (i, j, k) has index i +
/// (nx + 1) (j + (ny + 1) k).
inline TetMesh box_of_tets(const Vec3& lower, const Vec3& upper, std::size_t nx, std::size_t ny, std::size_t nz) {
  TetMesh mesh;
  const Vec3 size = upper - lower;
  for (std::size_t k = 0; k <= nz; ++k)
    for (std::size_t j = 0; j <= ny; ++j)
      for (std::size_t i = 0; i <= nx; ++i)
        mesh.vertices.push_back(lower + Vec3{size.x * static_cast<double>(i) / static_cast<double>(nx),
                                             size.y * static_cast<double>(j) / static_cast<double>(ny),
                                             size.z * static_cast<double>(k) / static_cast<double>(nz)});
  const std::size_t stride[3] = {1, nx + 1, (nx + 1) * (ny + 1)};
  // Kuhn's six tetrahedra: along the edges from corner to corner, for each order of the axes.
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (std::size_t k = 0; k < nz; ++k)
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t i = 0; i < nx; ++i)
        for (int o = 0; o < 6; ++o) {
          std::size_t at = i + stride[1] * j + stride[2] * k;
          Tet t{static_cast<std::uint32_t>(at)};
          for (std::size_t c = 0; c < 3; ++c) t[c + 1] = static_cast<std::uint32_t>(at += stride[kOrders[o][c]]);
          if (o >= 3) std::swap(t[2], t[3]);
          mesh.tets.push_back(t);
        }
  return mesh;
}

/// Divides each tetrahedron into eight at the midpoints of its edges: four at the corners, and the octahedron between
/// them along its shortest diagonal. The mesh's vertices come first, then the midpoints. Tetrahedra 8 t .. 8 t + 7 come
/// from t.
inline TetMesh refine_uniformly(const TetMesh& mesh) {
  TetMesh fine;
  fine.vertices = mesh.vertices;
  std::map<std::uint64_t, std::uint32_t> midpoints;
  // Midpoints of the edges: 4 of 01, 5 of 02, 6 of 03, 7 of 12, 8 of 13, 9 of 23. Opposite pairs are the ends of the
  // diagonals; the other four surround each.
  constexpr int kEnds[3][2] = {{4, 9}, {5, 8}, {6, 7}};
  constexpr int kRing[3][4] = {{5, 7, 8, 6}, {4, 7, 9, 6}, {4, 8, 9, 5}};
  constexpr int kCorners[4][4] = {{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3}};
  for (const Tet& tet : mesh.tets) {
    std::uint32_t v[10];
    std::copy(tet.begin(), tet.end(), v);
    for (std::size_t e = 0; e < 6; ++e) {
      const std::uint32_t a = v[kTetEdges[e][0]], b = v[kTetEdges[e][1]];
      const auto [at, is_new] = midpoints.try_emplace(edge_key(a, b), static_cast<std::uint32_t>(fine.vertices.size()));
      if (is_new) fine.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]) * 0.5);
      v[4 + e] = at->second;
    }
    const auto length = [&](int d) {
      return squared_norm(fine.vertices[v[kEnds[d][0]]] - fine.vertices[v[kEnds[d][1]]]);
    };
    const std::array<double, 3> lengths{length(0), length(1), length(2)};
    const auto d = std::min_element(lengths.begin(), lengths.end()) - lengths.begin();
    for (const auto& c : kCorners) fine.tets.push_back({v[c[0]], v[c[1]], v[c[2]], v[c[3]]});
    for (int k = 0; k < 4; ++k)
      fine.tets.push_back({v[kEnds[d][0]], v[kEnds[d][1]], v[kRing[d][k]], v[kRing[d][(k + 1) % 4]]});
    for (std::size_t k = fine.tets.size() - 8; k < fine.tets.size(); ++k)
      if (tet_volume(fine.tets[k], fine.vertices) < 0) std::swap(fine.tets[k][2], fine.tets[k][3]);
  }
  return fine;
}

/// The same mesh with positive volumes.
inline TetMesh turned_outward(TetMesh mesh) {
  for (Tet& t : mesh.tets)
    if (tet_volume(t, mesh.vertices) < 0) std::swap(t[2], t[3]);
  return mesh;
}

}  // namespace sansmesh::test
