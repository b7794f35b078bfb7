#include "sansmesh/polygonize/piece_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/simplify.h"
#include "sansmesh/mesh/repair/self_intersections.h"
#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/polygonize/piece_blocks.h"
#include "sansmesh/polygonize/piece_cut.h"
#include "sansmesh/polygonize/piece_merge.h"
#include "sansmesh/polygonize/piece_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kNoPiece = CutPieces::kNone;
constexpr std::array<double, 4> kTries{0, 0.137, 0.291, 0.613};
constexpr int kNewtonSteps = 8;
/// How far vertices may go to their pieces, as a share of the edge of the blocks: on one piece, and where several meet.
constexpr double kReachOfOne = 0.3, kReachOfSeveral = 0.6;
/// Squared sine between two pieces, and determinant of three, below which they have no crease or corner to go to.
constexpr double kNoCrease = 1e-7, kNoCorner = 1e-5;
/// Merges: up to so far, as a share of the blocks' edge; out of planes by so much of the error of simplification.
constexpr double kNear = 0.22, kFlatShare = 0.1;
constexpr double kNothing = 1e-7, kRounding = 1e-10;
/// Sheets closer to each other than so many mesh errors keep their distance by having no more than a share of it as
/// error.
constexpr double kShareOfRoom = 0.2, kFlatShareOfRoom = 1e-3;
constexpr double kRoomToBalance = 10;
/// How far edges go through triangles for the mesh to count as going through itself, as a share of the box.
constexpr double kCrossing = 1e-7;
constexpr int kMostTakeBacks = 6;
/// So often the mesh is simplified, with more left as it was cut out where it went through itself; then not at all.
constexpr int kMostSimplifications = 4;
/// So often only the places concerned are taken back before that, a ring wider each time.
constexpr int kMostRestored = 5;
/// What is left as it was: around crossing triangles, so many of their radii the first time, and more each time.
constexpr float kNarrow = 0.2f;
constexpr double kKeptRadius = 1.2, kKeptMore = 0.8;
/// Error of simplification as a share of the radius of curvature, at most.
constexpr double kShareOfRadius = 0.004;
constexpr double kLeastShapeOfPieces = 0.25;

using Crossings = std::vector<std::array<std::uint32_t, 2>>;
using PieceTriple = std::array<std::uint32_t, 3>;

/// Newton's method, with the shortest steps, from x to where all of the pieces vanish.
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

class PieceMesher {
 public:
  PieceMesher(const PieceExpression& field, const PieceSurfaceOptions& options, double scale)
      : field_(field), options_(options), scale_(scale) {}

  CutPieces mesh;

  /// Triangles on blends that are one of their pieces there belong to that.
  void name_pieces() {
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

  /// Vertices of triangles that go through others back to where they were before they were placed: of those triangles
  /// that `near` says, or of all.
  void take_back(const CutPieces& linear, const Vec3& origin, double tolerance, const std::vector<std::uint8_t>* near) {
    for (int round = 0; round < kMostTakeBacks; ++round) {
      const TriangleMesh part = as_mesh(origin, near);
      const Crossings crossing = self_intersections(part, tolerance);
      if (crossing.empty()) return;
      std::vector<std::uint8_t> back(mesh.vertices.size(), 0);
      for (const auto& pair : crossing)
        for (const std::uint32_t t : pair)
          for (const std::uint32_t v : part.triangles[t]) back[v] = 1;
      for (int ring = 0; ring < round; ++ring) {
        std::vector<std::uint8_t> wider = back;
        for (const Triangle& t : part.triangles)
          if (back[t[0]] || back[t[1]] || back[t[2]]) wider[t[0]] = wider[t[1]] = wider[t[2]] = 1;
        back = std::move(wider);
      }
      for (std::size_t v = 0; v < back.size(); ++v)
        if (back[v]) mesh.vertices[v].x = linear.vertices[v].x, mesh.vertices[v].room = 0;
    }
  }

  /// Vertices with another sheet beside them: there vertices on their pieces may be beyond it.
  std::vector<std::uint8_t> narrow() const {
    std::vector<std::uint8_t> all(mesh.vertices.size());
    for (std::size_t v = 0; v < all.size(); ++v) all[v] = mesh.vertices[v].room < kNarrow * mesh.vertices[v].size;
    return all;
  }

  /// No room for changes next to triangles of another mesh of the same surface that go through each other; which
  /// vertices these are.
  std::vector<std::uint8_t> keep_around(const TriangleMesh& other, const Crossings& crossing, double factor) {
    struct Ball {
      Vec3 middle;
      double radius;
    };
    std::vector<Ball> balls;
    double largest = 0;
    for (const auto& pair : crossing)
      for (const std::uint32_t t : pair) {
        const auto [a, b, c] = other.triangles[t];
        const Vec3 p(other.vertices[a]), q(other.vertices[b]), r(other.vertices[c]), middle = (p + q + r) / 3;
        const double radius = factor * std::max({norm(p - middle), norm(q - middle), norm(r - middle)});
        balls.push_back({other.origin + middle, radius});
        largest = std::max(largest, radius);
      }
    std::sort(balls.begin(), balls.end(), [](const Ball& a, const Ball& b) { return a.middle.x < b.middle.x; });
    std::vector<std::uint8_t> kept(mesh.vertices.size(), 0);
    parallel_for(0, mesh.vertices.size(), 1024, [&](std::size_t v) {
      const Vec3& x = mesh.vertices[v].x;
      for (auto b = std::lower_bound(balls.begin(), balls.end(), x.x - largest,
                                     [](const Ball&ball, double at) { return ball.middle.x < at; });
           b != balls.end() && b->middle.x <= x.x + largest; ++b)
        if (norm(x - b->middle) <= b->radius) kept[v] = 1;
      if (kept[v]) mesh.vertices[v].room = 0;
    });
    return kept;
  }

  /// With the triangles that have one of the vertices `near`, or all.
  TriangleMesh as_mesh(const Vec3& origin, const std::vector<std::uint8_t>* near) const {
    TriangleMesh plain;
    plain.origin = origin;
    for (const Triangle& t : mesh.triangles)
      if (!near || (*near)[t[0]] || (*near)[t[1]] || (*near)[t[2]]) plain.triangles.push_back(t);
    for (const CutPieces::Vertex& v : mesh.vertices) plain.vertices.emplace_back(v.x - origin);
    return plain;
  }

  /// Fewer and better triangles.
  void improve(const Vec3& origin, Progress& progress) {
    progress.begin("merge");
    std::vector<Vec3> facing = normals_of_triangles();
    PieceMergeOptions merging;
    merging.near = kNear;
    merging.flat = kFlatShare * options_.simplify;
    merging.nothing = kNothing * scale_;
    merging.rounding = kRounding * scale_;
    merging.straight.resize(mesh.vertices.size());
    parallel_for(0, mesh.vertices.size(), 4096,
                 [&](std::size_t v) { merging.straight[v] = bend_of(mesh.vertices[v]) == 0; });
    becomes_ = merge_pieces(mesh, facing, merging);
    if (options_.simplify <= 0) return;
    progress.begin("simplify");
    simplify(origin, progress);
    progress.begin("place vertices again");
    place_again();
  }

  /// Takes improvements back around triangles that go through each other, and only there: what vertices `rings` around
  /// those were merged from is as in `placed` again, and what is so already, as in `linear`. The rest stays:
  /// improvements merge vertices, so the mesh is that of `placed` with the vertices that are one written as one.
  void restore(const Crossings& crossing, const CutPieces& placed, const CutPieces& linear, int rings) {
    std::vector<std::uint32_t> parts(mesh.vertices.size(), 0);
    for (const std::uint32_t v : becomes_)
      if (v != kNoPiece) ++parts[v];
    std::vector<std::uint8_t> open(mesh.vertices.size(), 0), linear_again = open;
    for (const auto& pair : crossing)
      for (const std::uint32_t t : pair)
        for (const std::uint32_t v : mesh.triangles[t]) open[v] = 1, linear_again[v] = parts[v] == 1;
    for (int ring = 0; ring < rings; ++ring) {
      std::vector<std::uint8_t> wider = open;
      for (const Triangle& t : mesh.triangles)
        if (open[t[0]] || open[t[1]] || open[t[2]]) wider[t[0]] = wider[t[1]] = wider[t[2]] = 1;
      open = std::move(wider);
    }
    CutPieces mixed;
    std::vector<std::uint32_t> number(mesh.vertices.size(), kNoPiece);
    for (std::size_t v = 0; v < open.size(); ++v) {
      if (open[v]) continue;
      number[v] = static_cast<std::uint32_t>(mixed.vertices.size());
      mixed.vertices.push_back(mesh.vertices[v]);
    }
    for (std::size_t v = 0; v < becomes_.size(); ++v) {
      const std::uint32_t now = becomes_[v];
      if (now == kNoPiece) continue;
      if (!open[now]) {
        becomes_[v] = number[now];
        continue;
      }
      becomes_[v] = static_cast<std::uint32_t>(mixed.vertices.size());
      mixed.vertices.push_back(placed.vertices[v]);
      CutPieces::Vertex& vertex = mixed.vertices.back();
      vertex.room = 0;
      if (linear_again[now]) vertex.x = linear.vertices[v].x;
    }
    for (std::size_t t = 0; t < placed.triangles.size(); ++t) {
      Triangle now = placed.triangles[t];
      for (std::uint32_t& v : now) v = becomes_[v];
      if (now[0] == now[1] || now[1] == now[2] || now[2] == now[0]) continue;
      mixed.triangles.push_back(now);
      mixed.piece.push_back(placed.piece[t]);
    }
    mesh = std::move(mixed);
  }

  /// Balanced where there is room.
  TriangleMesh finished(const Vec3& origin, bool careful) {
    PieceMesh pieces;
    pieces.triangles = mesh.triangles;
    pieces.piece = mesh.piece;
    for (const CutPieces::Vertex& v : mesh.vertices) {
      pieces.x.push_back(v.x);
      const bool narrow = static_cast<double>(v.room) < kRoomToBalance * options_.mesh_error;
      pieces.rank.push_back(narrow ? 2 : static_cast<std::uint8_t>(v.rank()));
    }
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

  std::vector<Vec3f> normals() const {
    PieceMesh pieces;
    pieces.triangles = mesh.triangles;
    pieces.piece = mesh.piece;
    for (const CutPieces::Vertex& v : mesh.vertices) {
      pieces.x.push_back(v.x);
      pieces.rank.push_back(static_cast<std::uint8_t>(v.rank()));
    }
    return piece_normals(field_, pieces);
  }

  /// Each vertex onto its pieces.
  void place() {
    parallel_for(0, mesh.vertices.size(), 1024, [&](std::size_t i) {
      CutPieces::Vertex& v = mesh.vertices[i];
      const double size = static_cast<double>(v.size), precision = 1e-11 * scale_;
      const bool several = v.rank() > 1;
      if (go_to_pieces(field_, v.piece, (several ? kReachOfSeveral : kReachOfOne) * size, precision, v.x)) return;
      // Where pieces are tangent there is no crease: on the first of them at least.
      if (several) go_to_pieces(field_, {v.piece[0], kNoPiece, kNoPiece}, kReachOfOne * size, precision, v.x);
    });
  }

  /// Where the piece of each triangle points in its middle; and how far from it that is, if asked for.
  std::vector<Vec3> normals_of_triangles(std::vector<double>* distance = nullptr) const {
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

  /// Vertices know of sheets beside their neighbours, too.
  void spread_room() {
    for (int ring = 0; ring < 2; ++ring) {
      std::vector<float> room(mesh.vertices.size(), std::numeric_limits<float>::infinity());
      for (const Triangle& t : mesh.triangles) {
        const float least = std::min({mesh.vertices[t[0]].room, mesh.vertices[t[1]].room, mesh.vertices[t[2]].room});
        for (const std::uint32_t v : t) room[v] = std::min(room[v], least);
      }
      for (std::size_t v = 0; v < room.size(); ++v) mesh.vertices[v].room = room[v];
    }
  }

  /// The pieces of vertices from those of the triangles around.
  void recall() {
    const VertexCorners corners(mesh.triangles, mesh.vertices.size());
    parallel_for(0, mesh.vertices.size(), 1024, [&](std::size_t v) {
      PieceSet set;
      for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i)
        set.add(mesh.piece[corners.corner[i] / 3]);
      mesh.vertices[v].piece = {kNoPiece, kNoPiece, kNoPiece};
      if (set.count <= 3) {
        std::copy(set.begin(), set.end(), mesh.vertices[v].piece.begin());
        return;
      }
      // Those that span the most.
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

  /// The largest of its pieces.
  double bend_of(const CutPieces::Vertex& v) const {
    double bend = 0;
    for (std::uint32_t k = 0; k < v.rank(); ++k) bend = std::max(bend, field_.bend(v.piece[k], v.x, 0));
    return bend;
  }

  void simplify(const Vec3& origin, Progress& progress) {
    TriangleMesh plain;
    plain.origin = origin;
    plain.triangles = std::move(mesh.triangles);
    plain.vertices.resize(mesh.vertices.size());
    std::vector<float> limits(mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      plain.vertices[v] = Vec3f(mesh.vertices[v].x - origin);
      limits[v] = static_cast<float>(kShareOfRoom) * mesh.vertices[v].room;
      if (options_.triangles > 0) continue;
      // What is thin keeps its shape, too, and what is flat besides nearly all of it, unless a number was asked for.
      const double bend = bend_of(mesh.vertices[v]);
      const double most =
          bend > 0 ? kShareOfRadius / bend
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
    simplify.least_shape = kLeastShapeOfPieces;
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
    // How far each may go back is less than its shortest edge, and than a share of its triangles' heights.
    std::vector<float> shortest(mesh.vertices.size(), std::numeric_limits<float>::max());
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto l = static_cast<float>(norm(mesh.vertices[t[k]].x - mesh.vertices[t[(k + 1) % 3]].x));
        for (const std::uint32_t v : {t[k], t[(k + 1) % 3]}) shortest[v] = std::min(shortest[v], l);
      }
    for (std::size_t v = 0; v < shortest.size(); ++v) mesh.vertices[v].size = shortest[v];
  }

  /// As place(), but vertices stay where a triangle would turn.
  void place_again() {
    std::vector<Vec3> before(mesh.vertices.size());
    for (std::size_t v = 0; v < before.size(); ++v) before[v] = mesh.vertices[v].x;
    place();
    // What was left as it was has been taken back from its pieces where it went through itself.
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

 private:
  const PieceExpression& field_;
  const PieceSurfaceOptions& options_;
  double scale_;
  std::vector<std::uint32_t>
      becomes_;  ///< by vertex before improvements: its number in the mesh, or that of what it is part of
};

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

}  // namespace

TriangleMesh polygonize_pieces(const PieceExpression& field, const Box3& box, const Vec3& origin,
                               const PieceSurfaceOptions& options, Progress& progress, PieceSurfaceReport& report) {
  const double scale = box.diagonal();
  PieceMesher mesher(field, options, scale);
  report = {};
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
    mesher.mesh = cut_pieces(field, blocks, progress);
    if (!mesher.mesh.crowded && !mesher.mesh.cracked && closed(mesher.mesh)) break;
    if (const std::optional<Vec3>& at = mesher.mesh.crowded)  // that is so with other lattice points, too
      throw DataError(
          fmt::format("more than {} faces meet in one place, near ({:.4g}, {:.4g}, {:.4g}): cut that place "
                      "off, or make it of fewer faces or a cone{}",
                      kMostPiecesInBlock, at->x, at->y, at->z,
                      options.cell > 0 ? "; or they do not, and a smaller `cell` helps" : ""));
    if (attempt + 1 < kTries.size()) continue;
    if (const std::optional<Vec3>& at = mesher.mesh.cracked)
      throw DataError(
          fmt::format("the surface could not be closed near ({:.4g}, {:.4g}, {:.4g}): pieces cross there in more ways "
                      "than rounding can tell apart; move one of them a little",
                      at->x, at->y, at->z));
    throw DataError("the surface could not be closed: too many pieces meet in one place; move one of them a little");
  }
  TriangleMesh result;
  CutPieces& mesh = mesher.mesh;
  progress.begin("place vertices");
  mesher.spread_room();
  mesher.name_pieces();
  const CutPieces linear = mesh;  // goes nowhere through itself
  mesher.place();
  {
    const std::vector<std::uint8_t> narrow = mesher.narrow();
    mesher.take_back(linear, origin, kCrossing * scale, &narrow);
  }
  CutPieces placed = mesh;
  for (int attempt = 0;; ++attempt) {
    const bool simplified = attempt < kMostSimplifications;
    if (simplified) mesher.improve(origin, progress);
    result = mesher.finished(origin, !simplified);
    progress.begin("look for intersections");
    const Crossings crossing = self_intersections(result, kCrossing * scale);
    report.unsimplified = !simplified;
    if (crossing.empty()) break;
    if (simplified && options.triangles == 0) {
      Crossings left = crossing;
      TriangleMesh mixed;
      for (int rings = 0; rings < kMostRestored && !left.empty(); ++rings) {
        mesher.restore(left, placed, linear, rings);
        if (!closed(mesh)) break;  // what two others kept apart may be one place now
        mixed = mesher.finished(origin, true);
        left = self_intersections(mixed, kCrossing * scale);
      }
      if (left.empty()) {
        result = std::move(mixed);
        break;
      }
    }
    if (!simplified) {
      const Vec3 at = origin + Vec3(result.vertices[result.triangles[crossing[0][0]][0]]);
      throw DataError(fmt::format(
          "the mesh would go through itself in {} places, such as ({:.4g}, {:.4g}, {:.4g}): give a smaller `cell` or "
          "mesh error than {:.2g}",
          crossing.size(), at.x, at.y, at.z, options.mesh_error));
    }
    // As it was before improvements, free of intersections, and left as it is near those that were found.
    mesh = placed;
    const std::vector<std::uint8_t> kept = mesher.keep_around(result, crossing, kKeptRadius + kKeptMore * attempt);
    mesher.take_back(linear, origin, kCrossing * scale, attempt + 1 < kMostSimplifications ? &kept : nullptr);
    placed = mesh;
  }
  result.normals = mesher.normals();
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
  const double volume = enclosed(mesh.triangles, [&](std::uint32_t v) { return mesh.vertices[v].x - origin; });
  const double rounded = enclosed(result.triangles, [&](std::uint32_t v) { return Vec3(result.vertices[v]); });
  report.rounded_away = volume == rounded ? 0 : std::abs(rounded - volume) / std::max(volume, 0.0);
  progress.finish();
  return result;
}

}  // namespace sansmesh::inline v1
