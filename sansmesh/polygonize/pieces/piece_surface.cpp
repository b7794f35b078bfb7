#include "sansmesh/polygonize/pieces/piece_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/repair/self_intersections.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/polygonize/pieces/piece_blocks.h"
#include "sansmesh/polygonize/pieces/piece_cut.h"
#include "sansmesh/polygonize/pieces/piece_mesher.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::array<double, 4> kTries{0, 0.137, 0.291, 0.613};
/// Depth of intersection, over the box's size, from which the mesh counts as self-intersecting.
constexpr double kCrossing = 1e-7;
/// Number of simplifications, each keeping more of the mesh unsimplified where it intersected itself; then none.
constexpr int kMostSimplifications = 4;
/// Number of local restorations before that, each a ring wider.
constexpr int kMostRestored = 5;
/// Radius of the unsimplified region around intersecting triangles in triangle radii, and its increase per attempt.
constexpr double kKeptRadius = 1.2, kKeptMore = 0.8;

template <class At>
double enclosed(const std::vector<Triangle>& triangles, At&& at) {
  double six = 0;
  for (const auto& [a, b, c] : triangles) six += dot(at(a), cross(at(b), at(c)));
  return six / 6;
}

bool closed(const CutPieces& cut) {
  TriangleMesh mesh;
  mesh.triangles = cut.triangles;
  mesh.vertices.resize(cut.vertices.size());
  parallel_for(0, cut.vertices.size(), 8192, [&](std::size_t v) { mesh.vertices[v] = Vec3f(cut.vertices[v].x); });
  return cut.triangles.empty() || measure_topology(mesh).closed();
}

/// The pieces cut out of a lattice without cracks; nothing if that takes too many blocks.
CutPieces closed_cut(const PieceExpression& field, const Box3& box, const PieceSurfaceOptions& options,
                     Progress& progress, PieceSurfaceReport& report) {
  for (std::size_t attempt = 0;; ++attempt) {
    const PieceBlocks blocks =
        piece_blocks(field, box, {options.mesh_error, options.cell, options.most_blocks}, kTries[attempt], progress);
    if (blocks.too_many) {
      report.too_many = true;
      return {};
    }
    report.cell = blocks.tree.edge() / static_cast<double>(1u << blocks.tree.depth());
    report.depth = blocks.tree.depth();
    report.blocks = blocks.tree.leaves().size();
    report.unresolved = blocks.unresolved;
    CutPieces cut = cut_pieces(field, blocks, progress);
    if (!cut.crowded && !cut.cracked && closed(cut)) return cut;
    if (const std::optional<Vec3>& at = cut.crowded)  // independent of the lattice points
      throw DataError(
          fmt::format("more than {} faces meet at one point, near ({:.4g}, {:.4g}, {:.4g}): clip that "
                      "region, or model it with fewer faces or a cone{}",
                      kMostPiecesInBlock, at->x, at->y, at->z,
                      options.cell > 0 ? "; or they do not, and a smaller `cell` helps" : ""));
    if (attempt + 1 < kTries.size()) continue;
    if (const std::optional<Vec3>& at = cut.cracked)
      throw DataError(
          fmt::format("the surface could not be closed near ({:.4g}, {:.4g}, {:.4g}): pieces cross there in more ways "
                      "than rounding can separate; move one of them slightly",
                      at->x, at->y, at->z));
    throw DataError("the surface could not be closed: too many pieces meet at one point; move one of them slightly");
  }
}

/// The mesh with improvements undone around its intersections; nothing if others remain.
std::optional<TriangleMesh> restored(PieceMesher& mesher, Crossings left, const CutPieces& placed,
                                     const CutPieces& linear, const Vec3& origin, double tolerance) {
  for (int rings = 0; rings < kMostRestored; ++rings) {
    mesher.restore(left, placed, linear, rings);
    if (!closed(mesher.mesh)) break;  // merging may have joined two regions that other vertices kept apart
    TriangleMesh mixed = mesher.finished(origin, true);
    left = self_intersections(mixed, tolerance);
    if (left.empty()) return mixed;
  }
  return std::nullopt;
}

/// Places and simplifies the cut such that no triangles intersect.
TriangleMesh simple_mesh(PieceMesher& mesher, const Vec3& origin, double tolerance, const PieceSurfaceOptions& options,
                         Progress& progress, PieceSurfaceReport& report) {
  CutPieces& mesh = mesher.mesh;
  progress.begin("place vertices");
  mesher.spread_room();
  mesher.name_pieces();
  const CutPieces linear = mesh;  // free of self-intersections
  mesher.place_vertices();
  const std::vector<std::uint8_t> narrow = mesher.narrow();
  mesher.take_back(linear, origin, tolerance, &narrow);
  CutPieces placed = mesh;
  for (int attempt = 0;; ++attempt) {
    const bool simplified = attempt < kMostSimplifications;
    if (simplified) mesher.improve(origin, progress);
    TriangleMesh result = mesher.finished(origin, !simplified);
    progress.begin("look for intersections");
    const Crossings crossing = self_intersections(result, tolerance);
    report.unsimplified = !simplified;
    if (crossing.empty()) return result;
    if (simplified && options.triangles == 0)
      if (std::optional<TriangleMesh> mixed = restored(mesher, crossing, placed, linear, origin, tolerance))
        return *std::move(mixed);
    if (!simplified) {
      const Vec3 at = origin + Vec3(result.vertices[result.triangles[crossing[0][0]][0]]);
      throw DataError(fmt::format(
          "the mesh would intersect itself at {} places, such as ({:.4g}, {:.4g}, {:.4g}): give a smaller `cell` or "
          "mesh error than {:.2g}",
          crossing.size(), at.x, at.y, at.z, options.mesh_error));
    }
    // Return to the mesh before improvements, free of intersections, and keep it unimproved near those found.
    mesh = placed;
    const std::vector<std::uint8_t> kept = mesher.keep_around(result, crossing, kKeptRadius + kKeptMore * attempt);
    mesher.take_back(linear, origin, tolerance, attempt + 1 < kMostSimplifications ? &kept : nullptr);
    placed = mesh;
  }
}

void measure_errors(const PieceMesher& mesher, const TriangleMesh& result, PieceSurfaceReport& report) {
  const CutPieces& mesh = mesher.mesh;
  std::vector<double> distance;
  mesher.normals_of_triangles(&distance);
  double area = 0, sum = 0;
  for (std::size_t t = 0; t < distance.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const double w = norm(cross(mesh.vertices[b].x - mesh.vertices[a].x, mesh.vertices[c].x - mesh.vertices[a].x));
    area += w, sum += w * distance[t];
    report.largest_error = std::max(report.largest_error, distance[t]);
  }
  report.mean_error = area > 0 ? sum / area : 0;
  const double volume = enclosed(mesh.triangles, [&](std::uint32_t v) { return mesh.vertices[v].x - result.origin; });
  const double rounded = enclosed(result.triangles, [&](std::uint32_t v) { return Vec3(result.vertices[v]); });
  report.rounded_away = volume == rounded ? 0 : std::abs(rounded - volume) / std::max(volume, 0.0);
}

}  // namespace

TriangleMesh polygonize_pieces(const PieceExpression& field, const Box3& box, const Vec3& origin,
                               const PieceSurfaceOptions& options, Progress& progress, PieceSurfaceReport& report) {
  const double scale = box.diagonal();
  PieceMesher mesher(field, options, scale);
  report = {};
  mesher.mesh = closed_cut(field, box, options, progress, report);
  if (report.too_many) return {};
  TriangleMesh result = simple_mesh(mesher, origin, kCrossing * scale, options, progress, report);
  result.normals = mesher.normals();
  measure_errors(mesher, result, report);
  progress.finish();
  return result;
}

}  // namespace sansmesh::inline v1
