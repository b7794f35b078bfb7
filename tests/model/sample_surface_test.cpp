#include "sansmesh/model/sample_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/search/kd_tree.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/surface_names.h"

namespace sansmesh::inline v1 {
namespace {

SurfaceModel model_of(const PointSet& cloud, const std::string& method = "apss") {
  SurfaceOptions options;
  options.method = method;
  if (method == "amls") options.order = 4, options.iterations = 3;
  Progress progress;
  return make_surface_model(cloud, options, progress);
}

PointSet project(const PointSet& cloud, const SurfaceModel& model, SurfaceProjection* report = nullptr,
                 const ProjectToSurface& options = {}) {
  Progress progress;
  return project_points(cloud, model, options, progress, report);
}

PointSet resample(const SurfaceModel& model, std::size_t count, SurfaceProjection* report = nullptr) {
  Progress progress;
  return resample_surface(model, count, {}, progress, report);
}

double off_sphere(const PointSet& cloud, const Vec3& center = {}, double radius = 1) {
  double sum = 0;
  for (const Vec3f& p : cloud.positions) sum += std::abs(norm(cloud.origin + Vec3(p) - center) - radius);
  return sum / static_cast<double>(cloud.size());
}

/// Variation of the distance to the nearest neighbour: √(4/π − 1) = 0.52 for independent points. Points count as even
/// if it is a third less.
const double kEven = 2.0 / 3 * std::sqrt(4 / std::numbers::pi - 1);

/// Standard deviation over mean of each point's distance to its nearest neighbour.
double variation(const PointSet& cloud) {
  const KdTree tree(cloud.positions);
  double sum = 0, sum2 = 0;
  for (const Vec3f& p : cloud.positions) {
    std::array<Neighbour, 2> found;
    tree.nearest(p, found);
    const double d = std::sqrt(static_cast<double>(found[1].squared_distance));
    sum += d, sum2 += d * d;
  }
  const double n = static_cast<double>(cloud.size()), mean = sum / n;
  return std::sqrt(std::max(0.0, sum2 / n - mean * mean)) / mean;
}

double spacing_of_sphere(std::size_t n) { return std::sqrt(4 * std::numbers::pi / static_cast<double>(n)); }

TEST(RecommendedSurface, LeavesTheLeastError) {
  const auto recommended = [](const PointSet& cloud) {
    Progress progress;
    return make_recommended_surface(prepare_cloud(cloud, {}, progress), progress);
  };
  EXPECT_EQ(recommended(test::sphere(6000, 0.03)).report().method, "partition");
  // Samples on a grid, too sparse for the waves: the detail that the partition smooths away is not noise.
  PointSet waves;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      const float x = 0.05f * static_cast<float>(i), y = 0.05f * static_cast<float>(j);
      waves.positions.push_back({x, y, 0.06f * std::sin(16 * x) * std::cos(13 * y)});
    }
  const auto moved = [&](const SurfaceModel& model) {
    SurfaceProjection report;
    project(waves, model, &report);
    return report.rms_move;
  };
  EXPECT_LE(moved(recommended(waves)),
            std::min(moved(model_of(waves, "partition")), moved(model_of(waves, "curvature"))));
}

TEST(ProjectPoints, LeavesOutWhatIsFarFromSamples) {
  PointSet cloud = test::sphere(4000);
  const double spacing = spacing_of_sphere(4000);
  for (const std::string method : {"partition", "apss", "curvature"}) {
    const SurfaceModel model = model_of(cloud, method);
    PointSet probes = test::sphere(300);
    for (std::size_t i = 0; i < 100; ++i) probes.positions[i] *= 1.5f;
    for (std::size_t i = 100; i < 200; ++i) probes.positions[i] *= static_cast<float>(1 + 0.7 * spacing);
    SurfaceProjection report;
    const PointSet feet = project(probes, model, &report);
    EXPECT_EQ(report.left_out, 100u) << method;
    EXPECT_LT(off_sphere(feet), 0.01 * spacing) << method;
    EXPECT_LT(report.largest_move, spacing) << method;
  }
}

class EverySurfaceProjects : public testing::TestWithParam<std::string> {};

TEST_P(EverySurfaceProjects, MovesPointsOntoIt) {
  const SurfaceModel model = model_of(test::sphere(4000), GetParam());
  const double spacing = spacing_of_sphere(4000);
  std::mt19937 random(5);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> away(-0.7, 0.7);
  PointSet probes;
  for (int i = 0; i < 1500; ++i) {
    const Vec3 d = normalized(Vec3{gauss(random), gauss(random), gauss(random)});
    probes.positions.push_back(Vec3f(d * (1 + spacing * away(random))));
  }
  SurfaceProjection report;
  const PointSet feet = project(probes, model, &report);
  EXPECT_EQ(report.projected, probes.size());
  EXPECT_EQ(report.left_out, 0u);
  ASSERT_EQ(feet.size(), probes.size());
  ASSERT_EQ(feet.normals.size(), probes.size());
  // Means of planes deviate by the curvature of the surface within their width.
  const std::string method = GetParam();
  const bool planes = method == "adamson" || method == "kolluri" || method == "extremal";
  EXPECT_LT(off_sphere(feet), (method == "dey" ? 0.12 : planes ? 0.03 : 0.015) * spacing);
  EXPECT_NEAR(report.mean_move, 0.35 * spacing, 0.05 * spacing);
  EXPECT_GT(report.rms_move, report.mean_move);
  EXPECT_LT(report.largest_move, spacing);
  for (std::size_t i = 0; i < feet.size(); ++i) {
    ASSERT_GT(dot(feet.normals[i], normalized(feet.positions[i])), 0.98f);
    ASSERT_NEAR(norm(feet.normals[i]), 1, 1e-5);
    ASSERT_LT(norm(feet.positions[i] - normalized(probes.positions[i])), 0.35 * spacing) << "straight down";
  }
}

INSTANTIATE_TEST_SUITE_P(Names, EverySurfaceProjects, testing::ValuesIn(test::surface_names()),
                         [](const auto& tested) { return tested.param; });

TEST(ProjectPoints, TakesNoiseAway) {
  const std::size_t n = 5000;
  const PointSet noisy = test::sphere(n, 0.4 * spacing_of_sphere(n));
  for (const char* method : {"curvature", "alexa", "levin", "apss", "kolluri", "adamson"}) {
    const PointSet smooth = project(noisy, model_of(noisy, method));
    EXPECT_GT(smooth.size(), 0.99 * n) << method;
    EXPECT_LT(off_sphere(smooth), 0.4 * off_sphere(noisy)) << method;
  }
}

TEST(ProjectPoints, CarriesEverythingAlongAndLeavesOutWhatIsFar) {
  const SurfaceModel model = model_of(test::sphere(4000), "curvature");
  PointSet probes = test::sphere(600, 0.01);
  probes.normals.clear();
  std::vector<std::int32_t> number;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    probes.colors.push_back({static_cast<std::uint8_t>(i % 256), static_cast<std::uint8_t>(i / 256), 7});
    number.push_back(static_cast<std::int32_t>(i));
    probes.scan_of_point.push_back(static_cast<std::uint16_t>(i));
  }
  probes.attributes.set("number", number);
  probes.triangles.push_back({0, 1, 2});
  std::size_t far = 0;
  for (std::size_t i = 0; i < probes.size(); i += 7, ++far) probes.positions[i] *= i % 2 == 0 ? 3.0f : 0.2f;
  probes.positions[14] = {1e30f, 0, 0};
  probes.positions[21] = {std::numeric_limits<float>::quiet_NaN(), 0, 0};
  SurfaceProjection report;
  const PointSet feet = project(probes, model, &report);
  EXPECT_EQ(report.left_out, far);
  EXPECT_EQ(report.projected, probes.size() - far);
  ASSERT_EQ(feet.size(), probes.size() - far);
  ASSERT_EQ(feet.colors.size(), feet.size());
  ASSERT_EQ(feet.scan_of_point.size(), feet.size());
  const auto& kept = *feet.attributes.find<std::int32_t>("number");
  ASSERT_EQ(kept.size(), feet.size());
  EXPECT_TRUE(feet.triangles.empty());
  for (std::size_t k = 0; k < feet.size(); ++k) {
    const auto i = static_cast<std::size_t>(kept[k]);
    ASSERT_NE(i % 7, 0u);
    ASSERT_EQ(feet.scan_of_point[k], i);
    ASSERT_EQ(feet.colors[k][0], i % 256);
    ASSERT_LT(norm(feet.positions[k] - probes.positions[i]), 0.06f) << "its own foot";
  }
  PointSet nothing;
  EXPECT_EQ(project(nothing, model, &report).size(), 0u);
  EXPECT_EQ(report.projected + report.left_out, 0u);
}

TEST(ProjectPoints, KnowsWhereInTheWorldPointsAre) {
  const Vec3 center{635000.25, -849000.5, 420.125};
  PointSet samples = test::sphere(4000), probes = test::sphere(500, 0.02, 9);
  for (Vec3f& p : samples.positions) p *= 30.0f;
  for (Vec3f& p : probes.positions) p *= 30.0f;
  samples.origin = center;
  for (Vec3f& p : probes.positions) p += Vec3f{100, -200, 50};
  probes.origin = center - Vec3{100, -200, 50};
  for (const char* method : {"curvature", "apss", "partition"}) {
    const PointSet feet = project(probes, model_of(samples, method));
    ASSERT_EQ(feet.size(), probes.size()) << method;
    EXPECT_EQ(feet.origin, probes.origin);
    EXPECT_LT(off_sphere(feet, center, 30), 0.02 * 30 * spacing_of_sphere(4000)) << method;
    const PointSet even = resample(model_of(samples, method), 1000);
    EXPECT_LT(off_sphere(even, center, 30), 0.05 * 30 * spacing_of_sphere(4000)) << method;
  }
}

class Resample : public testing::TestWithParam<std::string> {};

TEST_P(Resample, SpreadsAsManyAsAskedForEvenly) {
  const SurfaceModel ball = model_of(test::sphere(4000), GetParam()), ring = model_of(test::torus(6000), GetParam());
  const double of_ball = spacing_of_sphere(4000), of_ring = 2 * std::numbers::pi * std::sqrt(0.35 / 6000);
  for (const std::size_t count : {500u, 4000u, 16000u}) {
    SurfaceProjection report;
    const PointSet points = resample(ball, count, &report);
    EXPECT_NEAR(static_cast<double>(points.size()), static_cast<double>(count), 0.1 * static_cast<double>(count));
    EXPECT_EQ(report.projected, points.size());
    EXPECT_LT(variation(points), kEven) << count;
    EXPECT_LT(off_sphere(points), 0.05 * of_ball);
    ASSERT_EQ(points.normals.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_GT(dot(points.normals[i], normalized(points.positions[i])), 0.98f);
    // No hole: every point of the sphere has a point nearby.
    const KdTree tree(points.positions);
    for (const Vec3f& p : test::sphere(2000).positions)
      ASSERT_LT(std::sqrt(tree.nearest(p)->squared_distance), 1.5 * spacing_of_sphere(count)) << count;
    EXPECT_EQ(resample(ball, count).positions, points.positions) << "every time";
  }
  const PointSet points = resample(ring, 3000);
  EXPECT_NEAR(static_cast<double>(points.size()), 3000, 300);
  EXPECT_LT(variation(points), kEven);
  double off = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points.origin + Vec3(points.positions[i]);
    const double r = std::hypot(p.x, p.y);
    off += std::abs(std::hypot(r - 1, p.z) - 0.35);
    const Vec3 normal = normalized(p - Vec3{p.x / r, p.y / r, 0});
    ASSERT_GT(dot(Vec3(points.normals[i]), normal), 0.9);
  }
  EXPECT_LT(off / static_cast<double>(points.size()), 0.05 * of_ring);
}

INSTANTIATE_TEST_SUITE_P(Some, Resample, testing::Values("partition", "apss", "curvature"),
                         [](const auto& tested) { return tested.param; });

TEST(ResampleSurface, EvensOutDensity) {
  PointSet uneven;
  const PointSet ball = test::sphere(12000);
  std::mt19937 random(3);
  for (std::size_t i = 0; i < ball.size(); ++i) {
    if (random() % 5 != 0 && ball.positions[i].x < 0) continue;
    uneven.positions.push_back(ball.positions[i]);
    uneven.normals.push_back(ball.normals[i]);
  }
  const PointSet even = resample(model_of(uneven), 3000);
  EXPECT_NEAR(static_cast<double>(even.size()), 3000, 300);
  EXPECT_LT(variation(even), kEven);
  const auto sparse =
      std::count_if(even.positions.begin(), even.positions.end(), [](const Vec3f& p) { return p.x < 0; });
  EXPECT_NEAR(static_cast<double>(sparse) / static_cast<double>(even.size()), 0.5, 0.05);
  const KdTree tree(even.positions);
  for (const Vec3f& p : test::sphere(2000).positions)
    ASSERT_LT(std::sqrt(tree.nearest(p)->squared_distance), 1.5 * spacing_of_sphere(3000)) << "no holes";
}

TEST(ResampleSurface, HasTheColoursOfTheSamples) {
  PointSet cloud = test::sphere(3000);
  for (const Vec3f& p : cloud.positions)
    cloud.colors.push_back({static_cast<std::uint8_t>(p.z > 0 ? 200 : 20), 99, 255});
  const PointSet points = resample(model_of(cloud), 5000);
  ASSERT_GT(points.size(), 4000u);
  ASSERT_EQ(points.colors.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(points.positions[i].z) < 0.2f) continue;
    ASSERT_NEAR(points.colors[i][0], points.positions[i].z > 0 ? 200 : 20, 1);
    ASSERT_NEAR(points.colors[i][1], 99, 1);
    ASSERT_NEAR(points.colors[i][2], 255, 1);
  }
}

TEST(SampleSurface, IsTheSameForAnyNumberOfThreads) {
  const PointSet cloud = test::torus(4000);
  const SurfaceModel model = model_of(cloud, "curvature");
  test::compare_threads([&] { return project(cloud, model); },
                        [](const PointSet& one, const PointSet& many) {
                          EXPECT_EQ(one.positions, many.positions);
                          EXPECT_EQ(one.normals, many.normals);
                        });
  test::expect_equal_for_any_threads([&] { return resample(model, 2000).positions; });
}

TEST(SampleSurface, RefusesBadOptions) {
  const PointSet cloud = test::sphere(500);
  const SurfaceModel model = model_of(cloud);
  for (const ProjectToSurface& bad :
       {ProjectToSurface{0, 1e-3}, ProjectToSurface{1001, 1e-3}, ProjectToSurface{-1, 1e-3}, ProjectToSurface{10, 0},
        ProjectToSurface{10, 2}, ProjectToSurface{10, -1}, ProjectToSurface{10, std::nan("")}}) {
    Progress progress;
    EXPECT_THROW(project(cloud, model, nullptr, bad), ArgumentError);
    EXPECT_THROW(resample_surface(model, 100, bad, progress), ArgumentError);
  }
  EXPECT_THROW(resample(model, 0), ArgumentError);
  EXPECT_GE(resample(model, 1).size(), 1u);
}

}  // namespace
}  // namespace sansmesh::inline v1
