// Seed curves, surfaces of flows known in closed form, and what holds for every such surface.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <vector>

#include "sansmesh/flow/flow_surface.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/mesh_measures.h"

namespace sansmesh::test {

inline constexpr double kHalfTurn = std::numbers::pi;

inline SeedCurve seed_line(const Vec3& a, const Vec3& b) { return {{a, b}, false}; }

inline SeedCurve seed_circle(const Vec3& center, const Vec3& u, const Vec3& v, int n = 200) {
  SeedCurve curve;
  curve.closed = true;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * kHalfTurn * i / n;
    curve.points.push_back(center + u * std::cos(angle) + v * std::sin(angle));
  }
  return curve;
}

inline FlowSurface surface_of(const char* flow, const SeedCurve& curve, const FlowSurfaceOptions& options) {
  Progress progress;
  return flow_surface(*analytic_flow(flow), curve, options, progress);
}

inline FlowSurfaceOptions surface_for(double duration, std::size_t seeds) {
  FlowSurfaceOptions options;
  options.duration = duration, options.seeds = seeds;
  return options;
}

inline double area(const FlowSurface& surface) {
  double sum = 0;
  for (const Triangle& t : surface.mesh.triangles)
    sum += 0.5 * norm(cross(surface.points[t[1]].position - surface.points[t[0]].position,
                            surface.points[t[2]].position - surface.points[t[0]].position));
  return sum;
}

/// Invariants of every surface; `fans`: vertices between fans are not shared.
inline void expect_sound(const FlowSurface& surface, bool fans = false) {
  const MeshTopology topology = measure_topology(surface.mesh);
  EXPECT_TRUE(topology.manifold()) << topology.nonmanifold_edges << ' ' << topology.nonmanifold_vertices;
  EXPECT_TRUE(topology.oriented());
  EXPECT_EQ(topology.degenerate_triangles, 0u);
  EXPECT_EQ(topology.unused_vertices, 0u);
  ASSERT_EQ(surface.points.size(), surface.mesh.vertices.size());
  surface.mesh.attributes.check_rows(surface.points.size(), "points");
  for (const char* name : {"s", "time", "speed", "front"}) EXPECT_TRUE(surface.mesh.attributes.find(name)) << name;
  std::set<std::tuple<std::uint32_t, double>> seen;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const FlowPoint& p = surface.points[i];
    EXPECT_NEAR(norm(p.normal), 1, 1e-9) << i;
    EXPECT_TRUE(seen.emplace(p.particle, p.t).second || fans) << i;
  }
  // Normals agree with the orientation of the triangles.
  double against = 0;
  for (const Triangle& t : surface.mesh.triangles) {
    const Vec3 n = cross(surface.points[t[1]].position - surface.points[t[0]].position,
                         surface.points[t[2]].position - surface.points[t[0]].position);
    for (const std::uint32_t v : t) against += dot(n, surface.points[v].normal) < 0 ? norm(n) / 6 : 0;
  }
  EXPECT_LE(against, 0.01 * area(surface));
}

/// Points of each front by s.
inline std::map<std::int32_t, std::vector<const FlowPoint*>> fronts(const FlowSurface& surface) {
  std::map<std::int32_t, std::vector<const FlowPoint*>> by_front;
  for (const FlowPoint& p : surface.points) by_front[p.front].push_back(&p);
  for (auto& [front, points] : by_front)
    std::sort(points.begin(), points.end(), [](const FlowPoint* a, const FlowPoint* b) { return a->s < b->s; });
  return by_front;
}

}  // namespace sansmesh::test
