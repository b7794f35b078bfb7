#include "sansmesh/mesh/edit/tubes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh_measures.h"
#include "support/any_threads.h"
#include "support/mesh_checks.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kPi = std::numbers::pi;

PolylineSet line_of(const std::vector<Vec3>& points) {
  PolylineSet lines;
  for (const Vec3& p : points) lines.positions.emplace_back(p);
  lines.offsets.push_back(points.size());
  return lines;
}

std::vector<Vec3> helix(double radius, double climb, double turns, int points) {
  std::vector<Vec3> x;
  for (int i = 0; i < points; ++i) {
    const double a = 2 * kPi * turns * i / (points - 1);
    x.push_back({radius * std::cos(a), radius * std::sin(a), climb * a / (2 * kPi)});
  }
  return x;
}

struct Foot {
  double distance = std::numeric_limits<double>::infinity();
  Vec3 at;
};

Foot foot_on(const std::vector<Vec3>& line, const Vec3& x) {
  Foot best;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec3 d = line[i + 1] - line[i];
    const double t = std::clamp(dot(x - line[i], d) / std::max(dot(d, d), 1e-30), 0.0, 1.0);
    const Vec3 at = line[i] + t * d;
    if (norm(x - at) < best.distance) best = {norm(x - at), at};
  }
  return best;
}

void expect_solid(const TriangleMesh& mesh, std::size_t components) {
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.genus(), 0);
  EXPECT_EQ(topology.components, components);
  EXPECT_EQ(topology.unused_vertices, 0u);
  EXPECT_TRUE(test::topology_of(mesh).closed_manifold());
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  for (const Vec3f& n : mesh.normals) EXPECT_NEAR(norm(n), 1, 1e-5);
}

TEST(Tubes, OfAStraightLineArePrisms) {
  for (const int sides : {3, 8, 20}) {
    // Additional points on the line, one of them twice, change nothing.
    const PolylineSet lines = line_of({{1, 2, 3}, {2, 4, 5}, {2, 4, 5}, {3, 6, 7}});
    const TriangleMesh mesh = tubes(lines, {.radius = 0.25, .sides = sides});
    expect_solid(mesh, 1);
    const double base = 0.5 * sides * 0.0625 * std::sin(2 * kPi / sides), edge = 0.5 * std::sin(kPi / sides);
    const MeshSize size = measure_size(mesh);
    EXPECT_NEAR(size.volume, 6 * base, 1e-5);
    EXPECT_NEAR(size.area, 2 * base + 6 * sides * edge, 1e-5);
    EXPECT_EQ(mesh.vertices.size(), 3u * static_cast<std::size_t>(sides));
  }
}

/// The mitre removes as much on one side as it adds on the other: the volume is that of the whole length, for any
/// number of sides.
TEST(Tubes, MitresKeepTheVolume) {
  const double a = 40 * kPi / 180;
  const TriangleMesh mesh = tubes(line_of({{0, 0, 0}, {1, 0, 0}, {1 + std::cos(a), std::sin(a), 0}}), {.radius = 0.1});
  expect_solid(mesh, 1);
  EXPECT_NEAR(measure_size(mesh).volume, 2 * 4 * 0.01 * std::sin(kPi / 4), 1e-6);
  EXPECT_EQ(mesh.vertices.size(), 24u);
}

TEST(Tubes, OfAHelixAreAsWideAsTheirRadiusEverywhere) {
  const std::vector<Vec3> x = helix(1, 0.8, 3, 200);
  const TriangleMesh mesh = tubes(line_of(x), {.radius = 0.2});
  expect_solid(mesh, 1);
  for (const Vec3f& v : mesh.vertices) EXPECT_NEAR(foot_on(x, Vec3(v)).distance, 0.2, 0.2 * 2e-3);
  // No folds: all triangles except the caps face away from the line.
  for (std::size_t t = 6; t + 6 < mesh.triangles.size(); ++t) {
    const Triangle& c = mesh.triangles[t];
    const Vec3 p(mesh.vertices[c[0]]), q(mesh.vertices[c[1]]), r(mesh.vertices[c[2]]);
    const Vec3 center = (p + q + r) / 3.0;
    EXPECT_GT(dot(normalized(cross(q - p, r - p)), normalized(center - foot_on(x, center).at)), 0.9);
  }
  const double length = 2 * kPi * 3 * std::hypot(1, 0.8 / (2 * kPi));
  EXPECT_NEAR(measure_size(mesh).volume, length * 4 * 0.04 * std::sin(kPi / 4), 2e-3);
}

/// The edges along the tube of a planar curve stay in parallel planes unless the frame twists.
TEST(Tubes, DoNotTwist) {
  std::vector<Vec3> x;
  for (int i = 0; i <= 60; ++i) x.push_back({0.1 * i, std::sin(0.2 * i), 0});
  const TriangleMesh mesh = tubes(line_of(x), {.radius = 0.02});
  ASSERT_EQ(mesh.vertices.size(), 8u * 61);
  for (std::size_t v = 8; v < mesh.vertices.size(); ++v) EXPECT_NEAR(mesh.vertices[v].z, mesh.vertices[v % 8].z, 1e-6);
}

TEST(Tubes, SharpBendsNeitherPinchNorStickOut) {
  for (const double degrees : {50.0, 90.0, 135.0, 175.0, 180.0})
    for (const Vec3& turn : {Vec3{0, 1, 0}, Vec3{0, 0, 1}, normalized(Vec3{0, 0.3, -0.9})}) {
      const double a = degrees * kPi / 180;
      const std::vector<Vec3> x = {
          {0, 0, 0}, {2, 0, 0}, Vec3{2, 0, 0} + 2.0 * (std::cos(a) * Vec3{1, 0, 0} + std::sin(a) * turn)};
      const TriangleMesh mesh = tubes(line_of(x), {.radius = 0.2});
      expect_solid(mesh, 1);
      for (const Vec3f& v : mesh.vertices) EXPECT_LE(foot_on(x, Vec3(v)).distance, 0.2 * (1 + 1e-5)) << degrees;
      // Corners around the point on the outer side have the usual distance from it.
      std::size_t outer = 0;
      const Vec3 out = normalized(x[1] - x[2]) + Vec3{1, 0, 0};
      for (const Vec3f& v : mesh.vertices) {
        const Vec3 d = Vec3(v) - x[1];
        if (!(dot(d, out) > 0.15 * norm(out) && norm(d) < 0.3)) continue;
        EXPECT_NEAR(norm(d), 0.2, 1e-5);
        ++outer;
      }
      EXPECT_GE(outer, 2u) << degrees;
    }
}

/// Curves tighter than the tube: it stays closed and within the radius of the line.
TEST(Tubes, OfTightCurvesStayWithinTheirRadius) {
  std::vector<Vec3> x = helix(0.05, 0.3, 4, 160);
  std::vector<Vec3> jagged;
  for (int i = 0; i < 50; ++i) jagged.push_back({0.03 * i, 0.02 * (i % 3), 0.02 * ((i * 7) % 5)});
  for (const std::vector<Vec3>& line : {x, jagged}) {
    const TriangleMesh mesh = tubes(line_of(line), {.radius = 0.2});
    expect_solid(mesh, 1);
    for (const Vec3f& v : mesh.vertices) EXPECT_LE(foot_on(line, Vec3(v)).distance, 0.2 * 1.083);
  }
}

/// A line that winds up endlessly at its end needs no more points than its length requires, and the tube ends at its
/// end.
TEST(Tubes, LeaveOutPointsNearerThanTheLeastStep) {
  std::vector<Vec3> x;
  for (int i = 0; i < 4000; ++i) {
    const double r = std::exp(-0.005 * i);
    x.push_back({r * std::cos(0.05 * i), r * std::sin(0.05 * i), 0});
  }
  const TriangleMesh all = tubes(line_of(x), {.radius = 0.02}),
                     some = tubes(line_of(x), {.radius = 0.02, .sides = 8, .least_step = 0.01});
  expect_solid(some, 1);
  EXPECT_LT(some.vertices.size(), all.vertices.size() / 3);
  for (const Vec3f& v : some.vertices) EXPECT_LT(foot_on(x, Vec3(v)).distance, 0.02 * 1.1);
  EXPECT_LT(norm(Vec3(some.vertices.back()) - x.back()), 0.0201);
  // Straight: the end stays in place.
  const TriangleMesh two =
      tubes(line_of({{0, 0, 0}, {1, 0, 0}, {1.4, 0, 0}}), {.radius = 0.1, .sides = 8, .least_step = 0.5});
  EXPECT_EQ(two.vertices.size(), 16u);
  EXPECT_NEAR(two.vertices.back().x, 1.4, 1e-6);
  EXPECT_TRUE(tubes(line_of({{0, 0, 0}, {1, 0, 0}}), {.radius = 0.1, .sides = 8, .least_step = 2}).triangles.empty());
}

TEST(Tubes, CarryAttributesAndLeaveOutWhatIsNoLine) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  PolylineSet lines;
  lines.origin = {4e6, -2e5, 100};
  lines.positions = {{0, 0, 0}, {1, 0, 0}, {5, 5, 5},    {7, 7, 7}, {7, 7, 7},
                     {0, 3, 0}, {1, 3, 0}, {kNan, 0, 0}, {3, 3, 0}, {4, 3, 1}};
  lines.offsets = {0, 2, 3, 5, 10};  // a line, a point, the same point twice, an interrupted line
  lines.attributes.set("time", std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  lines.line_attributes.set("seed", std::vector<std::int32_t>{10, 11, 12, 13});
  const TriangleMesh mesh = tubes(lines, {.radius = 0.1, .sides = 6});
  expect_solid(mesh, 3);
  EXPECT_EQ(mesh.origin, lines.origin);
  ASSERT_EQ(mesh.vertices.size(), 36u);
  const std::vector<double>& time = *mesh.attributes.find<double>("time");
  for (std::size_t v = 0; v < 36; ++v) {
    EXPECT_NEAR(norm(mesh.vertices[v] - lines.positions[static_cast<std::size_t>(time[v])]), 0.1, 1e-5);
  }
  const std::vector<std::int32_t>& seed = *mesh.triangle_attributes.find<std::int32_t>("seed");
  EXPECT_EQ(seed.size(), mesh.triangles.size());
  EXPECT_EQ(std::count(seed.begin(), seed.end(), 10), static_cast<long>(mesh.triangles.size() / 3));
  EXPECT_EQ(std::count(seed.begin(), seed.end(), 13), static_cast<long>(mesh.triangles.size() / 3 * 2));
}

TEST(Tubes, AreTheSameForAnyNumberOfThreads) {
  PolylineSet lines;
  for (int k = 0; k < 20; ++k) {
    for (const Vec3& p : helix(1 + 0.1 * k, 0.5, 2, 50 + k)) lines.positions.emplace_back(p);
    lines.offsets.push_back(lines.positions.size());
  }
  test::expect_equal_for_any_threads([&] {
    const TriangleMesh mesh = tubes(lines, {.radius = 0.05});
    return std::pair(mesh.vertices, mesh.triangles);
  });
}

TEST(Tubes, RefuseBadOptions) {
  const PolylineSet lines = line_of({{0, 0, 0}, {1, 0, 0}});
  EXPECT_THROW(tubes(lines, {.radius = 0}), ArgumentError);
  EXPECT_THROW(tubes(lines, {.radius = std::numeric_limits<double>::quiet_NaN()}), ArgumentError);
  EXPECT_THROW(tubes(lines, {.radius = 1, .sides = 2}), ArgumentError);
  EXPECT_THROW(tubes(lines, {.radius = 1, .sides = 8, .least_step = -1}), ArgumentError);
  EXPECT_TRUE(tubes({}, {.radius = 1}).triangles.empty());
}

}  // namespace
}  // namespace sansmesh::inline v1
