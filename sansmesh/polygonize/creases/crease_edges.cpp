#include "sansmesh/polygonize/creases/crease_edges.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sansmesh/field/field_hints.h"
#include "sansmesh/polygonize/editable_surface.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kMostRounds = 6;
/// Edges bridge a crease if the adjacent triangles differ by more than 15°, and the midpoints of the edges are off the
/// surface by more than this share of their lengths; the replacement must be closer by this factor.
constexpr double kBridgeCosine = 0.966, kOffSurfaceShare = 0.02, kCloser = 0.5;
constexpr float kBentCosine = 0.991f;  ///< cosine of half that angle
/// Bounds of 4√3 area / Σ edges² of the new triangles, and of the cosine between their normals and the old ones.
constexpr double kLeastQuality = 0.1, kLeastAgreement = 0.2;

double triangle_quality(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double edges = squared_norm(b - a) + squared_norm(c - b) + squared_norm(a - c);
  return edges > 0 ? 2 * std::sqrt(3.0) * norm(cross(b - a, c - a)) / edges : 0;
}

struct Bridge {
  std::uint32_t half_edge;
  double gain;
};

/// Marks the vertices where the surface may have a crease.
std::vector<std::uint8_t> vertices_at_creases(const ScalarField& field, std::span<const Vec3> x,
                                              std::span<const Vec3f> normals, std::span<const Triangle> triangles) {
  // A bridge has a vertex on either side of the crease: the normals of the surface turn over its triangles.
  std::vector<std::uint8_t> bent(normals.size(), 0);
  for (const auto& [a, b, c] : triangles) {
    const float least =
        std::min({dot(normals[a], normals[b]), dot(normals[b], normals[c]), dot(normals[c], normals[a])});
    if (least < kBentCosine) bent[a] = bent[b] = bent[c] = 1;
  }
  const auto* const creases = dynamic_cast<const CreaseField*>(&field);
  if (!creases) return bent;
  std::vector<std::uint32_t> list;
  for (std::uint32_t v = 0; v < bent.size(); ++v)
    if (bent[v]) list.push_back(v);
  std::vector<Vec3> at(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) at[i] = x[list[i]];
  std::vector<std::uint8_t> near(list.size());
  creases->find_creases(at, near);
  for (std::size_t i = 0; i < list.size(); ++i) bent[list[i]] = near[i];
  return bent;
}

/// The triangles around these vertices. Flips of edges among them concern no others.
std::vector<std::uint32_t> bent_triangles(std::span<const std::uint8_t> bent, std::span<const Triangle> triangles) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    if (bent[triangles[t][0]] | bent[triangles[t][1]] | bent[triangles[t][2]]) found.push_back(t);
  return found;
}

}  // namespace

std::size_t turn_edges_to_creases(const ScalarField& field, std::span<const Vec3> x, std::span<const Vec3f> normals,
                                  std::vector<Triangle>& triangles) {
  const std::vector<std::uint32_t> near = bent_triangles(vertices_at_creases(field, x, normals, triangles), triangles);
  if (near.empty()) return 0;
  std::vector<Triangle> part(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) part[i] = triangles[near[i]];
  EditableSurface surface(std::move(part), x.size());
  const auto normal_of = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return normalized(cross(x[b] - x[a], x[c] - x[a]));
  };
  std::size_t turned = 0;
  std::vector<std::uint8_t> open(surface.triangles(), 1);  // triangles whose edges may have become bridges
  for (int round = 0; round < kMostRounds; ++round) {
    std::vector<std::uint32_t> asked;
    std::vector<Vec3> middles;
    for (std::uint32_t h = 0; h < 3 * surface.triangles(); ++h) {
      const std::uint32_t g = surface.twin(h);
      if (g == EditableSurface::kNone || g < h || !(open[h / 3] | open[g / 3])) continue;
      const std::uint32_t a = surface.from(h), b = surface.to(h), c = surface.apex(h), d = surface.apex(g);
      const Vec3 left = normal_of(a, b, c), right = normal_of(b, a, d);
      const Vec3 new_left = normal_of(a, d, c), new_right = normal_of(d, b, c);
      // A bridge rotates a crease of two triangles by a quarter turn: one of both pairs of normals differs.
      if (dot(left, right) > kBridgeCosine && dot(new_left, new_right) > kBridgeCosine) continue;
      const Vec3 mean = left + right;
      if (dot(new_left, mean) < kLeastAgreement || dot(new_right, mean) < kLeastAgreement) continue;
      if (std::min(triangle_quality(x[a], x[d], x[c]), triangle_quality(x[d], x[b], x[c])) < kLeastQuality) continue;
      asked.push_back(h);
      middles.push_back((x[a] + x[b]) / 2);
      middles.push_back((x[c] + x[d]) / 2);
    }
    std::vector<double> off(middles.size());
    field.evaluate(middles, off);
    std::vector<Bridge> bridges;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const double before = std::abs(off[2 * i]), after = std::abs(off[2 * i + 1]);
      const double length = norm(x[surface.to(asked[i])] - x[surface.from(asked[i])]);
      if (before > kOffSurfaceShare * length && after < kCloser * before) bridges.push_back({asked[i], before - after});
    }
    std::sort(bridges.begin(), bridges.end(), [](const Bridge& p, const Bridge& q) {
      return p.gain != q.gain ? p.gain > q.gain : p.half_edge < q.half_edge;
    });
    // The worst first; edges beside a flipped one wait for the next round.
    std::vector<std::uint8_t> touched(surface.triangles(), 0);
    std::fill(open.begin(), open.end(), std::uint8_t{0});
    std::size_t now = 0;
    for (const Bridge& bridge : bridges) {
      const std::uint32_t t = bridge.half_edge / 3;
      open[t] = 1;
      if (touched[t]) continue;  // this half-edge may be another one now
      const std::uint32_t u = surface.twin(bridge.half_edge) / 3;
      open[u] = 1;
      if (touched[u] || !surface.can_flip(bridge.half_edge)) continue;
      touched[t] = touched[u] = 1;
      surface.flip(bridge.half_edge);
      ++now;
    }
    turned += now;
    if (now == 0) break;
  }
  for (std::size_t i = 0; i < near.size(); ++i) triangles[near[i]] = surface[i];
  return turned;
}

}  // namespace sansmesh::inline v1
