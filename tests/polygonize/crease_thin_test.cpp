#include "sansmesh/polygonize/creases/crease_thin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "sansmesh/mesh_measures.h"

namespace sansmesh::inline v1 {
namespace {

/// A flat disc of two rings about vertex 0, closed by a cone below, whose faces are separate pieces.
PieceMesh disc(std::mt19937& random, unsigned n) {
  std::uniform_real_distribution<double> uniform(0, 1);
  PieceMesh mesh;
  const auto angle = [&](double i) { return i * 2 * std::numbers::pi / n; };
  const auto inner = [&](unsigned i) { return 1 + i % n; };
  const auto outer = [&](unsigned i) { return 1 + n + i % n; };
  mesh.x.push_back({0, 0, 0});
  for (unsigned i = 0; i < n; ++i) {
    const double at = angle(i + 0.8 * uniform(random)), r = 0.4 + uniform(random);
    mesh.x.push_back({r * std::cos(at), r * std::sin(at), 0});
  }
  for (unsigned i = 0; i < n; ++i) mesh.x.push_back({4 * std::cos(angle(i)), 4 * std::sin(angle(i)), 0});
  mesh.x.push_back({0, 0, -4});
  for (unsigned i = 0; i < n; ++i) {
    mesh.triangles.push_back({0, inner(i), inner(i + 1)});
    mesh.triangles.push_back({inner(i), outer(i), outer(i + 1)});
    mesh.triangles.push_back({inner(i), outer(i + 1), inner(i + 1)});
    mesh.triangles.push_back({outer(i + 1), outer(i), 2 * n + 1});
    mesh.piece.insert(mesh.piece.end(), {0, 0, 0, 1 + i});
  }
  mesh.rank.assign(mesh.x.size(), 1);
  for (unsigned i = 0; i <= n; ++i) mesh.rank[1 + n + i] = 3;
  return mesh;
}

/// Number of triangles of the flat piece that face down, and the area of the others.
std::pair<int, double> turned_and_area(const PieceMesh& mesh) {
  int turned = 0;
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.piece[t] != 0) continue;
    const auto [a, b, c] = mesh.triangles[t];
    const double z = cross(mesh.x[b] - mesh.x[a], mesh.x[c] - mesh.x[a]).z;
    turned += z < -1e-12;
    area += std::abs(z) / 2;
  }
  return {turned, area};
}

bool closed(const PieceMesh& mesh) {
  TriangleMesh plain;
  for (const Vec3& x : mesh.x) plain.vertices.emplace_back(x);
  plain.triangles = mesh.triangles;
  return measure_topology(plain).closed();
}

TEST(CreaseThin, FlatDiscsLoseTheirInsideAndNothingElse) {
  std::mt19937 random(1);
  int cases = 0;
  for (int round = 0; round < 300; ++round) {
    PieceMesh mesh = disc(random, 6 + static_cast<unsigned>(round) % 5);
    const auto [turned, area] = turned_and_area(mesh);
    if (turned > 0) continue;
    ++cases;
    const std::size_t before = mesh.x.size();
    thin_flat_parts(mesh, 1e-6);
    EXPECT_LT(mesh.x.size(), before);
    const auto [turned_after, area_after] = turned_and_area(mesh);
    EXPECT_EQ(turned_after, 0) << round;
    EXPECT_NEAR(area_after, area, 1e-9 * area) << round;
    EXPECT_TRUE(closed(mesh)) << round;
    EXPECT_EQ(mesh.piece.size(), mesh.triangles.size());
    EXPECT_EQ(mesh.rank.size(), mesh.x.size());
  }
  EXPECT_GT(cases, 100);
}

TEST(CreaseThin, NothingTurnsOverNextToTrianglesWithoutArea) {
  std::mt19937 random(2);
  int cases = 0;
  for (int round = 0; round < 20000; ++round) {
    PieceMesh mesh = disc(random, 6 + static_cast<unsigned>(round) % 5);
    mesh.x[1] = mesh.x[0];
    const auto [turned, area] = turned_and_area(mesh);
    if (turned > 0) continue;
    ++cases;
    thin_flat_parts(mesh, 1e-6);
    const auto [turned_after, area_after] = turned_and_area(mesh);
    ASSERT_EQ(turned_after, 0) << round;
    ASSERT_NEAR(area_after, area, 1e-9 * area) << round;
  }
  EXPECT_GT(cases, 1000);
}

TEST(CreaseThin, BentPartsStay) {
  std::mt19937 random(3);
  PieceMesh mesh = disc(random, 8);
  for (unsigned i = 0; i <= 8; ++i) mesh.x[i].z = 1 + 0.1 * i;
  const std::vector<Triangle> triangles = mesh.triangles;
  thin_flat_parts(mesh, 1e-6);
  EXPECT_EQ(mesh.triangles, triangles);
}

}  // namespace
}  // namespace sansmesh::inline v1
