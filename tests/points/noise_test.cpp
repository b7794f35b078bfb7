#include "sansmesh/points/noise.h"

#include <gtest/gtest.h>

#include "points/shapes.h"
#include "sansmesh/points/spacing.h"

namespace sansmesh {
namespace {

TEST(Noise, IsFoundWithinAFifth) {
  for (double noise : {0.001, 0.005, 0.02, 0.04}) {
    const PointSet sphere = sample_sphere(20000, 1, static_cast<float>(noise), 1);
    EXPECT_NEAR(estimate_noise(sphere) / noise, 1, 0.2) << noise;
  }
  PointSet torus = sample_torus(60000, 1, 0.4f, 2);
  std::mt19937 random(3);
  std::normal_distribution<float> g;
  for (Vec3f& p : torus.positions) p += Vec3f{g(random), g(random), g(random)} * 0.006f;
  EXPECT_NEAR(estimate_noise(torus) / 0.006, 1, 0.2);
}

TEST(Noise, OfCleanShapesIsNegligible) {
  for (const PointSet& points : {sample_sphere(20000, 1, 0, 4), sample_torus(20000, 1, 0.3f, 5),
                                 sample_box(20000, {1, 0.7f, 0.4f}, 6), sample_torus(1500, 1, 0.2f, 7)})
    EXPECT_LT(estimate_noise(points), 0.01 * estimate_spacing(points));
}

TEST(Noise, IsNotFooledByOutliers) {
  PointSet points = sample_sphere(30000, 1, 0.01f, 8);
  std::mt19937 random(9);
  std::uniform_real_distribution<float> u(-1.5f, 1.5f);
  for (int i = 0; i < 1500; ++i) points.positions[static_cast<std::size_t>(20 * i)] = {u(random), u(random), u(random)};
  EXPECT_NEAR(estimate_noise(points) / 0.01, 1, 0.25);
}

TEST(Noise, OfTooFewSamplesIsZero) {
  PointSet points;
  EXPECT_EQ(estimate_noise(points), 0);
  points.positions.assign(100, {1, 1, 1});
  EXPECT_EQ(estimate_noise(points), 0);
  points = sample_sphere(15, 1, 0.1f, 10);
  EXPECT_EQ(estimate_noise(points), 0);
}

}  // namespace
}  // namespace sansmesh
