#include "sansmesh/surface/projection_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sansmesh/error.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

ProjectionSurface make(const PointSet& cloud, const ProjectionOptions& options) {
  Progress progress;
  return make_projection_surface(prepare_samples(cloud, progress), options, progress);
}

std::vector<Vec3> near_samples(const PointSet& cloud, double spread, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-spread, spread);
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < cloud.size(); i += 5)
    x.push_back(Vec3(cloud.positions[i]) + Vec3{u(random), u(random), u(random)});
  return x;
}

class EveryProjection : public testing::TestWithParam<std::string> {
 protected:
  ProjectionOptions options() const { return {.method = projection_method(GetParam())}; }
};

TEST_P(EveryProjection, LandsOnASphereOfTheRightCurvature) {
  const PointSet cloud = test::sphere(8000);
  const ProjectionSurface p = make(cloud, options());
  const std::vector<Vec3> x = near_samples(cloud, 0.015, 2);
  std::vector<FootPoint> feet(x.size());
  project_to_fixed_point(p, x, 1e-5, 20, feet);
  for (const FootPoint& f : feet) {
    ASSERT_TRUE(f.defined);
    EXPECT_NEAR(norm(f.position), 1, 4e-5);
    EXPECT_GT(dot(f.normal, normalized(f.position)), 0.9999);
    EXPECT_NEAR(f.xx, -1, 0.12);  // outward normal, the surface bends away from it
    EXPECT_NEAR(f.yy, -1, 0.12);
    EXPECT_NEAR(f.xy, 0, 0.1);
  }
}

TEST_P(EveryProjection, LeavesPointsOfThePlaneInPlace) {
  PointSet plane;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(-1, 1);
  for (int i = 0; i < 4000; ++i) {
    plane.positions.push_back({u(random), u(random), 0});
    plane.normals.push_back({0, 0, 1});
  }
  const ProjectionSurface p = make(plane, options());
  std::vector<Vec3> x;
  for (int i = 0; i < 300; ++i) x.push_back({0.7 * u(random), 0.7 * u(random), 0.02 * u(random)});
  std::vector<FootPoint> feet(x.size());
  p.project(x, feet);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_TRUE(feet[i].defined);
    EXPECT_NEAR(feet[i].position.z, 0, 1e-6);
    EXPECT_NEAR(feet[i].position.x, x[i].x, 1e-5);
    EXPECT_GT(feet[i].normal.z, 0.99999);
  }
}

TEST_P(EveryProjection, TakesNoiseAway) {
  SANSMESH_RUNS_ONCE("judges accuracy; others project, too");
  const PointSet cloud = test::sphere(20000, 0.01, 5);
  const ProjectionSurface p = make(cloud, options());
  const std::vector<Vec3> x(cloud.positions.begin(), cloud.positions.end());
  std::vector<FootPoint> feet(x.size());
  project_to_fixed_point(p, x, 1e-4, 10, feet);
  double before = 0, after = 0;
  std::size_t defined = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!feet[i].defined) continue;
    ++defined;
    before += std::pow(norm(x[i]) - 1, 2);
    after += std::pow(norm(feet[i].position) - 1, 2);
  }
  EXPECT_EQ(defined, x.size());
  EXPECT_LT(std::sqrt(after / before), 0.4);
}

TEST_P(EveryProjection, IsUndefinedFarFromTheSamples) {
  const ProjectionSurface p = make(test::sphere(2000), options());
  const std::vector<Vec3> x{{0, 0, 0}, {3, 0, 0}, {1, 0, 0}, {NAN, 0, 0}};
  std::vector<FootPoint> feet(x.size());
  p.project(x, feet);
  EXPECT_FALSE(feet[0].defined);
  EXPECT_FALSE(feet[1].defined);
  EXPECT_TRUE(feet[2].defined);
  EXPECT_FALSE(feet[3].defined);
}

TEST_P(EveryProjection, ActsAsAFieldWithItsNormalAsGradient) {
  const PointSet cloud = test::torus(8000);
  const ProjectionSurface p = make(cloud, options());
  const ProjectionField field(p);
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < cloud.size(); i += 20)
    x.push_back(Vec3(cloud.positions[i]) + Vec3(cloud.normals[i]) * 0.01);
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  std::vector<std::uint8_t> inside(x.size());
  field.evaluate_in_domain(x, values, gradients, inside);
  double mean = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_TRUE(inside[i]);
    mean += values[i] / static_cast<double>(x.size());
    EXPECT_NEAR(norm(gradients[i]), 1, 1e-5);
  }
  EXPECT_NEAR(mean, 0.01, 3e-4);
}

INSTANTIATE_TEST_SUITE_P(Projection, EveryProjection,
                         testing::ValuesIn(std::vector<std::string>(std::begin(kProjectionMethods),
                                                                    std::end(kProjectionMethods))),
                         [](const auto& test) { return test.param; });

TEST(Projection, LevinAgreesWithAlexaOnceItStandsStill) {
  SANSMESH_RUNS_ONCE("judges accuracy; others project, too");
  const PointSet cloud = test::torus(8000);
  const ProjectionSurface levin = make(cloud, {.method = ProjectionMethod::levin, .smoothing = 1.5});
  const ProjectionSurface alexa = make(cloud, {.method = ProjectionMethod::alexa, .smoothing = 1.5});
  const std::vector<Vec3> x = near_samples(cloud, 0.02, 8);
  std::vector<FootPoint> a(x.size()), b(x.size());
  // One step of Levin's operator ends close to Alexa's fixed point: its plane does not depend on the offset of the
  // point.
  levin.project(x, a);
  project_to_fixed_point(alexa, x, 1e-5, 20, b);
  double difference = 0, distance = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    difference += std::abs(dot(a[i].position - b[i].position, b[i].normal));
    distance += std::abs(dot(x[i] - b[i].position, b[i].normal));
  }
  EXPECT_LT(difference, 0.1 * distance);
}

TEST(CurvatureProjection, DiffusionIgnoresOutliers) {
  PointSet cloud = test::sphere(8000);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> off(0.03f, 0.06f);
  for (std::size_t i = 0; i < cloud.size(); i += 25) cloud.positions[i] *= 1 + off(random);
  const auto error = [&](SurfaceDiffusion diffusion) {
    const ProjectionSurface p = make(cloud, {.smoothing = 1.8, .diffusion = diffusion});
    const PointSet clean = test::sphere(3000);
    const std::vector<Vec3> x(clean.positions.begin(), clean.positions.end());
    std::vector<FootPoint> feet(x.size());
    project_to_fixed_point(p, x, 1e-4, 10, feet);
    double sum = 0;
    for (const FootPoint& f : feet) sum += std::abs(norm(f.position) - 1);
    return sum / static_cast<double>(feet.size());
  };
  const double none = error(SurfaceDiffusion::none);
  EXPECT_LT(error(SurfaceDiffusion::soft), 0.75 * none);
  EXPECT_LT(error(SurfaceDiffusion::hard), 0.75 * none);
}

TEST(CurvatureProjection, RefusesBadOptions) {
  EXPECT_THROW(ProjectionOptions{.threshold = 0}.validate(), ArgumentError);
  EXPECT_THROW(ProjectionOptions{.tau = 4}.validate(), ArgumentError);
  EXPECT_THROW(ProjectionOptions{.reach = 100}.validate(), ArgumentError);
  EXPECT_THROW(ProjectionOptions{.bandwidth = -1}.validate(), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
