#include "sansmesh/polygonize/pieces/piece_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/vertex_corners.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kReach = 0.5;      // largest move of a vertex back to its pieces, over its shortest edge
constexpr double kLeastTurn = 0.5;  // cosine between a triangle's normals before and after

/// Selects the three pieces whose normals at x span the largest volume; fewer where they do not span space.
void choose_pieces(const PiecewiseField& field, const PieceSet& pieces, Meeting& m) {
  if (pieces.count <= 2) {
    m.count = pieces.count;
    for (std::uint32_t k = 0; k < m.count; ++k) m.piece[k] = pieces.piece[k];
    return;
  }
  std::array<Vec3, PieceSet::kMost> n;
  for (std::size_t k = 0; k < pieces.count; ++k) {
    double f = 0;
    field.evaluate_piece(pieces.piece[k], {&m.start, 1}, {&f, 1}, {&n[k], 1});
    n[k] = normalized(n[k]);
  }
  double best2 = -1, best3 = kFlatCorner;
  m.count = 2;
  for (std::size_t i = 0; i < pieces.count; ++i)
    for (std::size_t j = i + 1; j < pieces.count; ++j) {
      const Vec3 c = cross(n[i], n[j]);
      if (m.count == 2 && norm(c) > best2) best2 = norm(c), m.piece = {pieces.piece[i], pieces.piece[j], 0};
      for (std::size_t k = j + 1; k < pieces.count; ++k) {
        if (std::abs(dot(c, n[k])) <= best3) continue;
        best3 = std::abs(dot(c, n[k]));
        m.count = 3;
        m.piece = {pieces.piece[i], pieces.piece[j], pieces.piece[k]};
      }
    }
}

bool stays_good(const PieceMesh& mesh, const VertexCorners& corners, std::uint32_t v, const Vec3& to) {
  for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i) {
    const Triangle& t = mesh.triangles[corners.entries[i] / 3];
    const std::uint32_t k = corners.entries[i] % 3;
    const Vec3 &p = mesh.x[t[(k + 1) % 3]], &q = mesh.x[t[(k + 2) % 3]];
    const Vec3 before = cross(p - mesh.x[v], q - mesh.x[v]), after = cross(p - to, q - to);
    if (dot(before, after) < kLeastTurn * norm(before) * norm(after)) return false;
    if (norm(after) < 0.5 * norm(before)) return false;
  }
  return true;
}

}  // namespace

void drop_unused_vertices(PieceMesh& mesh) {
  std::vector<std::uint32_t> number(mesh.x.size(), PieceMesh::kNone);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) number[v] = 0;
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == PieceMesh::kNone) continue;
    number[v] = kept;
    mesh.x[kept] = mesh.x[v];
    mesh.rank[kept++] = mesh.rank[v];
  }
  mesh.x.resize(kept);
  mesh.rank.resize(kept);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
}

void balance_pieces(const PiecewiseField& field, PieceMesh& mesh) {
  const std::size_t n = mesh.x.size();
  std::vector<PieceValue> middle;
  std::vector<std::uint32_t> slot(mesh.triangles.size(), PieceMesh::kNone);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.piece[t] == PieceMesh::kNone) continue;
    const auto [a, b, c] = mesh.triangles[t];
    slot[t] = static_cast<std::uint32_t>(middle.size());
    middle.push_back({mesh.piece[t], (mesh.x[a] + mesh.x[b] + mesh.x[c]) / 3, 0, {}});
  }
  evaluate_pieces(field, middle);
  const VertexCorners corners(mesh.triangles, n);
  constexpr double kMeanOverMiddle = 0.75;  // see balance_gaps
  std::vector<Vec3> move(n);
  parallel_for(0, n, 4096, [&](std::size_t v) {
    if (mesh.rank[v] != 1) return;
    double sum = 0, count = 0, edge = 0;
    Vec3 normal;
    for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i) {
      const std::uint32_t s = slot[corners.entries[i] / 3];
      if (s == PieceMesh::kNone) return;
      sum += middle[s].value;
      normal += normalized(middle[s].gradient);
      edge += norm(middle[s].x - mesh.x[v]);
      ++count;
    }
    if (count == 0 || std::abs(sum) > 0.3 * edge) return;  // a cap that closes the mesh at the domain's border
    move[v] = normalized(normal) * std::clamp(-kMeanOverMiddle * sum / count, -0.2 * edge / count, 0.2 * edge / count);
  });
  parallel_for(0, n, 4096, [&](std::size_t v) { mesh.x[v] += move[v]; });
}

PieceMesh recall_pieces(const PiecewiseField& field, std::vector<Vec3> x, std::vector<Triangle> triangles) {
  PieceMesh mesh;
  mesh.x = std::move(x);
  mesh.triangles = std::move(triangles);
  mesh.piece.resize(mesh.triangles.size());
  mesh.rank.assign(mesh.x.size(), 1);
  std::vector<Vec3> middle(mesh.triangles.size());
  parallel_for(0, middle.size(), 8192, [&](std::size_t t) {
    const auto [a, b, c] = mesh.triangles[t];
    middle[t] = (mesh.x[a] + mesh.x[b] + mesh.x[c]) / 3;
  });
  field.active(middle, mesh.piece);

  const VertexCorners corners(mesh.triangles, mesh.x.size());
  std::vector<Meeting> meetings(mesh.x.size());
  parallel_for(0, mesh.x.size(), 2048, [&](std::size_t v) {
    Meeting& m = meetings[v];
    PieceSet pieces;
    double shortest = std::numeric_limits<double>::max();
    for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i) {
      const std::uint32_t t = corners.entries[i] / 3, k = corners.entries[i] % 3;
      pieces.add(mesh.piece[t]);
      shortest = std::min(shortest, squared_norm(mesh.x[mesh.triangles[t][(k + 1) % 3]] - mesh.x[v]));
    }
    m.start = mesh.x[v];
    m.reach = kReach * std::sqrt(shortest);
    choose_pieces(field, pieces, m);
  });
  find_meetings(field, meetings);
  for (std::uint32_t v = 0; v < mesh.x.size(); ++v) {
    const Meeting& m = meetings[v];
    mesh.rank[v] = static_cast<std::uint8_t>(m.count);
    if (m.found && stays_good(mesh, corners, v, m.x)) mesh.x[v] = m.x;
  }
  return mesh;
}

std::vector<Vec3f> piece_normals(const PiecewiseField& field, const PieceMesh& mesh) {
  std::vector<PieceValue> queries;
  std::vector<std::uint32_t> at;
  std::vector<double> weight;
  std::vector<Vec3> sum(mesh.x.size());
  std::vector<std::uint8_t> seen(mesh.x.size(), 0);  // a smooth vertex needs only one of its triangles
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      const bool smooth = mesh.rank[v] == 1 && mesh.piece[t] != PieceMesh::kNone;
      if (smooth && seen[v]) continue;
      const Vec3 a = mesh.x[mesh.triangles[t][(k + 1) % 3]] - mesh.x[v];
      const Vec3 b = mesh.x[mesh.triangles[t][(k + 2) % 3]] - mesh.x[v];
      const double angle = std::atan2(norm(cross(a, b)), dot(a, b));
      if (mesh.piece[t] == PieceMesh::kNone || mesh.rank[v] == 0) {
        if (mesh.rank[v] != 1) sum[v] += normalized(cross(a, b)) * angle;
        continue;
      }
      seen[v] = 1;
      queries.push_back({mesh.piece[t], mesh.x[v], 0, {}});
      at.push_back(v);
      weight.push_back(angle);
    }
  evaluate_pieces(field, queries);
  for (std::size_t i = 0; i < at.size(); ++i) sum[at[i]] += normalized(queries[i].gradient) * weight[i];
  // Vertices without a piece, or with cancelling normals, use the mean of their triangles.
  const VertexCorners corners(mesh.triangles, mesh.x.size());
  std::vector<Vec3f> normals(mesh.x.size());
  parallel_for(0, normals.size(), 4096, [&](std::size_t v) {
    if (!(squared_norm(sum[v]) > 1e-12)) {
      sum[v] = {};
      for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i) {
        const auto [a, b, c] = mesh.triangles[corners.entries[i] / 3];
        sum[v] += cross(mesh.x[b] - mesh.x[a], mesh.x[c] - mesh.x[a]);
      }
    }
    normals[v] = Vec3f(normalized(sum[v]));
  });
  return normals;
}

}  // namespace sansmesh::inline v1
