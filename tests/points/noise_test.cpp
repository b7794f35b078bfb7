#include "sansmesh/points/statistics/noise.h"

#include <gtest/gtest.h>

#include "points/shapes.h"
#include "sansmesh/points/statistics/spacing.h"

namespace sansmesh::inline v1 {
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

TEST(Noise, IsKnownWhereSamplesTell) {
  const NoiseEstimate noisy = measure_noise(sample_sphere(20000, 1, 0.02f, 11));
  EXPECT_TRUE(noisy.known);
  EXPECT_EQ(noisy.deviation, estimate_noise(sample_sphere(20000, 1, 0.02f, 11)));
  EXPECT_GE(noisy.most, noisy.deviation);
  const PointSet clean = sample_torus(20000, 1, 0.3f, 12);
  EXPECT_TRUE(measure_noise(clean).known);
  EXPECT_EQ(noise_words(measure_noise(clean), estimate_spacing(clean)).rfind("less than ", 0), 0u);
}

TEST(Noise, OfCoarselySampledShapesCannotBeTold) {
  // The samples are as far apart as the branches are thick: shape and noise are indistinguishable.
  PointSet points;
  for (unsigned k = 0; k < 5; ++k) {
    PointSet ring = sample_torus(60, 1, 0.08f, 13 + k);
    for (Vec3f& p : ring.positions)
      append(points, cloud({Vec3f{p[k % 3], p[(k + 1) % 3], p[(k + 2) % 3]} * (1 + 0.3f * float(k))}));
  }
  const NoiseEstimate noise = measure_noise(points);
  EXPECT_FALSE(noise.known);
  EXPECT_GT(noise.most, 0.05 * estimate_spacing(points));
  EXPECT_EQ(noise_words(noise, estimate_spacing(points)).rfind("unknown", 0), 0u);
}

TEST(Noise, StepsOfDepthsAreSeen) {
  // A frame of a curved wall whose depths have few values.
  PointSet points;
  for (int j = 0; j < 200; ++j)
    for (int i = 0; i < 250; ++i) {
      const float x = 0.01f * static_cast<float>(i), y = 0.01f * static_cast<float>(j);
      points.positions.push_back({x, y, 0.02f * std::round((2 + 0.1f * x * x + 0.2f * y) / 0.02f)});
    }
  const NoiseEstimate noise = measure_noise(points);
  EXPECT_NEAR(noise.step, 0.02, 1e-3);
  EXPECT_FALSE(noise.known);
  EXPECT_NE(noise_words(noise, 0.01).find("steps of 0.02"), std::string::npos);
  EXPECT_EQ(noise_words({}, 0.01), "unknown: too few samples");
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
}  // namespace sansmesh::inline v1
