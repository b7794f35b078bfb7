#include "sansmesh/partition/far/openness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sansmesh/partition/fit/partition_fit.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
namespace {

using test::joined;
using test::sphere;

PartitionOfUnity with_openness(const PointSet& cloud, std::optional<bool> open = {}) {
  PartitionOptions options;
  options.open = open;
  Progress progress;
  return fit_partition_of_unity(cloud, options, progress);
}

/// A hilly sheet over [-1, 1]², normals up.
PointSet terrain(std::size_t n, float height = 0.15f) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(-1, 1);
  PointSet cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const float x = uniform(random), y = uniform(random);
    cloud.positions.push_back({x, y, height * std::sin(3 * x) * std::cos(4 * y)});
    cloud.normals.push_back(normalized(
        Vec3f{-3 * height * std::cos(3 * x) * std::cos(4 * y), 4 * height * std::sin(3 * x) * std::sin(4 * y), 1}));
  }
  return cloud;
}

/// The part of the unit sphere below z.
PointSet bowl(std::size_t n, float z) {
  const PointSet ball = sphere(n);
  PointSet cloud;
  for (std::size_t i = 0; i < n; ++i)
    if (ball.positions[i].z < z) {
      cloud.positions.push_back(ball.positions[i]);
      cloud.normals.push_back(ball.normals[i]);
    }
  return cloud;
}

double open_share(const PartitionOfUnity& f) { return f.report().open_area / f.report().area; }

TEST(Openness, ClosedShapesAreClosed) {
  for (const PointSet& cloud : {sphere(8000), test::cube(8000), test::torus(8000), sphere(8000, 0.01)}) {
    const PartitionOfUnity f = with_openness(cloud);
    EXPECT_EQ(f.report().open_area, 0);
    EXPECT_GT(f.report().mean_winding_number, 0.9);
  }
}

TEST(Openness, SheetsAreOpen) {
  for (const float height : {0.0f, 0.15f, 0.4f}) {
    const PartitionOfUnity f = with_openness(terrain(20000, height));
    EXPECT_FLOAT_EQ(open_share(f), 1) << height;
    EXPECT_LT(f.report().mean_winding_number, 0.65) << height;
  }
}

TEST(Openness, AHoleDoesNotOpenASolidButHalfASphereIsNone) {
  EXPECT_FLOAT_EQ(open_share(with_openness(bowl(20000, 0.85f))), 0);
  EXPECT_FLOAT_EQ(open_share(with_openness(bowl(20000, 0.0f))), 1);
}

TEST(Openness, AnObjectAboveAFloorIsClosedAndTheFloorOpen) {
  const PointSet scene = joined(terrain(20000, 0.0f), sphere(8000), 0.3f, {0.1f, 0.2f, 0.5f});
  const PartitionOfUnity f = with_openness(scene);
  for (std::size_t i = 0; i < f.data().supports.size(); ++i) {
    const Support& s = f.data().supports[i];
    EXPECT_EQ(s.open != 0, s.foot.z < 0.15f);
  }
}

TEST(Openness, FloorsOfABuildingDoNotCloseEachOther) {
  PointSet floors = terrain(15000, 0.02f);
  floors = joined(joined(floors, terrain(15000, 0.02f), 1, {0, 0, 0.3f}), terrain(15000, 0.02f), 1, {0, 0, 0.6f});
  EXPECT_FLOAT_EQ(open_share(with_openness(floors)), 1);
  // Two that face away from each other are a slab.
  PointSet below = terrain(15000, 0.02f);
  for (Vec3f& n : below.normals) n = -n;
  EXPECT_EQ(open_share(with_openness(joined(below, terrain(15000, 0.02f), 1, {0, 0, 0.08f}))), 0);
}

TEST(Openness, IsWhatIsAskedFor) {
  EXPECT_FLOAT_EQ(open_share(with_openness(sphere(4000), true)), 1);
  EXPECT_FLOAT_EQ(open_share(with_openness(terrain(4000), false)), 0);
}

TEST(Openness, TheSideOfASheetIsRightHoweverFarAway) {
  const PartitionOfUnity f = with_openness(terrain(20000));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-0.9, 0.9), far(0.3, 20);
  std::vector<Vec3> x;
  for (int i = 0; i < 2000; ++i) x.push_back({uniform(random), uniform(random), (i % 2 ? 1 : -1) * far(random)});
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  f.evaluate(x, values, gradients);
  for (std::size_t i = 0; i < x.size(); ++i) ASSERT_EQ(values[i] > 0, x[i].z > 0) << x[i].z;
  // Gradients equal differences of the values.
  const double h = 1e-3;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<Vec3> a = x, b = x;
    for (std::size_t i = 0; i < x.size(); ++i) a[i][k] += h, b[i][k] -= h;
    std::vector<double> fa(x.size()), fb(x.size());
    f.evaluate(a, fa), f.evaluate(b, fb);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (std::abs(x[i].z) < 2) ASSERT_NEAR((fa[i] - fb[i]) / (2 * h), gradients[i][k], 0.02);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
