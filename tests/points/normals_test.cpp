#include "sansmesh/points/normals/normals.h"

#include <gtest/gtest.h>

#include "points/shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/points/shape/principal_axes.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using Method = NormalOptions::Method;

// Mean angle in degrees to the true normals, ignoring signs.
double angle_error(PointSet points, const NormalOptions& options) {
  const std::vector<Vec3f> truth = points.normals;
  Progress progress;
  estimate_normals(points, options, progress);
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(norm(points.normals[i]), 1, 1e-5);
    const double sine = norm(cross(Vec3(truth[i]), Vec3(points.normals[i])));
    sum += std::asin(std::min(1.0, sine)) * 57.29578;
  }
  return sum / static_cast<double>(truth.size());
}

TEST(LocalFrame, AxesDiagonaliseTheMatrix) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int trial = 0; trial < 2000; ++trial) {
    // From full volumes to needles and planes.
    const double thin = std::pow(10.0, -4.0 * (trial % 3)), flat = std::pow(10.0, -3.0 * (trial % 4));
    Symmetric3 m;
    for (int i = 0; i < 6; ++i) {
      const Vec3 a{u(random), u(random) * thin, u(random) * flat};
      m.add({(a.x + 2 * a.y - a.z) / 3, (2 * a.x - a.y + a.z) / 2, a.x + a.y + a.z});
    }
    const auto apply = [&](const Vec3& v) {
      return Vec3{m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
                  m.xz * v.x + m.yz * v.y + m.zz * v.z};
    };
    const PrincipalAxes axes = principal_axes(m);
    const double scale = axes.values.z;
    ASSERT_LE(axes.values.x, axes.values.y);
    ASSERT_LE(axes.values.y, axes.values.z);
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NEAR(norm(axes.axes[k]), 1, 1e-12);
      ASSERT_LT(norm(apply(axes.axes[k]) - axes.axes[k] * axes.values[k]), 1e-12 * scale);
    }
    const Vec3 n = smallest_axis(m);
    ASSERT_NEAR(norm(n), 1, 1e-9);
    ASSERT_NEAR(dot(n, apply(n)), axes.values.x, 1e-9 * scale);
  }
  EXPECT_EQ(smallest_axis({}), Vec3{});
  EXPECT_NEAR(norm(smallest_axis({2, 0, 0, 2, 0, 2})), 1, 1e-12);
  EXPECT_NEAR(std::abs(smallest_axis({2, 0, 0, 2, 0, 1}).z), 1, 1e-9);
}

TEST(Normals, OfAPlaneAreExact) {
  PointSet points = sample_box(2000, {1, 1, 0}, 2);
  const Vec3 normal = normalized(Vec3{1, 2, 3});
  Vec3 t, b;
  tangent_frame(normal, t, b);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points.positions[i] =
        Vec3f(t * static_cast<double>(points.positions[i].x) + b * static_cast<double>(points.positions[i].y));
    points.normals[i] = Vec3f(normal);
  }
  for (Method method : {Method::covariance, Method::jet})
    for (int rounds : {0, 2}) EXPECT_LT(angle_error(points, {.method = method, .reweightings = rounds}), 0.05);
}

TEST(Normals, ConvergeOnASphere) {
  for (Method method : {Method::covariance, Method::jet}) {
    const double coarse = angle_error(sample_sphere(2000, 1, 0, 3), {.method = method});
    const double fine = angle_error(sample_sphere(32000, 1, 0, 3), {.method = method});
    EXPECT_LT(coarse, 3);
    EXPECT_LT(fine, 0.4 * coarse);
  }
}

TEST(Normals, JetsBeatPlanesOnCurvedShapes) {
  const PointSet points = sample_torus(4000, 1, 0.3f, 4);
  EXPECT_LT(angle_error(points, {.method = Method::jet, .neighbours = 16}),
            0.7 * angle_error(points, {.method = Method::covariance, .neighbours = 16}));
}

TEST(Normals, ReweightingKeepsCreasesSharp) {
  const PointSet points = sample_box(20000, {1, 0.8f, 0.6f}, 5);
  EXPECT_LT(angle_error(points, {.method = Method::covariance, .neighbours = 14, .reweightings = 3}),
            0.9 * angle_error(points, {.method = Method::covariance, .neighbours = 14}));
}

TEST(Normals, WithstandNoise) {
  // Noise as large as the spacing. The tilt of a plane through k samples is proportional to 1/k, so the 110 neighbours
  // chosen for this noise are much better than a dozen.
  const PointSet points = sample_sphere(20000, 1, 0.025f, 6);
  EXPECT_LT(angle_error(points, {}), angle_error(points, {.neighbours = 14}) / 3);
}

TEST(Normals, DoNotDependOnScaleOrThreads) {
  const PointSet points = sample_torus(5000, 1, 0.3f, 7);
  PointSet scaled = points;
  for (Vec3f& p : scaled.positions) p *= std::ldexp(1.0f, -40);
  const auto normals_of = [](PointSet cloud) {
    Progress progress;
    estimate_normals(cloud, {}, progress);
    return cloud.normals;
  };
  EXPECT_EQ(normals_of(points), normals_of(scaled));
  test::expect_equal_for_any_threads([&] { return normals_of(points); });
}

TEST(Normals, OfDegenerateNeighbourhoodsAreZeroOrUnit) {
  Progress progress;
  PointSet points;
  estimate_normals(points, {}, progress);
  EXPECT_TRUE(points.normals.empty());
  points.positions.assign(30, {1, 2, 3});
  points.positions.push_back({std::nanf(""), 0, 0});
  estimate_normals(points, {}, progress);
  for (const Vec3f& n : points.normals) EXPECT_EQ(n, Vec3f{});
  points.positions.clear();
  for (int i = 0; i < 30; ++i) points.positions.push_back({static_cast<float>(i), 0, 0});
  for (Method method : {Method::covariance, Method::jet}) {
    estimate_normals(points, {.method = method, .reweightings = 2}, progress);
    for (const Vec3f& n : points.normals) EXPECT_NEAR(norm(n), 1, 1e-5);
  }
}

TEST(Normals, RefuseBadOptions) {
  PointSet points = sample_sphere(100, 1, 0, 8);
  Progress progress;
  EXPECT_THROW(estimate_normals(points, {.neighbours = 3}, progress), ArgumentError);
  EXPECT_THROW(estimate_normals(points, {.reweightings = -1}, progress), ArgumentError);
  EXPECT_THROW(estimate_normals(points, {.noise = -1.0}, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
