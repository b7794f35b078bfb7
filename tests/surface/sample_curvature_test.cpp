#include "sansmesh/surface/sample_curvature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Samples of the unit sphere, or of the cylinder of radius 1 around z.
PointSet round_cloud(bool cylinder) {
  PointSet cloud;
  constexpr int kCount = 8000;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - 2 * (i + 0.5) / kCount, r = cylinder ? 1 : std::sqrt(1 - z * z), angle = 2.399963229728653 * i;
    cloud.positions.push_back(Vec3f(Vec3{r * std::cos(angle), r * std::sin(angle), z}));
    cloud.normals.push_back(Vec3f(normalized(Vec3{r * std::cos(angle), r * std::sin(angle), cylinder ? 0 : z})));
  }
  return cloud;
}

TEST(SampleCurvature, OfACylinderHasItsDirections) {
  Progress progress;
  // Ten times as large, at another position.
  const LocalFrame frame{{5, 6, 7}, 10};
  const SampleCurvature curvature(round_cloud(true), frame, {}, progress);
  for (const double angle : {0.1, 1.7, 4.0}) {
    const Vec3 normal{std::cos(angle), std::sin(angle), 0};
    for (const double side : {1.0, -1.0}) {
      const std::vector<Vec3> x{frame.to_input(normal + Vec3{0, 0, 0.2})};
      const std::vector<Vec3f> normals{Vec3f(normal * side)};
      std::vector<PrincipalCurvatures> found(1);
      curvature.evaluate(x, normals, found);
      ASSERT_TRUE(found[0].defined);
      EXPECT_NEAR(found[0].k1, side > 0 ? 0.1f : 0.0f, 2e-3f);
      EXPECT_NEAR(found[0].k2, side > 0 ? 0.0f : -0.1f, 2e-3f);
      const Vec3f& straight = side > 0 ? found[0].direction2 : found[0].direction1;
      EXPECT_NEAR(std::abs(straight.z), 1, 1e-3f);
    }
  }
}

TEST(SampleCurvature, IsSmoothBetweenSamples) {
  Progress progress;
  const SampleCurvature curvature(round_cloud(false), {}, {}, progress);
  std::vector<Vec3> x;
  std::vector<Vec3f> normals;
  for (int i = 0; i < 2000; ++i) {
    const double angle = 1e-3 * i;
    x.push_back({std::cos(angle), 0, std::sin(angle)});
    normals.push_back(Vec3f(x.back()));
  }
  std::vector<PrincipalCurvatures> found(x.size());
  curvature.evaluate(x, normals, found);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(mean_curvature(found[i]), 1, 5e-3f);
    if (i > 0) EXPECT_NEAR(mean_curvature(found[i]), mean_curvature(found[i - 1]), 5e-4f);
  }
}

TEST(SampleCurvature, WrongInputIsNamed) {
  Progress progress;
  PointSet cloud = round_cloud(false);
  cloud.normals.clear();
  EXPECT_THROW(SampleCurvature(cloud, {}, {}, progress), DataError);
}

}  // namespace
}  // namespace sansmesh::inline v1
