#include "sansmesh/polygonize/pieces/piece_mesher.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/edit/simplify.h"
#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/polygonize/pieces/piece_merge.h"

namespace sansmesh::inline v1 {

namespace {

constexpr std::uint32_t kNoPiece = CutPieces::kNone;
constexpr int kNewtonSteps = 8;
/// Largest move of vertices to their pieces, over the edge of the blocks: for one piece, and where several meet.
constexpr double kReachOfOne = 0.3, kReachOfSeveral = 0.6;
/// Squared sine between two pieces, and determinant of three, below which no crease or corner is sought.
constexpr double kNoCrease = 1e-7, kNoCorner = 1e-5;
/// Largest distance of collapses over the blocks' edge; largest deviation from planes over the simplification error.
constexpr double kNear = 0.22, kFlatShare = 0.1;
constexpr double kNothing = 1e-7, kRounding = 1e-10;
/// Sheets closer to each other than kRoomToBalance mesh errors keep their distance: their error is limited to a
/// fraction of it.
constexpr double kShareOfRoom = 0.2, kFlatShareOfRoom = 1e-3;
constexpr double kRoomToBalance = 10;
/// Largest simplification error over the radius of curvature.
constexpr double kShareOfRadius = 0.004;
constexpr double kLeastShapeOfPieces = 0.25;

using PieceTriple = std::array<std::uint32_t, 3>;

/// Newton's method with minimum-norm steps from x to a common zero of the pieces.
bool go_to_pieces(const PieceExpression& field, const PieceTriple& piece, double reach, double precision, Vec3& x) {
  std::size_t n = 0;
  while (n < 3 && piece[n] != kNoPiece) ++n;
  Vec3 p = x;
  for (int step = 0; step < kNewtonSteps; ++step) {
    std::array<double, 3> r{};
    std::array<Vec3, 3> g;
    for (std::size_t k = 0; k < n; ++k) {
      field.evaluate_piece(piece[k], {&p, 1}, {&r[k], 1}, {&g[k], 1});
      r[k] = -r[k];
    }
    Vec3 d;
    if (n == 1) {
      const double s = squared_norm(g[0]);
      if (!(s > 1e-6)) return false;
      d = g[0] * (r[0] / s);
    } else if (n == 2) {
      const double aa = squared_norm(g[0]), bb = squared_norm(g[1]), ab = dot(g[0], g[1]), det = aa * bb - ab * ab;
      if (!(det > kNoCrease * aa * bb) || !(aa * bb > 1e-12)) return false;
      d = g[0] * ((r[0] * bb - r[1] * ab) / det) + g[1] * ((r[1] * aa - r[0] * ab) / det);
    } else {
      const Matrix3 m{g[0], g[1], g[2]};
      const double det = m.determinant();
      if (!(std::abs(det) > kNoCorner)) return false;
      d = m.solve_transposed({r[0], r[1], r[2]});
    }
    if (!is_finite(d)) return false;
    p += d;
    if (norm(p - x) > reach) return false;
    if (norm(d) <= precision) {
      x = p;
      return true;
    }
  }
  return false;
}

}  // namespace

void PieceMesher::name_pieces() {
  bool any = false;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const std::array<Vec3, 3> corners{mesh.vertices[a].x, mesh.vertices[b].x, mesh.vertices[c].x};
    const std::uint32_t same = field_.same_at(mesh.piece[t], corners);
    any = any || same != mesh.piece[t];
    mesh.piece[t] = same;
  }
  if (any) recall();
}

void PieceMesher::improve(const Vec3& origin, Progress& progress) {
  progress.begin("merge");
  std::vector<Vec3> facing = normals_of_triangles();
  PieceMergeOptions merging;
  merging.near = kNear;
  merging.flat = kFlatShare * options_.simplify;
  merging.nothing = kNothing * scale_;
  merging.rounding = kRounding * scale_;
  merging.straight.resize(mesh.vertices.size());
  parallel_for(0, mesh.vertices.size(), 4096,
               [&](std::size_t v) { merging.straight[v] = curvature_bound_of(mesh.vertices[v]) == 0; });
  becomes_ = merge_pieces(mesh, facing, merging);
  if (options_.simplify <= 0) return;
  progress.begin("simplify");
  simplify(origin, progress);
  progress.begin("place vertices again");
  place_again();
}

PieceMesh PieceMesher::piece_mesh() const {
  PieceMesh pieces;
  pieces.triangles = mesh.triangles;
  pieces.piece = mesh.piece;
  for (const CutPieces::Vertex& v : mesh.vertices) {
    pieces.x.push_back(v.x);
    pieces.rank.push_back(static_cast<std::uint8_t>(v.rank()));
  }
  return pieces;
}

TriangleMesh PieceMesher::finished(const Vec3& origin, bool careful) {
  PieceMesh pieces = piece_mesh();
  for (std::size_t v = 0; v < pieces.rank.size(); ++v)
    if (static_cast<double>(mesh.vertices[v].room) < kRoomToBalance * options_.mesh_error) pieces.rank[v] = 2;
  if (!careful) balance_pieces(field_, pieces);
  TriangleMesh result;
  result.origin = origin;
  result.triangles = mesh.triangles;
  for (std::size_t v = 0; v < pieces.x.size(); ++v) {
    mesh.vertices[v].x = pieces.x[v];
    result.vertices.emplace_back(pieces.x[v] - origin);
  }
  return result;
}

std::vector<Vec3f> PieceMesher::normals() const { return piece_normals(field_, piece_mesh()); }

void PieceMesher::place_vertices() {
  parallel_for(0, mesh.vertices.size(), 1024, [&](std::size_t i) {
    CutPieces::Vertex& v = mesh.vertices[i];
    const double size = static_cast<double>(v.size), precision = 1e-11 * scale_;
    const bool several = v.rank() > 1;
    if (go_to_pieces(field_, v.piece, (several ? kReachOfSeveral : kReachOfOne) * size, precision, v.x)) return;
    // Tangent pieces have no crease: use the first of them.
    if (several) go_to_pieces(field_, {v.piece[0], kNoPiece, kNoPiece}, kReachOfOne * size, precision, v.x);
  });
}

std::vector<Vec3> PieceMesher::normals_of_triangles(std::vector<double>* distance) const {
  std::vector<Vec3> normal(mesh.triangles.size());
  if (distance) distance->resize(normal.size());
  parallel_for(0, normal.size(), 1024, [&](std::size_t t) {
    const auto [a, b, c] = mesh.triangles[t];
    const Vec3 x = (mesh.vertices[a].x + mesh.vertices[b].x + mesh.vertices[c].x) / 3;
    double f = 0;
    field_.evaluate_piece(mesh.piece[t], {&x, 1}, {&f, 1}, {&normal[t], 1});
    normal[t] = normalized(normal[t]);
    if (distance) (*distance)[t] = std::abs(f);
  });
  return normal;
}

void PieceMesher::spread_room() {
  for (int ring = 0; ring < 2; ++ring) {
    std::vector<float> room(mesh.vertices.size(), std::numeric_limits<float>::infinity());
    for (const Triangle& t : mesh.triangles) {
      const float least = std::min({mesh.vertices[t[0]].room, mesh.vertices[t[1]].room, mesh.vertices[t[2]].room});
      for (const std::uint32_t v : t) room[v] = std::min(room[v], least);
    }
    for (std::size_t v = 0; v < room.size(); ++v) mesh.vertices[v].room = room[v];
  }
}

void PieceMesher::recall() {
  const VertexCorners corners(mesh.triangles, mesh.vertices.size());
  parallel_for(0, mesh.vertices.size(), 1024, [&](std::size_t v) {
    PieceSet set;
    for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i) set.add(mesh.piece[corners.entries[i] / 3]);
    mesh.vertices[v].piece = {kNoPiece, kNoPiece, kNoPiece};
    if (set.count <= 3) {
      std::copy(set.begin(), set.end(), mesh.vertices[v].piece.begin());
      return;
    }
    // Selects those that span the largest volume.
    std::array<Vec3, PieceSet::kMost> g;
    for (std::size_t k = 0; k < set.count; ++k) {
      double f = 0;
      field_.evaluate_piece(set.piece[k], {&mesh.vertices[v].x, 1}, {&f, 1}, {&g[k], 1});
    }
    double most = -1;
    for (std::size_t i = 0; i < set.count; ++i)
      for (std::size_t j = i + 1; j < set.count; ++j)
        for (std::size_t k = j + 1; k < set.count; ++k) {
          const double span = std::abs(dot(cross(g[i], g[j]), g[k]));
          if (span > most) most = span, mesh.vertices[v].piece = {set.piece[i], set.piece[j], set.piece[k]};
        }
  });
}

double PieceMesher::curvature_bound_of(const CutPieces::Vertex& v) const {
  double curvature = 0;
  for (std::uint32_t k = 0; k < v.rank(); ++k)
    curvature = std::max(curvature, field_.curvature_bound(v.piece[k], v.x, 0));
  return curvature;
}

void PieceMesher::simplify(const Vec3& origin, Progress& progress) {
  TriangleMesh plain;
  plain.origin = origin;
  plain.triangles = std::move(mesh.triangles);
  plain.vertices.resize(mesh.vertices.size());
  std::vector<float> limits(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    plain.vertices[v] = Vec3f(mesh.vertices[v].x - origin);
    limits[v] = static_cast<float>(kShareOfRoom) * mesh.vertices[v].room;
    if (options_.triangles > 0) continue;
    // Thin parts keep their shape, and flat thin parts almost exactly, unless a number of triangles was requested.
    const double curvature = curvature_bound_of(mesh.vertices[v]);
    const double most =
        curvature > 0 ? kShareOfRadius / curvature
                      : std::min(options_.flat_error, kFlatShareOfRoom * static_cast<double>(mesh.vertices[v].room));
    limits[v] = std::min(limits[v], static_cast<float>(most));
  }
  std::vector<float> room_of(plain.triangles.size());
  for (std::size_t t = 0; t < room_of.size(); ++t) {
    const auto [a, b, c] = plain.triangles[t];
    room_of[t] = std::min({mesh.vertices[a].room, mesh.vertices[b].room, mesh.vertices[c].room});
  }
  CollapseOptions simplify;
  simplify.error = options_.simplify;
  simplify.triangles = options_.triangles;
  simplify.least_shape = options_.triangles > 0 ? kLeastShapeOfNumber : kLeastShapeOfPieces;
  simplify.limits = limits;
  std::vector<std::uint32_t> from;
  std::vector<std::uint32_t> becomes;
  simplify_mesh(plain, simplify, progress, &from, &becomes);
  parallel_for(0, becomes_.size(), 8192, [&](std::size_t v) {
    if (becomes_[v] != kNoPiece) becomes_[v] = becomes[becomes_[v]];
  });
  std::vector<std::uint32_t> piece(from.size());
  std::vector<float> room(from.size());
  for (std::size_t t = 0; t < from.size(); ++t) piece[t] = mesh.piece[from[t]], room[t] = room_of[from[t]];
  mesh.piece = std::move(piece);
  mesh.triangles = std::move(plain.triangles);
  mesh.vertices.assign(plain.vertices.size(), {});
  for (std::size_t v = 0; v < plain.vertices.size(); ++v) mesh.vertices[v].x = origin + Vec3(plain.vertices[v]);
  for (std::size_t t = 0; t < room.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) mesh.vertices[v].room = std::min(mesh.vertices[v].room, room[t]);
  recall();
  // Limits each move to less than the shortest edge, and to a fraction of the triangles' heights.
  std::vector<float> shortest(mesh.vertices.size(), std::numeric_limits<float>::max());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto l = static_cast<float>(norm(mesh.vertices[t[k]].x - mesh.vertices[t[(k + 1) % 3]].x));
      for (const std::uint32_t v : {t[k], t[(k + 1) % 3]}) shortest[v] = std::min(shortest[v], l);
    }
  for (std::size_t v = 0; v < shortest.size(); ++v) mesh.vertices[v].size = shortest[v];
}

void PieceMesher::place_again() {
  std::vector<Vec3> before(mesh.vertices.size());
  for (std::size_t v = 0; v < before.size(); ++v) before[v] = mesh.vertices[v].x;
  place_vertices();
  // Restored vertices were moved off their pieces where the mesh intersected itself.
  for (std::size_t v = 0; v < before.size(); ++v)
    if (mesh.vertices[v].room == 0) mesh.vertices[v].x = before[v];
  std::vector<std::uint8_t> back(before.size());
  for (int round = 0; round < 3; ++round) {
    std::fill(back.begin(), back.end(), std::uint8_t{0});
    bool any = false;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 old = cross(before[b] - before[a], before[c] - before[a]);
      const Vec3 now = cross(mesh.vertices[b].x - mesh.vertices[a].x, mesh.vertices[c].x - mesh.vertices[a].x);
      if (dot(old, now) < 0.5 * norm(old) * norm(now) || norm(now) < 0.3 * norm(old))
        back[a] = back[b] = back[c] = 1, any = true;
    }
    if (!any) break;
    for (std::size_t v = 0; v < before.size(); ++v)
      if (back[v]) mesh.vertices[v].x = before[v];
  }
}

}  // namespace sansmesh::inline v1
