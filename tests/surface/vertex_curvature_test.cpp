#include "sansmesh/surface/vertex_curvature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::test {
namespace {

/// Tube radius of torus_mesh.
constexpr double kTube = 0.35;

PointSet samples_of(const TriangleMesh& mesh) {
  PointSet points;
  points.positions = mesh.vertices;
  points.triangles = mesh.triangles;
  set_normals_from_faces(points);
  return points;
}

std::vector<FittedCurvatures> curvatures_of(const TriangleMesh& mesh, CurvatureOptions options = {}) {
  Progress progress;
  if (!options.noise) options.noise = 0;
  return estimate_vertex_curvatures(samples_of(mesh), options, progress);
}

/// Root mean square error of both curvatures over their root mean square.
template <class Truth>
double error_of(const TriangleMesh& mesh, const std::vector<FittedCurvatures>& found, const Truth& truth) {
  double off = 0, all = 0;
  for (std::size_t v = 0; v < found.size(); ++v) {
    EXPECT_TRUE(found[v].defined) << v;
    const auto [k1, k2] = truth(Vec3(mesh.vertices[v]));
    off += std::pow(static_cast<double>(found[v].k1) - k1, 2) + std::pow(static_cast<double>(found[v].k2) - k2, 2);
    all += k1 * k1 + k2 * k2;
  }
  return std::sqrt(off / all);
}

std::pair<double, double> torus_curvatures(const Vec3& p) {
  const double away = std::hypot(p.x, p.y);
  return {1 / kTube, (away - 1) / (kTube * away)};
}

std::pair<double, double> sphere_curvatures(const Vec3&) { return {1, 1}; }

TEST(VertexCurvature, OfSpheresIsExact) {
  for (const int levels : {1, 2, 4}) {
    const TriangleMesh mesh = octasphere(levels);
    EXPECT_LT(error_of(mesh, curvatures_of(mesh), sphere_curvatures), 1e-4) << levels;
  }
}

TEST(VertexCurvature, OfToriIsTheBetterTheFinerTheyAre) {
  double coarser = 1;
  for (const auto& [m, most] : {std::pair(24u, 0.2), std::pair(48u, 0.06), std::pair(96u, 0.02)}) {
    const TriangleMesh mesh = torus_mesh(m, m / 2);
    const double error = error_of(mesh, curvatures_of(mesh), torus_curvatures);
    EXPECT_LT(error, most) << m;
    EXPECT_LT(error, 0.4 * coarser) << m;
    coarser = error;
  }
}

TEST(VertexCurvature, OfCleanCoarseToriHasTheErrorOfItsOrder) {
  // Sixteen vertices along the torus need directional curvatures, more of them quartics.
  for (const auto& [m, most] : {std::pair(16u, 0.12), std::pair(32u, 0.02), std::pair(64u, 0.0012)}) {
    const TriangleMesh mesh = torus_mesh(m, m / 2);
    EXPECT_LT(error_of(mesh, curvatures_of(mesh), torus_curvatures), most) << m;
  }
}

TEST(VertexCurvature, OfIrregularTrianglesIsAsGood) {
  // Dihedral angles and angle defects, the discrete operators, do not converge here: 20 % at any resolution.
  for (const auto& [m, most] : {std::pair(32u, 0.03), std::pair(64u, 0.003)}) {
    TriangleMesh mesh = torus_mesh(m, m / 2);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> shift(-0.3, 0.3);
    for (Vec3f& p : mesh.vertices) {
      const double u = std::atan2(p.y, p.x) + shift(random) * 2 * std::numbers::pi / m;
      const double v = std::atan2(p.z, std::hypot(p.x, p.y) - 1) + shift(random) * 4 * std::numbers::pi / m;
      const double away = 1 + kTube * std::cos(v);
      p = Vec3f(Vec3{away * std::cos(u), away * std::sin(u), kTube * std::sin(v)});
    }
    EXPECT_LT(error_of(mesh, curvatures_of(mesh), torus_curvatures), most) << m;
  }
}

TEST(VertexCurvature, NoiseKeepsTheQuadric) {
  TriangleMesh mesh = torus_mesh(96, 48);
  const TriangleMesh clean = mesh;
  constexpr double kNoise = 0.005;  // a tenth of an edge
  std::mt19937 random(2);
  std::normal_distribution<double> gauss(0, kNoise);
  for (Vec3f& p : mesh.vertices) p += Vec3f(Vec3{gauss(random), gauss(random), gauss(random)});
  CurvatureOptions options;
  options.noise = kNoise;
  const auto found = curvatures_of(mesh, options);
  EXPECT_LT(error_of(clean, found, torus_curvatures), 0.12);
  options.neighbours = 20;
  EXPECT_GT(error_of(clean, curvatures_of(mesh, options), torus_curvatures), 0.3);
}

TEST(VertexCurvature, GradedTrianglesAreNoHarm) {
  // Rings are on all sides of a vertex, the nearest vertices on one only. Here edges grow ninefold around the tube.
  TriangleMesh mesh = torus_mesh(96, 48);
  for (Vec3f& p : mesh.vertices) {
    const double u = std::atan2(p.y, p.x);
    double v = std::atan2(p.z, std::hypot(p.x, p.y) - 1);
    v += 0.8 * std::sin(v);
    const double away = 1 + kTube * std::cos(v);
    p = Vec3f(Vec3{away * std::cos(u), away * std::sin(u), kTube * std::sin(v)});
  }
  EXPECT_LT(error_of(mesh, curvatures_of(mesh), torus_curvatures), 0.05);
}

TEST(VertexCurvature, AtBordersIsAsOfWhatIsThere) {
  TriangleMesh bowl = octasphere(4);
  std::erase_if(bowl.triangles, [&](const Triangle& t) {
    return std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return bowl.vertices[v].z < -0.3f; });
  });
  const std::vector<FittedCurvatures> found = curvatures_of(bowl);
  for (std::size_t v = 0; v < found.size(); ++v) {
    if (!found[v].defined) {
      EXPECT_LT(bowl.vertices[v].z, -0.3f) << "of no triangle";
      continue;
    }
    EXPECT_NEAR(found[v].k1, 1, 1e-3);
    EXPECT_NEAR(found[v].k2, 1, 1e-3);
  }
}

TEST(VertexCurvature, TheOtherSideOfAThinShellIsNoNeighbour) {
  TriangleMesh inner = octasphere(3);
  for (Vec3f& p : inner.vertices) p *= 0.98f;
  for (Triangle& t : inner.triangles) std::swap(t[1], t[2]);
  const TriangleMesh shell = joined(octasphere(3), inner, {});
  EXPECT_LT(error_of(shell, curvatures_of(shell),
                     [](const Vec3& p) {
                       const double k = norm(p) < 0.99 ? -1 / norm(p) : 1 / norm(p);
                       return std::pair(k, k);
                     }),
            1e-3);
}

TEST(VertexCurvature, SeamsAreNoBorders) {
  TriangleMesh whole = torus_mesh(48, 24), soup;
  for (const Triangle& t : whole.triangles) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(whole.vertices[v]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  const std::vector<FittedCurvatures> apart = curvatures_of(soup), together = curvatures_of(whole);
  for (std::size_t i = 0; i < whole.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(apart[3 * i + k].k1, together[whole.triangles[i][k]].k1, 0.01);
      EXPECT_NEAR(apart[3 * i + k].k2, together[whole.triangles[i][k]].k2, 0.01);
    }
}

TEST(VertexCurvature, WhatLiesBehindAHubIsNotNear) {
  // A disc of many spokes with a wide rim. A change of the rim on one side has no effect on the other.
  constexpr std::uint32_t n = 300, rows = 12;
  PointSet disc;
  disc.positions.push_back({});
  for (std::uint32_t r = 0; r < rows; ++r)
    for (std::uint32_t k = 0; k < n; ++k) {
      const double turn = 2 * std::numbers::pi * k / n, away = 1 + 0.02 * r;
      disc.positions.push_back(Vec3f(Vec3{away * std::cos(turn), away * std::sin(turn), 5e-3 * r * r}));
    }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t l = (k + 1) % n;
    disc.triangles.push_back({0, 1 + k, 1 + l});
    for (std::uint32_t a = 1; a + n < 1 + rows * n; a += n) {
      disc.triangles.push_back({a + k, a + k + n, a + l + n});
      disc.triangles.push_back({a + k, a + l + n, a + l});
    }
  }
  set_normals_from_faces(disc);
  PointSet bent = disc;
  for (std::size_t v = 1; v < bent.size(); ++v)
    if (bent.positions[v].x < 0) bent.positions[v].z += 0.3f * bent.positions[v].x * bent.positions[v].x;
  CurvatureOptions options;
  options.noise = 0;
  options.neighbours = 24;
  Progress progress;
  const auto straight = estimate_vertex_curvatures(disc, options, progress);
  const auto changed = estimate_vertex_curvatures(bent, options, progress);
  for (std::size_t v = 1; v < disc.size(); ++v) {
    if (disc.positions[v].x < 0.3f) continue;
    EXPECT_EQ(straight[v].k1, changed[v].k1) << v;
    EXPECT_EQ(straight[v].k2, changed[v].k2) << v;
  }
}

TEST(VertexCurvature, CapsOfManySpokesDoNotBendTheSide) {
  // A can of radius 1; the rows of its side are farther apart than its spokes.
  constexpr std::uint32_t n = 400, rows = 9;
  TriangleMesh can;
  for (std::uint32_t r = 0; r < rows; ++r)
    for (std::uint32_t k = 0; k < n; ++k) {
      const double turn = 2 * std::numbers::pi * k / n;
      can.vertices.push_back(Vec3f(Vec3{std::cos(turn), std::sin(turn), 0.1 * r}));
    }
  can.vertices.push_back({0, 0, 0}), can.vertices.push_back({0, 0, 0.8f});
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t l = (k + 1) % n, top = (rows - 1) * n;
    can.triangles.push_back({rows * n, l, k});
    can.triangles.push_back({rows * n + 1, top + k, top + l});
    for (std::uint32_t a = 0; a < top; a += n) {
      can.triangles.push_back({a + k, a + l, a + l + n});
      can.triangles.push_back({a + k, a + l + n, a + k + n});
    }
  }
  CurvatureOptions options;
  options.neighbours = 24;
  const auto found = curvatures_of(can, options);
  for (std::uint32_t v = 2 * n; v < (rows - 2) * n; ++v) {
    EXPECT_NEAR(found[v].k1, 1, 0.01) << v;
    EXPECT_NEAR(found[v].k2, 0, 0.01) << v;
  }
}

TEST(VertexCurvature, WithinARadius) {
  const TriangleMesh mesh = octasphere(4);
  CurvatureOptions options;
  options.bandwidth = 0.3;
  EXPECT_LT(error_of(mesh, curvatures_of(mesh, options), sphere_curvatures), 1e-3);
}

TEST(VertexCurvature, AnyThreads) {
  const TriangleMesh mesh = torus_mesh(96, 48);
  expect_equal_for_any_threads([&] {
    std::vector<float> numbers;
    for (const FittedCurvatures& c : curvatures_of(mesh)) numbers.insert(numbers.end(), {c.k1, c.k2, c.offset});
    return numbers;
  });
}

TEST(VertexCurvature, BadInput) {
  PointSet mesh = samples_of(octasphere(1));
  Progress progress;
  EXPECT_THROW(estimate_vertex_curvatures(mesh, {.tau = 9}, progress), ArgumentError);
  PointSet cloud = mesh;
  cloud.triangles.clear();
  EXPECT_THROW(estimate_vertex_curvatures(cloud, {}, progress), DataError);
  mesh.normals.clear();
  EXPECT_THROW(estimate_vertex_curvatures(mesh, {}, progress), DataError);
}

}  // namespace
}  // namespace sansmesh::test
