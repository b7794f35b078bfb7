#include "sansmesh/mesh/edit/smooth_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/refine_edges.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::test {
namespace {

TriangleMesh shaken(TriangleMesh mesh, double size) {
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, static_cast<float>(size));
  for (Vec3f& v : mesh.vertices) v += Vec3f{noise(random), noise(random), noise(random)};
  return mesh;
}

double rms_off_sphere(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Vec3f& v : mesh.vertices) sum += std::pow(norm(Vec3(v)) - 1, 2);
  return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
}

/// Cube of side 2 with small triangles.
TriangleMesh fine_cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices.push_back({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  refine_edges(mesh, 0.15);
  return mesh;
}

double rms_off_cube(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Vec3f& v : mesh.vertices) sum += std::pow(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) - 1, 2);
  return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
}

TEST(SmoothMesh, CoarseMeshesKeepTheirVolumeToo) {
  // The filter removes two thirds of an octahedron's radius: a single correction step overshoots.
  for (const int levels : {0, 1}) {
    TriangleMesh mesh = octasphere(levels);
    Progress progress;
    const SmoothReport report = smooth_mesh(mesh, {}, progress);
    ASSERT_TRUE(report.volume_before && report.volume_after);
    EXPECT_NEAR(*report.volume_after / *report.volume_before, 1, 1e-3) << levels;
    EXPECT_LT(report.largest_move, 0.1) << levels;
  }
}

TEST(SmoothMesh, TakesNoiseOffAndKeepsTheVolume) {
  TriangleMesh mesh = shaken(octasphere(4), 0.01);
  const double before = rms_off_sphere(mesh);
  Progress progress;
  const SmoothReport report = smooth_mesh(mesh, {}, progress);
  EXPECT_LT(rms_off_sphere(mesh), 0.5 * before);
  ASSERT_TRUE(report.volume_before && report.volume_after);
  EXPECT_NEAR(*report.volume_after / *report.volume_before, 1, 0.003);
  EXPECT_GT(report.rms_move, 0.005);
  EXPECT_GE(report.largest_move, report.rms_move);
  EXPECT_EQ(report.fixed, 0u);
}

TEST(SmoothMesh, EachComponentKeepsItsVolume) {
  const auto part = [](const TriangleMesh& mesh, std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const auto [a, b, c] = mesh.triangles[i];
      const Vec3 o(mesh.vertices[mesh.triangles[begin][0]]);
      sum += dot(Vec3(mesh.vertices[a]) - o, cross(Vec3(mesh.vertices[b]) - o, Vec3(mesh.vertices[c]) - o)) / 6;
    }
    return sum;
  };
  const TriangleMesh noisy = shaken(octasphere(4), 0.05);
  TriangleMesh small = octasphere(3);
  for (Vec3f& v : small.vertices) v *= 0.1f;
  for (const bool creases : {false, true}) {
    SCOPED_TRACE(creases);
    const TriangleMesh before = joined(noisy, small, {3, 0, 0});
    TriangleMesh after = before;
    Progress progress;
    smooth_mesh(after, {.creases = creases}, progress);
    const std::size_t first = noisy.triangles.size(), all = before.triangles.size();
    EXPECT_NEAR(part(after, 0, first) / part(before, 0, first), 1, 0.003);
    EXPECT_NEAR(part(after, first, all) / part(before, first, all), 1, 0.003);
  }
}

TEST(SmoothMesh, LengthSaysWhichWavesGo) {
  // Ripples around a torus: short ones must be halved, long ones hardly change.
  const auto torus = torus_mesh(120, 40);
  for (const auto& [waves, least, most] : {std::tuple(30, 0.35, 0.7), std::tuple(8, 0.93, 1.1)}) {
    TriangleMesh mesh = torus;
    std::vector<double> phase;
    for (Vec3f& v : mesh.vertices) {
      phase.push_back(std::cos(waves * std::atan2(v.y, v.x)));
      v.z += static_cast<float>(0.005 * phase.back());
    }
    Progress progress;
    TriangleMesh plain = torus;
    SmoothOptions options;
    options.shorter_than = 2 * std::numbers::pi / 30;  // at the centre line of the tube
    smooth_mesh(mesh, options, progress);
    smooth_mesh(plain, options, progress);
    double left = 0, all = 0;
    for (std::size_t v = 0; v < phase.size(); ++v) {
      left += phase[v] * static_cast<double>(mesh.vertices[v].z - plain.vertices[v].z);
      all += 0.005 * phase[v] * phase[v];
    }
    EXPECT_GT(left / all, least) << waves;
    EXPECT_LT(left / all, most) << waves;
  }
}

TEST(SmoothMesh, CreasesStayWhereAsked) {
  const TriangleMesh noisy = shaken(fine_cube(), 0.01);
  TriangleMesh round = noisy, sharp = noisy;
  Progress progress;
  smooth_mesh(round, {}, progress);
  SmoothOptions options;
  options.creases = true;
  const SmoothReport report = smooth_mesh(sharp, options, progress);
  EXPECT_GT(report.crease_angle, 0);
  EXPECT_LT(rms_off_cube(sharp), 0.5 * rms_off_cube(noisy));
  EXPECT_LT(rms_off_cube(sharp), 0.7 * rms_off_cube(round));
}

/// Closed prism over a triangulated polygon (counter-clockwise, seen from +z), with small triangles.
TriangleMesh fine_prism(const std::vector<std::pair<double, double>>& outline, const std::vector<Triangle>& inside,
                        double depth, double longest) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {0.0, depth})
    for (const auto& [x, y] : outline) mesh.vertices.push_back(Vec3f(Vec3{x, y, z}));
  for (const Triangle& t : inside) {
    mesh.triangles.push_back({t[2], t[1], t[0]});
    mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
  for (std::uint32_t a = 0; a < n; ++a) {
    const std::uint32_t b = (a + 1) % n;
    mesh.triangles.push_back({a, b, b + n});
    mesh.triangles.push_back({a, b + n, a + n});
  }
  refine_edges(mesh, longest);
  return mesh;
}

TEST(SmoothMesh, TheAmountFollowsTheNoise) {
  const TriangleMesh clean = octasphere(5);
  const double edge = 0.048;
  double last = -1;
  for (const double noise : {0.0, 0.1, 0.2, 0.3}) {
    TriangleMesh mesh = shaken(clean, noise * edge);
    Progress progress;
    const SmoothReport report = smooth_mesh(mesh, {}, progress);
    EXPECT_NEAR(report.noise, noise * edge, 0.03 * edge + 0.2 * noise * edge);
    EXPECT_GT(report.iterations, last);
    last = report.iterations;
    EXPECT_LT(rms_off_sphere(mesh), 0.6 * noise * edge + 0.003 * edge) << noise;
  }
}

TEST(SmoothMesh, CreasesStayUnderNoiseOfHalfAnEdge) {
  const TriangleMesh clean = fine_cube();
  SmoothOptions options;
  options.creases = true;
  Progress progress;
  TriangleMesh noisy = shaken(clean, 0.05);
  const double before = rms_off_cube(noisy);
  const SmoothReport report = smooth_mesh(noisy, options, progress);
  EXPECT_GT(report.noise, 0.3 * report.mean_edge);
  EXPECT_LT(rms_off_cube(noisy), 0.3 * before);
  EXPECT_NEAR(*report.volume_after / 8, 1, 0.01);
  TriangleMesh same = clean;
  smooth_mesh(same, options, progress);
  EXPECT_LT(rms_off_cube(same), 1e-4);
}

TEST(SmoothMesh, CreasesKeepTheVolumeToo) {
  // A hinge of two leaves thinner than the edges, which would lose a fifth of its volume; a box; a cylinder. The noise
  // is a third of an edge.
  const std::vector<std::pair<double, double>> hinge_outline{{0, 0}, {1, 0}, {1, 0.1}, {0.1, 0.1}, {0.1, 1}, {0, 1}};
  const std::vector<Triangle> hinge_inside{{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}};
  const TriangleMesh hinge = fine_prism(hinge_outline, hinge_inside, 1, 0.3);
  std::vector<std::pair<double, double>> circle;
  std::vector<Triangle> fan;
  for (std::uint32_t k = 0; k < 24; ++k) {
    circle.push_back({0.5 * std::cos(k * std::numbers::pi / 12), 0.5 * std::sin(k * std::numbers::pi / 12)});
    if (k >= 2) fan.push_back({0, k - 1, k});
  }
  for (const auto& [name, mesh, noise] : {std::tuple("hinge", hinge, 0.1), std::tuple("box", fine_cube(), 0.05),
                                          std::tuple("cylinder", fine_prism(circle, fan, 1, 0.12), 0.03)}) {
    TriangleMesh smooth = shaken(mesh, noise);
    Progress progress;
    SmoothOptions options;
    options.creases = true;
    const SmoothReport report = smooth_mesh(smooth, options, progress);
    ASSERT_TRUE(report.volume_before && report.volume_after) << name;
    EXPECT_NEAR(*report.volume_after / *report.volume_before, 1, 0.002) << name;
  }
}

TEST(SmoothMesh, BordersStayAndSeamsDoNotOpen) {
  TriangleMesh sheet;
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) sheet.vertices.push_back({float(x), float(y), 0.1f * float((10 * y + x) * 7 % 5)});
  for (std::uint32_t y = 0; y < 9; ++y)
    for (std::uint32_t x = 0; x < 9; ++x) {
      const std::uint32_t a = 10 * y + x;
      sheet.triangles.push_back({a, a + 1, a + 11});
      sheet.triangles.push_back({a, a + 11, a + 10});
    }
  TriangleMesh soup;  // separate vertices for every triangle
  for (const Triangle& t : sheet.triangles) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(sheet.vertices[v]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  const TriangleMesh before = sheet;
  Progress progress;
  const SmoothReport report = smooth_mesh(sheet, {}, progress);
  EXPECT_EQ(report.fixed, 36u);
  EXPECT_FALSE(report.volume_before);
  for (std::size_t v = 0; v < 100; ++v) {
    const bool border = v % 10 == 0 || v % 10 == 9 || v < 10 || v >= 90;
    EXPECT_EQ(sheet.vertices[v] == before.vertices[v], border) << v;
  }
  smooth_mesh(soup, {}, progress);
  for (std::size_t i = 0; i < sheet.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LT(norm(soup.vertices[3 * i + k] - sheet.vertices[sheet.triangles[i][k]]), 1e-5f);
  SmoothOptions along;
  along.borders = true;
  EXPECT_EQ(smooth_mesh(sheet, along, progress).fixed, 0u);
}

TEST(SmoothMesh, AnyThreads) {
  expect_equal_for_any_threads([] {
    TriangleMesh a = shaken(octasphere(3), 0.01), b = a;
    Progress progress;
    smooth_mesh(a, {}, progress);
    SmoothOptions options;
    options.creases = true;
    smooth_mesh(b, options, progress);
    return std::pair(a.vertices, b.vertices);
  });
}

TEST(SmoothMesh, BadOptions) {
  TriangleMesh mesh = octasphere(1);
  Progress progress;
  const auto fails = [&](auto change) {
    SmoothOptions options;
    change(options);
    EXPECT_THROW(smooth_mesh(mesh, options, progress), ArgumentError);
  };
  fails([](SmoothOptions& o) { o.iterations = 0; });
  fails([](SmoothOptions& o) { o.strength = 0.7; });
  fails([](SmoothOptions& o) { o.shorter_than = -1; });
  fails([](SmoothOptions& o) { o.shorter_than = 1, o.creases = true; });
  fails([](SmoothOptions& o) { o.crease_angle = 20; });
}

}  // namespace
}  // namespace sansmesh::test
