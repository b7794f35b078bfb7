#include "sansmesh/dynamics/tet_geometry.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "sansmesh/core/edge_key.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Corners of the face opposite to each corner, counter-clockwise seen from outside.
constexpr int kTetFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

double longest_edge(const Tet& t, std::span<const Vec3> x) {
  double longest = 0;
  for (const auto& e : kTetEdges) longest = std::max(longest, norm(x[t[e[1]]] - x[t[e[0]]]));
  return longest;
}

/// The eight tetrahedra of one, given by its corners 0..3 and the midpoints 4..9 of its edges; `diagonal` selects two
/// opposite midpoints.
struct EightTets {
  std::array<std::array<int, 4>, 8> tets;
};

EightTets eight_tets(int diagonal) {
  // Midpoints: 4 of 01, 5 of 02, 6 of 03, 7 of 12, 8 of 13, 9 of 23. Opposite pairs: 4 and 9, 5 and 8, 6 and 7; the
  // other four surround each diagonal.
  constexpr int kEnds[3][2] = {{4, 9}, {5, 8}, {6, 7}};
  constexpr int kRing[3][4] = {{5, 7, 8, 6}, {4, 7, 9, 6}, {4, 8, 9, 5}};
  EightTets eight{{{{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3}}}};
  for (int k = 0; k < 4; ++k) {
    eight.tets[static_cast<std::size_t>(4 + k)] = {kEnds[diagonal][0], kEnds[diagonal][1], kRing[diagonal][k],
                                                   kRing[diagonal][(k + 1) % 4]};
  }
  return eight;
}

}  // namespace

double tet_volume(const Tet& t, std::span<const Vec3> x) {
  const Vec3 a = x[t[0]];
  return dot(x[t[1]] - a, cross(x[t[2]] - a, x[t[3]] - a)) / 6;
}

TetMesh turned_outward(TetMesh mesh, std::size_t* turned) {
  std::size_t count = 0;
  for (Tet& t : mesh.tets) {
    const bool known = std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < mesh.vertices.size(); });
    if (known && tet_volume(t, mesh.vertices) < 0) std::swap(t[2], t[3]), ++count;
  }
  if (turned) *turned = count;
  return mesh;
}

void check_tets(const TetMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  if (mesh.tets.empty()) throw DataError("no tetrahedra: a body needs at least one");
  for (std::size_t v = 0; v < n; ++v) {
    if (!is_finite(mesh.vertices[v])) {
      throw DataError("vertex " + std::to_string(v) + " (counted from 0) has a position that is not finite");
    }
  }
  for (std::size_t k = 0; k < mesh.tets.size(); ++k) {
    const Tet& t = mesh.tets[k];
    const auto name = [&] { return "tetrahedron " + std::to_string(k) + " (counted from 0) "; };
    for (const std::uint32_t v : t) {
      if (v >= n) {
        throw DataError(name() + "has vertex " + std::to_string(v) + ", but there are only " + grouped(n) +
                        ": are they counted from 1?");
      }
    }
    const double longest = longest_edge(t, mesh.vertices), volume = tet_volume(t, mesh.vertices);
    if (!(volume > 1e-12 * longest * longest * longest)) {
      if (volume < -1e-12 * longest * longest * longest) {
        throw DataError(name() + "is inside out: exchange two of its vertices");
      }
      throw DataError(name() + "has no volume: leave it out, or improve the mesh");
    }
  }
}

TetMesh refine_uniformly(const TetMesh& mesh) {
  std::vector<std::uint64_t> keys(6 * mesh.tets.size());
  parallel_for(0, mesh.tets.size(), 4096, [&](std::size_t k) {
    const Tet& t = mesh.tets[k];
    for (std::size_t e = 0; e < 6; ++e) keys[6 * k + e] = edge_key(t[kTetEdges[e][0]], t[kTetEdges[e][1]]);
  });
  parallel_sort(keys);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());

  TetMesh fine;
  fine.vertices.reserve(mesh.vertices.size() + keys.size());
  fine.vertices = mesh.vertices;
  for (const std::uint64_t key : keys) {
    fine.vertices.push_back((mesh.vertices[smaller_end(key)] + mesh.vertices[larger_end(key)]) * 0.5);
  }
  fine.tets.resize(8 * mesh.tets.size());
  parallel_for(0, mesh.tets.size(), 1024, [&](std::size_t k) {
    std::uint32_t v[10];
    std::copy(mesh.tets[k].begin(), mesh.tets[k].end(), v);
    for (std::size_t e = 0; e < 6; ++e) {
      const auto at = std::lower_bound(keys.begin(), keys.end(), edge_key(v[kTetEdges[e][0]], v[kTetEdges[e][1]]));
      v[4 + e] = static_cast<std::uint32_t>(mesh.vertices.size() + static_cast<std::size_t>(at - keys.begin()));
    }
    const auto length = [&](int a, int b) { return squared_norm(fine.vertices[v[a]] - fine.vertices[v[b]]); };
    const double lengths[3] = {length(4, 9), length(5, 8), length(6, 7)};
    const auto eight = eight_tets(static_cast<int>(std::min_element(lengths, lengths + 3) - lengths));
    for (std::size_t c = 0; c < 8; ++c) {
      Tet& t = fine.tets[8 * k + c];
      for (std::size_t i = 0; i < 4; ++i) t[i] = v[eight.tets[c][i]];
      if (tet_volume(t, fine.vertices) < 0) std::swap(t[2], t[3]);
    }
  });
  return fine;
}

std::vector<Triangle> boundary_faces(const TetMesh& mesh, std::vector<std::uint32_t>* owners) {
  struct Face {
    Triangle sorted;
    std::uint32_t number;  // 4 tetrahedron + opposite corner
  };
  std::vector<Face> faces(4 * mesh.tets.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Tet& t = mesh.tets[f / 4];
    Triangle s{t[kTetFaces[f % 4][0]], t[kTetFaces[f % 4][1]], t[kTetFaces[f % 4][2]]};
    std::sort(s.begin(), s.end());
    faces[f] = {s, static_cast<std::uint32_t>(f)};
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.sorted != b.sorted ? a.sorted < b.sorted : a.number < b.number;
  });
  std::vector<std::uint32_t> single;
  for (std::size_t f = 0; f < faces.size();) {
    std::size_t end = f + 1;
    while (end < faces.size() && faces[end].sorted == faces[f].sorted) ++end;
    if (end == f + 1) single.push_back(faces[f].number);
    f = end;
  }
  std::sort(single.begin(), single.end());
  std::vector<Triangle> boundary;
  boundary.reserve(single.size());
  if (owners) owners->clear();
  for (const std::uint32_t f : single) {
    const Tet& t = mesh.tets[f / 4];
    boundary.push_back({t[kTetFaces[f % 4][0]], t[kTetFaces[f % 4][1]], t[kTetFaces[f % 4][2]]});
    if (owners) owners->push_back(f / 4);
  }
  return boundary;
}

TriangleMesh boundary_mesh(const TetMesh& mesh, std::span<const Vec3> x, std::vector<std::uint32_t>* sources) {
  TriangleMesh surface;
  surface.triangles = boundary_faces(mesh);
  constexpr std::uint32_t kUnused = 0xffffffffu;
  std::vector<std::uint32_t> place(mesh.vertices.size(), kUnused);
  for (const Triangle& t : surface.triangles) {
    for (const std::uint32_t v : t) place[v] = 0;
  }
  std::vector<std::uint32_t> used;
  Box3 box;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == kUnused) continue;
    place[v] = static_cast<std::uint32_t>(used.size());
    used.push_back(static_cast<std::uint32_t>(v));
    box.extend(x[v]);
  }
  if (!used.empty()) surface.origin = box.center();
  for (const std::uint32_t v : used) surface.vertices.emplace_back(x[v] - surface.origin);
  for (Triangle& t : surface.triangles) {
    for (std::uint32_t& v : t) v = place[v];
  }
  if (sources) *sources = std::move(used);
  return surface;
}

TetMesh box_of_tets(const Vec3& lower, const Vec3& upper, std::size_t nx, std::size_t ny, std::size_t nz) {
  TetMesh mesh;
  const Vec3 size = upper - lower;
  for (std::size_t k = 0; k <= nz; ++k) {
    for (std::size_t j = 0; j <= ny; ++j) {
      for (std::size_t i = 0; i <= nx; ++i) {
        mesh.vertices.push_back(lower + Vec3{size.x * static_cast<double>(i) / static_cast<double>(nx),
                                             size.y * static_cast<double>(j) / static_cast<double>(ny),
                                             size.z * static_cast<double>(k) / static_cast<double>(nz)});
      }
    }
  }
  const std::size_t stride[3] = {1, nx + 1, (nx + 1) * (ny + 1)};
  // Kuhn's six tetrahedra: along the edges from corner to corner, for each order of the axes.
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (std::size_t k = 0; k < nz; ++k) {
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i) {
        for (int o = 0; o < 6; ++o) {
          std::size_t at = i + stride[1] * j + stride[2] * k;
          Tet t{static_cast<std::uint32_t>(at)};
          for (std::size_t c = 0; c < 3; ++c) t[c + 1] = static_cast<std::uint32_t>(at += stride[kOrders[o][c]]);
          if (o >= 3) std::swap(t[2], t[3]);
          mesh.tets.push_back(t);
        }
      }
    }
  }
  return mesh;
}

}  // namespace sansmesh::inline v1
