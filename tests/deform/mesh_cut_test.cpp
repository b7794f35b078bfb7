// Meshes as cuts: detours on a lattice compared with closed forms, and gaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "deform/cut_support.h"
#include "sansmesh/deform/cuts/mesh_occluder.h"
#include "sansmesh/error.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::blocked;
using test::detour;
using test::gap;
using test::random_point;

/// A square in z = 0.013 of 8 × 8 cells, or with `bend` a part of a cylinder.
TriangleMesh square_sheet(double bend = 0) {
  constexpr std::uint32_t n = 8;
  TriangleMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = -0.5 + i / 8.0, y = -0.5 + j / 8.0;
      mesh.vertices.push_back(Vec3f(Vec3{x, y, 0.013 + bend * x * x}));
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  return mesh;
}

MeshOccluderOptions in_cube(int resolution) {
  MeshOccluderOptions options;
  options.resolution = resolution;
  options.domain = Box3{{-1, -1, -1}, {1, 1, 1}};
  return options;
}

TEST(MeshCut, WaysAroundAPlaneAreThoseOfThePolygon) {
  const double z = static_cast<double>(0.013f);
  const auto polygon = polygon_occluder({{{-0.5, -0.5, z}, {0.5, -0.5, z}, {0.5, 0.5, z}, {-0.5, 0.5, z}}});
  double before = 1e9;
  for (const int resolution : {16, 32, 64}) {
    const auto cut = mesh_occluder(square_sheet(), in_cube(resolution));
    std::mt19937 random(1);
    double error = 0, extra = 0, most = 0, most_seen = 0;
    for (int h = 0; h < 4; ++h) {
      Vec3 handle = random_point(random, 0.7);
      handle.z = 0.2 + std::abs(handle.z);
      for (int i = 0; i < 4000; ++i) {
        const Vec3 x = random_point(random);
        const double found = detour(*cut, handle, x).extra, right = detour(*polygon, handle, x).extra;
        EXPECT_GE(found, 0);
        if (right == 0) {
          most_seen = std::max(most_seen, found);
          continue;
        }
        error += std::abs(found - right), extra += right, most = std::max(most, std::abs(found - right));
      }
    }
    const double cell = 2.0 / resolution;
    EXPECT_LT(error, (resolution == 16 ? 0.1 : resolution == 32 ? 0.03 : 0.01) * extra) << resolution;
    EXPECT_LT(error, 0.5 * before);  // nearly second order
    EXPECT_LT(most, 0.6 * cell);
    EXPECT_LT(most_seen, 0.2 * cell);
    before = error;
  }
}

TEST(MeshCut, WaysAroundASphereAreTangentsAndArcs) {
  TriangleMesh sphere = test::octasphere(4);
  for (Vec3f& p : sphere.vertices) p = p * 0.5f;
  const auto cut = mesh_occluder(sphere, in_cube(48));
  const auto right = [](const Vec3& a, const Vec3& b) {
    const double r = 0.5, ra = norm(a), rb = norm(b);
    const double arc = std::acos(dot(a, b) / (ra * rb)) - std::acos(r / ra) - std::acos(r / rb);
    return arc > 0 ? std::sqrt(ra * ra - r * r) + std::sqrt(rb * rb - r * r) + r * arc - norm(a - b) : 0.0;
  };
  std::mt19937 random(2);
  const Vec3 handle{0.1, 0.7, 0.4};
  double error = 0, extra = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 x = random_point(random);
    if (norm(x) < 0.55) continue;
    const double found = detour(*cut, handle, x).extra;
    EXPECT_NEAR(found, right(handle, x), 0.02);
    error += std::abs(found - right(handle, x)), extra += right(handle, x);
  }
  EXPECT_LT(error, 0.06 * extra);
  // The inside of a closed surface is unreachable from outside, and vice versa.
  EXPECT_GT(detour(*cut, handle, {0.1, 0, 0.1}).extra, 1e5);
  EXPECT_GT(detour(*cut, {0, 0, 0.1}, {0.7, 0, 0.1}).extra, 1e5);
  EXPECT_EQ(detour(*cut, {0, 0, 0.1}, {0.1, 0.1, 0}).extra, 0);
  EXPECT_TRUE(std::isfinite(detour(*cut, handle, {0.1, 0, 0.1}).extra));
}

TEST(MeshCut, WaysAreContinuousButAcrossTheSheet) {
  const auto cut = mesh_occluder(square_sheet(0.8), in_cube(32));
  std::mt19937 random(3);
  int crossed = 0, mixed = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 handle = random_point(random, 0.9), from = random_point(random, 0.9), to = random_point(random, 0.9);
    if (blocked(*cut, from, to)) {
      ++crossed;
      continue;
    }
    constexpr int kSteps = 8000;
    double most = 0, before = 0;
    bool seen = false, hidden = false;
    for (int k = 0; k <= kSteps; ++k) {
      const double extra = detour(*cut, handle, from + (to - from) * (static_cast<double>(k) / kSteps)).extra;
      if (k > 0) most = std::max(most, std::abs(extra - before));
      before = extra;
      (extra > 0 ? hidden : seen) = true;
    }
    mixed += seen && hidden;
    EXPECT_LT(most, 0.005) << i;
  }
  EXPECT_GT(crossed, 5);
  EXPECT_GT(mixed, 10);
}

TEST(MeshCut, GradientsOfWaysAreThoseOfDifferences) {
  const auto cut = mesh_occluder(square_sheet(0.8), in_cube(32));
  std::mt19937 random(4);
  const Vec3 handle{0.1, -0.1, 0.8};
  int shadowed = 0, off = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = random_point(random, 0.9);
    const Detour found = detour(*cut, handle, x);
    if (found.extra == 0) continue;
    ++shadowed;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 step;
      step[k] = 1e-7;
      if (blocked(*cut, x - step, x + step)) continue;
      const double slope = (detour(*cut, handle, x + step).extra - detour(*cut, handle, x - step).extra) / 2e-7;
      off += std::abs(found.gradient[k] - slope) > 1e-3;  // kinks at faces of cells
    }
  }
  EXPECT_GT(shadowed, 300);
  EXPECT_LT(off, shadowed / 100);
}

TEST(MeshCut, GapsAreWhereTheSourceIsAcross) {
  const auto cut = mesh_occluder(square_sheet(0.8), in_cube(8));
  std::mt19937 random(5);
  int open = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 x = random_point(random), u = random_point(random, 0.5) + x;
    const double depth = gap(*cut, x, u, {}).depth;
    EXPECT_EQ(depth > 0, blocked(*cut, x, u));
    open += depth > 0;
  }
  EXPECT_GT(open, 100);
  EXPECT_LT(gap(*cut, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, {}).depth, 0);
}

/// A smooth source map with derivatives.
Vec3 mesh_source_of(const Vec3& x, std::array<Vec3, 3>* jacobian = nullptr) {
  if (jacobian) *jacobian = {Vec3{1, 0, 0.3}, Vec3{0.2 * std::cos(x.y), 1, 0}, Vec3{0, 0.1, 1}};
  return {x.x + 0.2 * std::sin(x.y), x.y + 0.1 * x.z, x.z + 0.3 * x.x - 0.25};
}

TEST(MeshCut, GapsAreContinuousWithGradients) {
  const auto cut = mesh_occluder(square_sheet(0.8), in_cube(8));
  std::mt19937 random(6);
  int checked = 0, open = 0;
  const auto depth = [&](const Vec3& p) { return gap(*cut, p, mesh_source_of(p), {}).depth; };
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = random_point(random, 0.6);
    std::array<Vec3, 3> jacobian;
    const Vec3 u = mesh_source_of(x, &jacobian);
    const Gap found = gap(*cut, x, u, jacobian);
    const auto slopes = test::depth_slopes(depth, x, found.depth);
    if (!slopes) continue;
    ++checked, open += found.depth > 0;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found.gradient[k], (*slopes)[k], 1e-5);
  }
  EXPECT_GT(checked, 200);
  EXPECT_GT(open, 20);
  for (int i = 0; i < 20; ++i) {
    const Vec3 from = random_point(random, 0.7), to = random_point(random, 0.7);
    double most = 0, before = depth(from);
    for (int k = 1; k <= 5000; ++k) {
      const double now = depth(from + (to - from) * (k / 5000.0));
      most = std::max(most, std::abs(now - before));
      before = now;
    }
    EXPECT_LT(most, 0.01);
  }
}

TEST(MeshCut, TheSameForAnyNumberOfThreads) {
  test::expect_equal_for_any_threads([] {
    const auto cut = mesh_occluder(square_sheet(0.8), in_cube(16));
    std::vector<double> found;
    std::mt19937 random(7);
    for (int i = 0; i < 300; ++i) found.push_back(detour(*cut, {0.1, 0.2, 0.6}, random_point(random)).extra);
    return found;
  });
}

TEST(MeshCut, BadOnesAreRefused) {
  MeshOccluderOptions options;
  options.resolution = 7;
  EXPECT_THROW(mesh_occluder(square_sheet(), options), ArgumentError);
  EXPECT_THROW(mesh_occluder(TriangleMesh{}), ArgumentError);
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_THROW(mesh_occluder(flat), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
