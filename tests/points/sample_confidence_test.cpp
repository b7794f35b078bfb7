#include "sansmesh/points/statistics/sample_confidence.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "sansmesh/error.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kEdge = 0.1f;

/// Square lattice in z = 0 with a square hole in the centre.
PointSet lattice(float hole) {
  PointSet cloud;
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j) {
      const Vec3f p{static_cast<float>(i) * kEdge, static_cast<float>(j) * kEdge, 0};
      if (std::abs(p.x) >= hole || std::abs(p.y) >= hole) cloud.positions.push_back(p);
    }
  return cloud;
}

struct Found {
  std::vector<float> distance, confidence;
};
Found at(const SampleConfidence& c, const std::vector<Vec3f>& x) {
  Found f{std::vector<float>(x.size()), std::vector<float>(x.size())};
  c.evaluate(x, f.distance, f.confidence);
  return f;
}

TEST(SampleConfidence, IsOneAmongSamplesAndZeroOutOfReach) {
  const SampleConfidence c(lattice(0), kEdge, 0);
  const Found f = at(c, {{0, 0, 0}, {0.05f, 0.05f, 0}, {1.05f, 0.5f, 0}, {0, 0, 0.25f}, {0, 0, 0.4f}, {5, 0, 0}});
  for (const std::size_t i : {0u, 1u, 2u}) EXPECT_EQ(f.confidence[i], 1) << i;
  EXPECT_GT(f.confidence[3], 0);
  EXPECT_LT(f.confidence[3], 1);
  for (const std::size_t i : {4u, 5u}) EXPECT_EQ(f.confidence[i], 0) << i;
  EXPECT_FLOAT_EQ(f.distance[1], std::sqrt(0.005f));
  EXPECT_FLOAT_EQ(f.distance[3], 0.25f);
  EXPECT_FLOAT_EQ(f.distance[5], 3);
}

TEST(SampleConfidence, FallsTowardsTheMiddleOfAHole) {
  const SampleConfidence c(lattice(0.75f), kEdge, 0);
  std::vector<Vec3f> x;
  for (int i = 0; i <= 75; ++i) x.push_back({0.8f - 0.01f * static_cast<float>(i), 0, 0});
  const Found f = at(c, x);
  for (std::size_t i = 1; i < x.size(); ++i) {
    EXPECT_LE(f.confidence[i], f.confidence[i - 1]);
    EXPECT_NEAR(f.distance[i], 0.01 * static_cast<double>(i), 1e-5);
  }
  EXPECT_EQ(f.confidence.front(), 1);
  EXPECT_EQ(f.confidence.back(), 0);
}

TEST(SampleConfidence, ScalesWithItsSamplesAndAllowsForNoise) {
  PointSet large = lattice(0.3f);
  for (Vec3f& p : large.positions) p *= 1024.0f;
  const std::vector<Vec3f> x{{0, 0, 0}, {0.1f, 0, 0.1f}, {0, 0.2f, 0.1f}, {2.1f, 0.3f, 0.1f}};
  std::vector<Vec3f> moved = x;
  for (Vec3f& p : moved) p *= 1024.0f;
  const Found a = at(SampleConfidence(lattice(0.3f), kEdge, 0), x),
              b = at(SampleConfidence(large, 1024 * kEdge, 0), moved);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_FLOAT_EQ(b.distance[i], 1024 * a.distance[i]);
    EXPECT_NEAR(b.confidence[i], a.confidence[i], 1e-5);
  }
  EXPECT_LT(a.confidence[0], 1);
  EXPECT_EQ(at(SampleConfidence(lattice(0.3f), kEdge, 0.2), x).confidence[0], 1) << "within three times the noise";
}

TEST(SampleConfidence, ColoursRunFromRedToWhite) {
  const PointSet cloud = lattice(0);
  const ConfidenceColors colors(cloud, kEdge, 0);
  std::array<Vec3f, 2> found;
  colors.evaluate(std::array<Vec3, 2>{Vec3{0, 0, 0}, Vec3{0, 0, 9}}, found);
  EXPECT_EQ(found[0], confidence_color(1));
  EXPECT_EQ(found[1], confidence_color(0));
  EXPECT_EQ(found[0].x, found[0].z) << "grey or white";
  EXPECT_GT(found[1].x, found[1].z + 0.3f) << "red";
}

TEST(SampleConfidence, NeedsSamples) { EXPECT_THROW(SampleConfidence(PointSet{}, 1, 0), DataError); }

TEST(SampleConfidence, IsTheSameForAnyNumberOfThreads) {
  const SampleConfidence c(lattice(0.4f), kEdge, 0);
  std::vector<Vec3f> x;
  for (int i = 0; i < 5000; ++i) x.push_back({0.001f * static_cast<float>(i) - 2, 0.1f, 0.05f});
  test::expect_equal_for_any_threads([&] { return at(c, x).confidence; });
}

}  // namespace
}  // namespace sansmesh::inline v1
