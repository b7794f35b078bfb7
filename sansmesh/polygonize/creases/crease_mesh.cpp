#include "sansmesh/polygonize/creases/crease_mesh.h"

#include <algorithm>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/edit/simplify.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/polygonize/creases/crease_thin.h"
#include "sansmesh/polygonize/creases/crease_zone.h"
#include "sansmesh/polygonize/pieces/piece_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kNone = CreaseZone::kNone;
constexpr int kZoneRings = 3;
/// Long triangles along flat faces and cylinders are accepted: only the surface error counts.
constexpr double kLeastShape = 0.25;
/// Fraction of the simplification error allowed for collapses without quadrics, in parts that are flat up to rounding.
constexpr double kThin = 0.1;

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

MeshTopology zone_topology(const std::vector<Triangle>& triangles, const std::vector<Vec3>& x) {
  TriangleMesh mesh;
  mesh.triangles = triangles;
  mesh.vertices.resize(x.size());
  parallel_for(0, x.size(), 8192, [&](std::size_t v) { mesh.vertices[v] = Vec3f(x[v]); });
  return measure_topology(mesh);
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

  const MeshTopology before = zone_topology(zone_triangles, zone_x);
  CreaseZone zone(field, std::move(zone_triangles), std::move(zone_x));
  zone.resolve();
  std::vector<Triangle> resolved;
  for (std::size_t t = 0; t < zone.surface.triangles(); ++t)
    if (zone.surface.alive(t)) resolved.push_back(zone.surface[t]);
  const MeshTopology after = zone_topology(resolved, zone.x);
  // The zone may touch itself at a vertex of its border.
  if (after.nonmanifold_edges > 0 || after.nonmanifold_vertices != before.nonmanifold_vertices || !after.oriented() ||
      after.euler != before.euler || after.boundary_edges != before.boundary_edges) {
    // Only for fields that contradict themselves: keep the original mesh, which is at least closed.
    mesh.triangles = triangles;
    mesh.piece.resize(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto [a, b, c] = triangles[t];
      mesh.piece[t] = active[a] == active[b] && active[b] == active[c] ? active[a] : kNone;
    }
    return mesh;
  }
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
  drop_unused_vertices(mesh);  // vertices merged above
  return mesh;
}

}  // namespace

TriangleMesh polygonize_with_creases(const PiecewiseField& field, BlockTree blocks, const Vec3& origin,
                                     const PolygonizeOptions& options, Progress& progress) {
  PolygonizeOptions smooth = options;
  smooth.creases = smooth.balance = false;
  smooth.simplify = 0;
  smooth.triangles = 0;
  smooth.placement = nullptr;
  const Box3 cube = blocks.bounds();
  TriangleMesh mesh = polygonize(field, std::move(blocks), origin, smooth, progress);
  progress.begin("creases");
  PieceMesh pieces = resolve_creases(field, positions(mesh), mesh.triangles);
  const auto set_positions = [&] {
    mesh.vertices.resize(pieces.x.size());
    parallel_for(0, pieces.x.size(), 8192, [&](std::size_t v) {
      for (std::size_t k = 0; k < 3; ++k) pieces.x[v][k] = std::clamp(pieces.x[v][k], cube.lower[k], cube.upper[k]);
      mesh.vertices[v] = Vec3f(pieces.x[v] - origin);
    });
  };
  if (options.simplify > 0) {
    progress.begin("thin flat parts");
    thin_flat_parts(pieces, kThin * options.simplify);
    progress.begin("simplify");
    mesh.normals.clear();
    mesh.triangles = pieces.triangles;
    set_positions();
    CollapseOptions simplify;
    simplify.error = options.simplify;
    simplify.triangles = options.triangles;
    simplify.least_gain = options.least_gain;
    simplify.least_shape = options.triangles > 0 ? kLeastShapeOfNumber : kLeastShape;
    const bool changed = simplify_mesh(mesh, simplify, progress);
    progress.begin("place vertices again");
    if (changed) pieces = recall_pieces(field, positions(mesh), std::move(mesh.triangles));
  }
  if (options.balance) balance_pieces(field, pieces);
  mesh.normals = piece_normals(field, pieces);
  set_positions();
  mesh.triangles = std::move(pieces.triangles);
  progress.finish();
  return mesh;
}

}  // namespace sansmesh::inline v1
