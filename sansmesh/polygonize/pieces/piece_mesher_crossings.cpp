// PieceMesher: repair of self-intersections.
#include "sansmesh/polygonize/pieces/piece_mesher.h"

#include <algorithm>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/repair/self_intersections.h"

namespace sansmesh::inline v1 {

namespace {

constexpr std::uint32_t kNoVertexLeft = CutPieces::kNone;
constexpr int kMostTakeBacks = 6;
constexpr float kNarrow = 0.2f;  // room over size below which placement may reach another sheet

/// Marks the vertices of all triangles that have a marked one.
void widen_by_ring(const std::vector<Triangle>& triangles, std::vector<std::uint8_t>& marked) {
  std::vector<std::uint8_t> wider = marked;
  for (const Triangle& t : triangles)
    if (marked[t[0]] || marked[t[1]] || marked[t[2]]) wider[t[0]] = wider[t[1]] = wider[t[2]] = 1;
  marked = std::move(wider);
}

}  // namespace

void PieceMesher::take_back(const CutPieces& linear, const Vec3& origin, double tolerance,
                            const std::vector<std::uint8_t>* near) {
  for (int round = 0; round < kMostTakeBacks; ++round) {
    const TriangleMesh part = as_mesh(origin, near);
    const Crossings crossing = self_intersections(part, tolerance);
    if (crossing.empty()) return;
    std::vector<std::uint8_t> back(mesh.vertices.size(), 0);
    for (const auto& pair : crossing)
      for (const std::uint32_t t : pair)
        for (const std::uint32_t v : part.triangles[t]) back[v] = 1;
    for (int ring = 0; ring < round; ++ring) widen_by_ring(part.triangles, back);
    for (std::size_t v = 0; v < back.size(); ++v)
      if (back[v]) mesh.vertices[v].x = linear.vertices[v].x, mesh.vertices[v].room = 0;
  }
}

std::vector<std::uint8_t> PieceMesher::narrow() const {
  std::vector<std::uint8_t> all(mesh.vertices.size());
  for (std::size_t v = 0; v < all.size(); ++v) all[v] = mesh.vertices[v].room < kNarrow * mesh.vertices[v].size;
  return all;
}

std::vector<std::uint8_t> PieceMesher::keep_around(const TriangleMesh& other, const Crossings& crossing,
                                                   double factor) {
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

TriangleMesh PieceMesher::as_mesh(const Vec3& origin, const std::vector<std::uint8_t>* near) const {
  TriangleMesh plain;
  plain.origin = origin;
  for (const Triangle& t : mesh.triangles)
    if (!near || (*near)[t[0]] || (*near)[t[1]] || (*near)[t[2]]) plain.triangles.push_back(t);
  for (const CutPieces::Vertex& v : mesh.vertices) plain.vertices.emplace_back(v.x - origin);
  return plain;
}

void PieceMesher::restore(const Crossings& crossing, const CutPieces& placed, const CutPieces& linear, int rings) {
  std::vector<std::uint32_t> parts(mesh.vertices.size(), 0);
  for (const std::uint32_t v : becomes_)
    if (v != kNoVertexLeft) ++parts[v];
  std::vector<std::uint8_t> open(mesh.vertices.size(), 0), linear_again = open;
  for (const auto& pair : crossing)
    for (const std::uint32_t t : pair)
      for (const std::uint32_t v : mesh.triangles[t]) open[v] = 1, linear_again[v] = parts[v] == 1;
  for (int ring = 0; ring < rings; ++ring) widen_by_ring(mesh.triangles, open);
  CutPieces mixed;
  std::vector<std::uint32_t> number(mesh.vertices.size(), kNoVertexLeft);
  for (std::size_t v = 0; v < open.size(); ++v) {
    if (open[v]) continue;
    number[v] = static_cast<std::uint32_t>(mixed.vertices.size());
    mixed.vertices.push_back(mesh.vertices[v]);
  }
  for (std::size_t v = 0; v < becomes_.size(); ++v) {
    const std::uint32_t now = becomes_[v];
    if (now == kNoVertexLeft) continue;
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

}  // namespace sansmesh::inline v1
