#include "sansmesh/polygonize/crease_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/polygonize/crease_zone.h"
#include "sansmesh/polygonize/mesh_topology.h"
#include "sansmesh/polygonize/simplify.h"

namespace sansmesh {
namespace {

constexpr std::uint32_t kNone = CreaseZone::kNone;
constexpr int kZoneRings = 3;

/// A mesh in double precision whose triangles know their pieces.
struct PieceMesh {
  std::vector<Vec3> x;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> piece;  ///< of each triangle, or kNone
  std::vector<std::uint8_t> rank;    ///< of each vertex: 0 not on the surface, 1 smooth, 2 crease, 3 corner
};

std::vector<Vec3> positions(const TriangleMesh& mesh) {
  std::vector<Vec3> x(mesh.vertices.size());
  parallel_for(0, x.size(), 8192, [&](std::size_t v) { x[v] = mesh.origin + Vec3(mesh.vertices[v]); });
  return x;
}

/// Triangles within kZoneRings rings around those whose vertices have different pieces.
std::vector<std::uint8_t> find_zone(const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& active) {
  std::vector<std::uint8_t> near(active.size(), 0), in(triangles.size(), 0);
  for (const Triangle& t : triangles)
    if (active[t[0]] != active[t[1]] || active[t[1]] != active[t[2]]) near[t[0]] = near[t[1]] = near[t[2]] = 1;
  for (int ring = 0; ring < kZoneRings; ++ring) {
    parallel_for(0, triangles.size(), 8192, [&](std::size_t t) {
      const auto [a, b, c] = triangles[t];
      in[t] = near[a] || near[b] || near[c];
    });
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (in[t]) near[triangles[t][0]] = near[triangles[t][1]] = near[triangles[t][2]] = 1;
  }
  return in;
}

/// The mesh with creases resolved in its zone.
PieceMesh resolve_creases(const PiecewiseField& field, const std::vector<Vec3>& x,
                          const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> active(x.size());
  field.active(x, active);
  const std::vector<std::uint8_t> in = find_zone(triangles, active);
  PieceMesh mesh;
  std::vector<std::uint32_t> local(x.size(), kNone), global;
  std::vector<Triangle> zone_triangles;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (in[t])
      for (const std::uint32_t v : triangles[t]) local[v] = 0;
  std::vector<Vec3> zone_x;
  for (std::uint32_t v = 0; v < x.size(); ++v) {
    if (local[v] == kNone) continue;
    local[v] = static_cast<std::uint32_t>(global.size());
    global.push_back(v);
    zone_x.push_back(x[v]);
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [a, b, c] = triangles[t];
    if (in[t]) {
      zone_triangles.push_back({local[a], local[b], local[c]});
    } else {
      mesh.triangles.push_back(triangles[t]);
      mesh.piece.push_back(active[a]);
    }
  }
  mesh.x = x;
  mesh.rank.assign(x.size(), 1);
  if (zone_triangles.empty()) return mesh;

  CreaseZone zone(field, std::move(zone_triangles), std::move(zone_x));
  zone.resolve();
  for (std::uint32_t v = 0; v < zone.x.size(); ++v) {
    if (v >= global.size()) {
      global.push_back(static_cast<std::uint32_t>(mesh.x.size()));
      mesh.x.emplace_back();
      mesh.rank.push_back(0);
    }
    mesh.x[global[v]] = zone.x[v];
    mesh.rank[global[v]] = zone.label[v].rank;
  }
  for (std::size_t t = 0; t < zone.surface.triangles(); ++t) {
    if (!zone.surface.alive(t)) continue;
    const auto [a, b, c] = zone.surface[t];
    mesh.triangles.push_back({global[a], global[b], global[c]});
    mesh.piece.push_back(zone.piece[t]);
  }
  // Merged vertices go.
  std::vector<std::uint32_t> number(mesh.x.size(), kNone);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) number[v] = 0;
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNone) continue;
    number[v] = kept;
    mesh.x[kept] = mesh.x[v];
    mesh.rank[kept++] = mesh.rank[v];
  }
  mesh.x.resize(kept);
  mesh.rank.resize(kept);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
  return mesh;
}

/// Gradients of the pieces around each vertex, weighted by the triangles' angles there.
std::vector<Vec3f> piece_normals(const PiecewiseField& field, const PieceMesh& mesh) {
  std::vector<PieceValue> queries;
  std::vector<std::uint32_t> at;
  std::vector<double> weight;
  std::vector<Vec3> flat(mesh.x.size());
  // Smooth vertices have one piece; only the others need one for each triangle.
  std::vector<std::uint8_t> seen(mesh.x.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      const Vec3 a = mesh.x[mesh.triangles[t][(k + 1) % 3]] - mesh.x[v];
      const Vec3 b = mesh.x[mesh.triangles[t][(k + 2) % 3]] - mesh.x[v];
      const double angle = std::atan2(norm(cross(a, b)), dot(a, b));
      if (mesh.piece[t] == kNone || mesh.rank[v] == 0) {
        flat[v] += normalized(cross(a, b)) * angle;
        continue;
      }
      if (mesh.rank[v] == 1 && std::exchange(seen[v], std::uint8_t{1})) continue;
      queries.push_back({mesh.piece[t], mesh.x[v], 0, {}});
      at.push_back(v);
      weight.push_back(mesh.rank[v] == 1 ? 100 : angle);
    }
  evaluate_pieces(field, queries);
  for (std::size_t i = 0; i < at.size(); ++i) flat[at[i]] += normalized(queries[i].gradient) * weight[i];
  std::vector<Vec3f> normals(mesh.x.size());
  parallel_for(0, normals.size(), 4096, [&](std::size_t v) { normals[v] = Vec3f(normalized(flat[v])); });
  return normals;
}

}  // namespace

TriangleMesh polygonize_with_creases(const PiecewiseField& field, BlockTree blocks, const Vec3& origin,
                                     const PolygonizeOptions& options, Progress& progress) {
  PolygonizeOptions smooth = options;
  smooth.creases = smooth.balance = false;
  smooth.simplify = 0;
  smooth.triangles = 0;
  smooth.placement = nullptr;
  TriangleMesh mesh = polygonize(field, std::move(blocks), origin, smooth, progress);
  progress.begin("creases");
  const std::vector<Vec3> x = positions(mesh);
  PieceMesh pieces = resolve_creases(field, x, mesh.triangles);
  mesh.normals = piece_normals(field, pieces);
  mesh.triangles = std::move(pieces.triangles);
  mesh.vertices.resize(pieces.x.size());
  parallel_for(0, pieces.x.size(), 8192, [&](std::size_t v) { mesh.vertices[v] = Vec3f(pieces.x[v] - origin); });
  progress.finish();
  return mesh;
}

}  // namespace sansmesh
