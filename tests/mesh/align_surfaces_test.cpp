#include "sansmesh/mesh/align/align_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/mesh/edit/refine_edges.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/points/registration/point_features.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::test {
namespace {

/// Shape without symmetries, of size about 2.
TriangleMesh potato(int levels = 5) {
  TriangleMesh mesh = octasphere(levels);
  for (Vec3f& v : mesh.vertices) {
    const Vec3 p(v);
    const double r =
        1 + 0.12 * std::sin(3 * p.x + 1) + 0.1 * std::sin(4 * p.y + 2 * p.z) + 0.08 * std::cos(5 * p.z - 3 * p.x);
    v = Vec3f(Vec3{1.2 * p.x, p.y, 0.8 * p.z} * r);
  }
  return mesh;
}

/// Part on one side of a plane.
TriangleMesh side_of(TriangleMesh mesh, const Vec3f& n, float least) {
  std::vector<std::uint8_t> keep;
  for (const Triangle& t : mesh.triangles) keep.push_back(dot(n, mesh.vertices[t[0]]) > least);
  keep_triangles(mesh, keep);
  return mesh;
}

TriangleMesh noisy_points(const TriangleMesh& mesh, float noise) {
  std::mt19937 random(3);
  std::normal_distribution<float> error(0, noise);
  TriangleMesh points;
  for (const Vec3f& v : mesh.vertices)
    points.vertices.push_back(v + Vec3f{error(random), error(random), error(random)});
  return points;
}

AffineMap far_motion(double degrees) {
  return AffineMap::translation({40, -7, 12}).after(AffineMap::rotation({1, 2, -0.5}, degrees));
}

/// Largest distance of the aligned vertices of `placed` from their positions in `own`.
double largest_error(const SurfaceAlignment& found, const TriangleMesh& placed, const TriangleMesh& own) {
  double most = 0;
  for (std::size_t v = 0; v < own.vertices.size(); ++v)
    most = std::max(most,
                    norm(found.motion(placed.origin + Vec3(placed.vertices[v])) - own.origin - Vec3(own.vertices[v])));
  return most;
}

TEST(AlignSurfaces, NearStartToTheLastDigits) {
  const TriangleMesh fixed = potato();
  TriangleMesh moving = fixed;
  transform(moving, AffineMap::translation({0.05, -0.03, 0.08}).after(AffineMap::rotation({0, 1, 1}, 8)));
  SurfaceAlignmentOptions options;
  options.start = AlignStart::given_pose;
  options.samples = 3000;
  Progress progress;
  const SurfaceAlignment found = align_surfaces(moving, fixed, options, progress);
  EXPECT_LT(largest_error(found, moving, fixed), 1e-4);
  EXPECT_NEAR(found.motion.angle(), 8, 0.01);
  EXPECT_NEAR(std::abs(dot(found.motion.axis(), Vec3{0, std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2})), 1, 1e-4);
  EXPECT_EQ(found.motion.scale, 1);
  EXPECT_GT(found.overlap, 0.99);
  EXPECT_LT(found.rms, 1e-4);
  EXPECT_GT(found.median_before, 0.01);
  EXPECT_GT(found.moved, 0.05);
  EXPECT_EQ(found.free_motions, 0);
  EXPECT_EQ(found.start, AlignStart::given_pose);
}

TEST(AlignSurfaces, NoiseIsNoOtherShapeAndAMirrorImageIs) {
  const TriangleMesh fixed = potato();
  SurfaceAlignmentOptions options;
  options.samples = 6000;
  const auto aligned = [&](TriangleMesh moving) {
    transform(moving, far_motion(100));
    Progress progress;
    return align_surfaces(moving, fixed, options, progress);
  };
  for (const TriangleMesh& part : {potato(), side_of(potato(), {1, 0.3f, 0}, -0.2f)}) {
    const SurfaceAlignment noisy = aligned(noisy_points(part, 0.01f));
    EXPECT_TRUE(noisy.found);
    EXPECT_LT(noisy.differing, kOtherShape / 2);
    EXPECT_FALSE(noisy.mirror_image_fits);
  }
  TriangleMesh mirrored = noisy_points(fixed, 0.005f);
  for (Vec3f& v : mirrored.vertices) v.x = -v.x;
  const SurfaceAlignment other = aligned(mirrored);
  EXPECT_GT(other.differing, 2 * kOtherShape);
  EXPECT_TRUE(other.mirror_image_fits);
}

TEST(AlignSurfaces, NoisyPointsFromAnywhereOnAnyThreads) {
  const TriangleMesh fixed = potato(4), own = noisy_points(potato(5), 0.01f);
  TriangleMesh moving = own;
  transform(moving, far_motion(140));
  expect_equal_for_any_threads([&] {
    Progress progress;
    const SurfaceAlignment found = align_surfaces(moving, fixed, {}, progress);
    EXPECT_LT(largest_error(found, moving, own), 0.01);
    EXPECT_EQ(found.start, AlignStart::anywhere);
    EXPECT_EQ(found.alternatives, 0u);
    EXPECT_NEAR(found.rms, 0.01, 0.005);
    const SimilarityMotion& m = found.motion;
    return std::tuple(m.x.x, m.x.y, m.y.z, m.to.x, m.to.y, found.overlap);
  });
}

/// More points than the alignment uses, on both sides.
TEST(AlignSurfaces, ManyPointsWithoutNormals) {
  const TriangleMesh own = noisy_points(potato(8), 0.005f);
  ASSERT_GT(own.vertices.size(), 200000u);
  TriangleMesh fixed = own, moving;
  fixed.vertices.clear();
  for (std::size_t v = 0; v < own.vertices.size(); ++v)
    (v % 4 == 1 ? moving : fixed).vertices.push_back(own.vertices[v]);  // the sides have no point in common
  const TriangleMesh there = moving;
  transform(moving, AffineMap::translation({0.05, -0.03, 0.08}).after(AffineMap::rotation({0, 1, 1}, 8)));
  Progress progress;
  const SurfaceAlignment found = align_surfaces(moving, fixed, {}, progress);
  EXPECT_LT(largest_error(found, moving, there), 0.001);
  EXPECT_EQ(found.start, AlignStart::given_pose);
  EXPECT_EQ(found.samples, 20000u);
}

TEST(AlignSurfaces, PartsThatOverlapByHalf) {
  const TriangleMesh whole = potato();
  const TriangleMesh fixed = side_of(whole, {1, 0.2f, 0}, -0.25f), own = side_of(whole, {-1, -0.2f, 0}, -0.25f);
  TriangleMesh moving = own;
  transform(moving, far_motion(-100));
  Progress progress;
  const SurfaceAlignment found = align_surfaces(moving, fixed, {}, progress);
  EXPECT_LT(largest_error(found, moving, own), 0.01);
  EXPECT_GT(found.overlap, 0.25);
  EXPECT_LT(found.overlap, 0.75);
}

TEST(AlignSurfaces, OfAnotherUnit) {
  const TriangleMesh fixed = potato(4);
  TriangleMesh moving = fixed;
  transform(moving, far_motion(75).after(AffineMap::scaling({25.4, 25.4, 25.4})));
  SurfaceAlignmentOptions options;
  options.find_scale = true;
  Progress progress;
  const SurfaceAlignment found = align_surfaces(moving, fixed, options, progress);
  EXPECT_NEAR(found.motion.scale * 25.4, 1, 1e-3);
  EXPECT_LT(largest_error(found, moving, fixed), 0.01);
}

TEST(AlignSurfaces, WhatTheShapeDoesNotTell) {
  SurfaceAlignmentOptions options;
  options.start = AlignStart::given_pose;
  options.samples = 3000;
  Progress progress;
  TriangleMesh ball = octasphere(5);
  EXPECT_EQ(align_surfaces(ball, octasphere(4), options, progress).free_motions, 3);

  // Another ball can slide without end; the fit stops when distances no longer decrease.
  TriangleMesh other = octasphere(4);
  transform(other, AffineMap::rotation({1, 2, 3}, 50));
  EXPECT_LT(align_surfaces(ball, other, options, progress).iterations, 60);

  // Every face twice, back to back: sides are undefined, and the surface fits itself.
  TriangleMesh both = potato(3);
  for (const Triangle& t : potato(3).triangles) both.triangles.push_back({t[0], t[2], t[1]});
  const SurfaceAlignment itself = align_surfaces(both, both, options, progress);
  EXPECT_GT(itself.overlap, 0.99);
  EXPECT_FALSE(itself.searched);

  // A brick: half turns about its axes.
  TriangleMesh brick;
  for (int i = 0; i < 8; ++i)
    brick.vertices.push_back({i & 1 ? 2.f : -2.f, i & 2 ? 1.2f : -1.2f, i & 4 ? 0.7f : -0.7f});
  brick.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  options.start = AlignStart::anywhere;
  const SurfaceAlignment turned = align_surfaces(brick, brick, options, progress);
  EXPECT_EQ(turned.alternatives, 3u);
  EXPECT_TRUE(turned.searched);
  ASSERT_FALSE(turned.alternative_angles.empty());
  EXPECT_NEAR(turned.alternative_angles[0], 180, 2);
  EXPECT_EQ(turned.free_motions, 0);
  EXPECT_LT(turned.rms, 1e-3);
}

TEST(AlignSurfaces, Complaints) {
  TriangleMesh few, line = octasphere(3);
  few.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  Progress progress;
  EXPECT_THROW(align_surfaces(few, octasphere(3), {}, progress), DataError);
  line.triangles.clear();
  for (Vec3f& v : line.vertices) v = {1, 2, 3};
  EXPECT_THROW(align_surfaces(octasphere(3), line, {}, progress), DataError);
  SurfaceAlignmentOptions bad;
  bad.samples = 5;
  EXPECT_THROW(bad.validate(), ArgumentError);
  bad = {};
  bad.iterations = 0;
  EXPECT_THROW(bad.validate(), ArgumentError);
}

TEST(PointFeatures, DoNotChangeWhenMoved) {
  const TriangleMesh mesh = potato(3);
  const AffineMap motion = far_motion(50);
  std::vector<Vec3> x, n, moved_x, moved_n;
  for (const Vec3f& v : mesh.vertices) {
    x.emplace_back(v), n.push_back(normalized(Vec3(v)));
    moved_x.push_back(motion(x.back())), moved_n.push_back(motion.linear(n.back()));
  }
  const auto here = point_features(x, n, 0.5), there = point_features(moved_x, moved_n, 0.5);
  double worst = 0, apart = 0;
  for (std::size_t i = 0; i < here.size(); ++i)
    for (std::size_t k = 0; k < 33; ++k) {
      worst += std::abs(here[i][k] - there[i][k]);
      apart += std::abs(here[i][k] - here[(i + 7) % here.size()][k]);
    }
  EXPECT_LT(worst, 0.05 * apart);  // pairs at bin limits excepted
  for (const PointFeature& f : here)
    for (std::size_t part = 0; part < 3; ++part) {
      float sum = 0;
      for (std::size_t k = 0; k < 11; ++k) sum += f[11 * part + k];
      EXPECT_NEAR(sum, 100, 0.01);
    }
}

}  // namespace
}  // namespace sansmesh::test
