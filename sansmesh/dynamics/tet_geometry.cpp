#include "sansmesh/dynamics/tet_geometry.h"

#include <algorithm>
#include <string>
#include <utility>

#include "sansmesh/core/number_words.h"
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

}  // namespace

double tet_volume(const Tet& t, std::span<const Vec3> x) {
  const Vec3 a = x[t[0]];
  return dot(x[t[1]] - a, cross(x[t[2]] - a, x[t[3]] - a)) / 6;
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
  std::vector<std::uint32_t> renumbered(mesh.vertices.size(), kUnused);
  for (const Triangle& t : surface.triangles) {
    for (const std::uint32_t v : t) renumbered[v] = 0;
  }
  std::vector<std::uint32_t> used;
  Box3 box;
  for (std::size_t v = 0; v < renumbered.size(); ++v) {
    if (renumbered[v] == kUnused) continue;
    renumbered[v] = static_cast<std::uint32_t>(used.size());
    used.push_back(static_cast<std::uint32_t>(v));
    box.extend(x[v]);
  }
  if (!used.empty()) surface.origin = box.center();
  for (const std::uint32_t v : used) surface.vertices.emplace_back(x[v] - surface.origin);
  for (Triangle& t : surface.triangles) {
    for (std::uint32_t& v : t) v = renumbered[v];
  }
  if (sources) *sources = std::move(used);
  return surface;
}

}  // namespace sansmesh::inline v1
