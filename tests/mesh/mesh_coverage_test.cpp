#include "sansmesh/mesh/mesh_coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sansmesh/error.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kCount = 50000;

MeshCoverage coverage(const TriangleMesh& mesh, const PointSet& samples, std::size_t count = kCount) {
  Progress progress;
  return measure_coverage(mesh, samples, count, progress);
}

/// Samples of [0, width] × [0, 1]: a lattice of n × n per unit square with small random shifts.
PointSet sheet_samples(int n, int width = 1) {
  PointSet cloud;
  for (int i = 0; i < n * width; ++i)
    for (int j = 0; j < n; ++j) {
      const float dx = 0.2f * static_cast<float>(std::sin(7.0 * i + 3.0 * j));
      cloud.positions.push_back({(static_cast<float>(i) + 0.5f + dx) / static_cast<float>(n),
                                 (static_cast<float>(j) + 0.5f) / static_cast<float>(n), 0});
    }
  return cloud;
}

/// [0, width] × [0, 1] as two triangles.
TriangleMesh rectangle(float width) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {width, 0, 0}, {width, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(MeshCoverage, HalfOfASheetWithoutSamplesIsInventedHoweverLargeItsTriangles) {
  const int n = 100;
  const MeshCoverage c = coverage(rectangle(2), sheet_samples(n));
  EXPECT_NEAR(c.spacing, 1.0 / n, 0.1 / n);
  // The tolerance at the border of the samples is four spacings.
  EXPECT_NEAR(c.invented.share, 0.5 - 0.5 * c.invented.beyond, 0.005);
  EXPECT_NEAR(c.invented.beyond, 4 * c.spacing, 1e-12);
  EXPECT_EQ(c.lost.share, 0);
  EXPECT_FALSE(c.lost.densest);
  ASSERT_TRUE(c.invented.densest);
  EXPECT_GT(c.invented.densest->x, 1);
}

TEST(MeshCoverage, HalfOfTheSamplesWithoutSurfaceAreLost) {
  const int n = 100;
  const MeshCoverage c = coverage(rectangle(1), sheet_samples(n, 2));
  EXPECT_NEAR(c.lost.share, 0.5 - 0.5 * c.lost.beyond, 0.5 / n);
  EXPECT_NEAR(c.lost.beyond, std::max(2 * c.spacing, 4 * c.noise), 1e-12);
  EXPECT_EQ(c.lost.tested, 2u * n * n);
  EXPECT_EQ(c.invented.share, 0);
  EXPECT_FALSE(c.invented.densest);
  ASSERT_TRUE(c.lost.densest);
  EXPECT_GT(c.lost.densest->x, 1);
}

TEST(MeshCoverage, ThereIsNothingToSayOfAWholeSurface) {
  const MeshCoverage c = coverage(test::octasphere(5), test::sphere(5000));
  EXPECT_EQ(c.lost.share, 0);
  EXPECT_EQ(c.invented.share, 0);
  EXPECT_EQ(c.lost.tested, 5000u);
  EXPECT_EQ(c.invented.tested, kCount);
}

TEST(MeshCoverage, NoiseIsNotLost) {
  // Four times the noise is far more than two spacings here; of Gaussian noise, one sample in 16,000 is beyond.
  const MeshCoverage c = coverage(test::octasphere(5), test::sphere(20000, 0.05));
  EXPECT_GT(c.lost.beyond, 3 * c.spacing);
  EXPECT_LT(c.lost.share, 0.001);
  EXPECT_EQ(c.invented.share, 0);
}

TEST(MeshCoverage, SaysWhereMostIsLostAndInvented) {
  // Two balls without a surface, one with twice the samples; two surfaces without samples, one with four times the
  // area.
  PointSet cloud = test::joined(test::sphere(8000), test::sphere(500), 0.2f, {4, 0, 0});
  cloud = test::joined(cloud, test::sphere(1000), 0.2f, {0, 4, 0});
  TriangleMesh mesh = test::octasphere(4), small = mesh, large = mesh;
  for (Vec3f& v : small.vertices) v *= 0.2f;
  for (Vec3f& v : large.vertices) v *= 0.4f;
  mesh = test::joined(test::joined(mesh, small, {-4, 0, 0}), large, {0, -4, 0});
  const MeshCoverage c = coverage(mesh, cloud);
  EXPECT_NEAR(c.lost.share, 1500.0 / 9500, 1e-12);
  EXPECT_NEAR(c.invented.share, (0.04 + 0.16) / 1.2, 0.002);
  EXPECT_LT(norm(*c.lost.densest - Vec3{0, 4, 0}), 0.25);
  EXPECT_LT(norm(*c.invented.densest - Vec3{0, -4, 0}), 0.45);
}

TEST(MeshCoverage, OriginsMayDifferAndSamplesNeedNotBeFinite) {
  PointSet cloud = sheet_samples(60, 2), moved = cloud;
  moved.origin = {500000, 4000000, 100};
  for (Vec3f& p : moved.positions) p = p - Vec3f{0.5f, 0.25f, 0};
  moved.positions.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  TriangleMesh mesh = rectangle(1);
  mesh.origin = moved.origin - Vec3{0.5, 0.25, 0};
  const MeshCoverage here = coverage(rectangle(1), cloud), there = coverage(mesh, moved);
  EXPECT_EQ(there.lost.tested, cloud.size());
  EXPECT_NEAR(here.lost.share, there.lost.share, 0.01);
  EXPECT_GT(there.lost.densest->x, 500000);
}

TEST(MeshCoverage, WithoutTrianglesAllIsLost) {
  TriangleMesh flat;
  flat.vertices = {{0, 0, 3}, {1, 0, 3}, {2, 0, 3}};
  EXPECT_EQ(coverage(flat, test::sphere(500)).lost.share, 1);
  EXPECT_EQ(coverage(flat, test::sphere(500)).invented.tested, 0u);
}

TEST(MeshCoverage, LargeCloudsAreAskedInParts) {
  const PointSet cloud = sheet_samples(100, 2);
  const FarPoints all = find_lost(rectangle(1), cloud, 0.01, 0), some = find_lost(rectangle(1), cloud, 0.01, 0, 1000);
  EXPECT_LE(some.tested, 1000u);
  EXPECT_GT(some.tested, 900u);
  EXPECT_NEAR(all.share, some.share, 0.05);
}

TEST(MeshCoverage, DoesNotDependOnTheNumberOfThreads) {
  const PointSet cloud = sheet_samples(80, 2);
  TriangleMesh mesh = rectangle(3);
  for (Vec3f& v : mesh.vertices) v = v + Vec3f{1, 0, 0};
  test::compare_threads([&] { return coverage(mesh, cloud); },
                        [](const MeshCoverage& one, const MeshCoverage& many) {
                          EXPECT_EQ(one.spacing, many.spacing);
                          EXPECT_EQ(one.lost.share, many.lost.share);
                          EXPECT_EQ(one.invented.share, many.invented.share);
                          EXPECT_EQ(one.invented.densest->x, many.invented.densest->x);
                          EXPECT_EQ(one.lost.densest->y, many.lost.densest->y);
                        });
}

TEST(MeshCoverage, BadInput) {
  EXPECT_THROW(coverage(rectangle(1), {}), DataError);
  EXPECT_THROW(coverage(rectangle(1), sheet_samples(9), 0), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
