#include "sansmesh/polygonize/vertex_placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kCreaseCosine = 0.866f;  // normals that differ by more than 30° across an edge

/// The point nearest to x that is on the planes (p_j, n_j) in the least-squares sense; undetermined directions keep
/// their coordinates.
Vec3 meet_planes(const Vec3& x, const std::vector<Vec3>& p, const std::vector<Vec3>& n) {
  // Gauss–Newton on Σ (n·(x + d − p))² with a Tikhonov term that is small compared with any crease over 20°.
  Matrix3 a;
  Vec3 b;
  for (std::size_t j = 0; j < p.size(); ++j) {
    a.a += n[j] * n[j].x, a.b += n[j] * n[j].y, a.c += n[j] * n[j].z;
    b += n[j] * dot(n[j], p[j] - x);
  }
  const double damping = 0.01 * static_cast<double>(p.size());
  a.a.x += damping, a.b.y += damping, a.c.z += damping;
  return x + a.solve(b);
}

}  // namespace

void snap_to_creases(const ScalarField& field, const std::vector<Triangle>& triangles, const VertexCorners& corners,
                     const std::vector<Vec3f>& normals, std::vector<Vec3>& x) {
  std::vector<std::uint8_t> candidate(x.size(), 0);
  std::vector<Vec3> target(x.size());
  std::vector<float> reach(x.size(), 0);
  parallel_ranges(0, x.size(), 2048, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> p, n;
    for (std::size_t v = begin; v < end; ++v) {
      p.clear(), n.clear();
      float least = 1;
      double edge = 0;
      for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i)
        for (const std::uint32_t o : triangles[corners.entries[i] / 3]) {
          if (o == v) continue;
          least = std::min(least, dot(normals[o], normals[v]));
          p.push_back(x[o]);
          n.push_back(Vec3(normals[o]));
          edge += norm(x[o] - x[v]);
        }
      if (least > kCreaseCosine || p.empty()) continue;
      edge /= static_cast<double>(p.size());
      for (int k = 0; k < 2; ++k) p.push_back(x[v]), n.push_back(Vec3(normals[v]));
      target[v] = meet_planes(x[v], p, n);
      reach[v] = static_cast<float>(edge);
      candidate[v] = norm(target[v] - x[v]) < 0.5 * edge;
    }
  });
  std::vector<std::uint32_t> list;
  for (std::size_t v = 0; v < x.size(); ++v)
    if (candidate[v]) list.push_back(static_cast<std::uint32_t>(v));
  std::vector<Vec3> at(list.size());
  std::vector<double> f(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) at[i] = target[list[i]];
  field.evaluate(at, f);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (std::abs(f[i]) <= 0.1 * reach[list[i]]) x[list[i]] = at[i];
  }
}

void balance_gaps(const ScalarField& field, const std::vector<Triangle>& triangles, const VertexCorners& corners,
                  const std::vector<Vec3f>& normals, std::vector<Vec3>& x) {
  std::vector<Vec3> centroid(triangles.size());
  std::vector<double> f(triangles.size());
  parallel_for(0, triangles.size(), 8192, [&](std::size_t i) {
    const Triangle& t = triangles[i];
    centroid[i] = (x[t[0]] + x[t[1]] + x[t[2]]) * (1 / 3.0);
  });
  field.evaluate(centroid, f);
  // The gap over a triangle of a sphere is κ e²/6 at its centroid and κ e²/8 on average.
  constexpr double kMeanOverMiddle = 0.75;
  std::vector<double> move(x.size(), 0);
  parallel_for(0, x.size(), 4096, [&](std::size_t v) {
    double sum = 0, n = 0, edge = 0;
    for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i) {
      const std::uint32_t t = corners.entries[i] / 3;
      for (const std::uint32_t o : triangles[t])
        if (dot(normals[o], normals[v]) < kCreaseCosine) return;
      sum += f[t], n += 1;
      edge += norm(centroid[t] - x[v]);
    }
    if (std::abs(sum) > 0.3 * edge) return;  // a cap that closes the mesh at the domain's border
    if (n > 0) move[v] = std::clamp(-kMeanOverMiddle * sum / n, -0.2 * edge / n, 0.2 * edge / n);
  });
  parallel_for(0, x.size(), 4096, [&](std::size_t v) { x[v] += Vec3(normals[v]) * move[v]; });
}

void smooth_tangentially(const std::vector<Triangle>& triangles, const VertexCorners& corners,
                         const std::vector<Vec3f>& normals, int rounds, std::vector<Vec3>& x) {
  std::vector<Vec3> old;
  for (int round = 0; round < rounds; ++round) {
    old = x;
    parallel_for(0, x.size(), 4096, [&](std::size_t v) {
      Vec3 sum;
      double weight = 0;
      for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1]; ++i) {
        const Triangle& t = triangles[corners.entries[i] / 3];
        const Vec3 a = old[t[1]] - old[t[0]], b = old[t[2]] - old[t[0]];
        const double area = norm(cross(a, b));
        sum += (old[t[0]] + (a + b) * (1 / 3.0)) * area;
        weight += area;
      }
      if (!(weight > 0)) return;
      const Vec3 normal(normals[v]);
      Vec3 move = sum / weight - old[v];
      move -= normal * dot(move, normal);
      x[v] += move;
    });
  }
}

void place_again(const ScalarField& field, const PolygonizeOptions& options, bool keep, TriangleMesh& mesh,
                 std::vector<Vec3>& x) {
  const std::size_t n = mesh.vertices.size();
  x.resize(n);
  parallel_for(0, n, 8192, [&](std::size_t i) { x[i] = mesh.origin + Vec3(mesh.vertices[i]); });
  std::vector<double> f(n);
  std::vector<Vec3> g(n);
  field.evaluate(x, f, g);
  const VertexCorners corners(mesh.triangles, n);
  mesh.normals.resize(n);
  parallel_for(0, n, 2048, [&](std::size_t v) {
    const Vec3 normal = normalized(g[v]);
    const double slope2 = squared_norm(g[v]);
    double edge = std::numeric_limits<double>::infinity();
    bool smooth = slope2 > 1e-4;
    for (std::uint32_t i = corners.first[v]; i < corners.first[v + 1] && smooth; ++i) {
      const Triangle& t = mesh.triangles[corners.entries[i] / 3];
      const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
      smooth = dot(normalized(cross(b - a, c - a)), normal) > static_cast<double>(kCreaseCosine);
      edge = std::min({edge, squared_norm(b - a), squared_norm(c - a)});
    }
    mesh.normals[v] = Vec3f(normal);
    if (smooth && !keep && options.root_steps > 0 && f[v] * f[v] < 0.04 * edge * slope2) x[v] -= g[v] * (f[v] / slope2);
  });
  if (options.balance && !keep) balance_gaps(field, mesh.triangles, corners, mesh.normals, x);
}

}  // namespace sansmesh::inline v1
