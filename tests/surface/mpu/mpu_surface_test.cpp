#include "sansmesh/surface/mpu/mpu_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "sansmesh/error.h"
#include "support/any_threads.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
namespace {

MpuSurface mpu_of(const PointSet& cloud, const MpuOptions& options = {}) {
  Progress progress;
  return make_mpu_surface(cloud, options, progress);
}

std::vector<double> values_at(const ScalarField& field, std::span<const Vec3> x) {
  std::vector<double> values(x.size());
  field.evaluate(x, values);
  return values;
}

std::vector<Vec3> somewhere(std::size_t n, double reach, unsigned seed = 3) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-reach, reach);
  std::vector<Vec3> x(n);
  for (Vec3& p : x) p = {uniform(generator), uniform(generator), uniform(generator)};
  return x;
}

std::vector<Vec3> on_sphere(std::size_t n, double radius) {
  std::vector<Vec3> x = somewhere(n, 1);
  for (Vec3& p : x) p = normalized(p) * radius;
  return x;
}

/// Rotation about an axis that is none of the cube's.
Vec3 turned(const Vec3& x) {
  const Vec3 a = normalized(Vec3{1, 2, -1});
  const double c = std::cos(0.7), s = std::sin(0.7);
  return x * c + cross(a, x) * s + a * (dot(a, x) * (1 - c));
}

/// The cube [-1, 1]³ without its octant of positive coordinates: edges and corners that are convex, concave and both.
double to_notched(const Vec3& x) {
  const double notch = std::min({x.x, x.y, x.z});
  return std::max({std::abs(x.x) - 1, std::abs(x.y) - 1, std::abs(x.z) - 1, notch});
}

PointSet notched_cube(std::size_t n) {
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PointSet cloud;
  while (cloud.size() < n) {
    const std::size_t axis = generator() % 3;
    const double side = static_cast<double>(generator() % 3) - 1;
    Vec3 p{uniform(generator), uniform(generator), uniform(generator)}, normal;
    p[axis] = side;
    normal[axis] = side < 0 ? -1 : 1;
    if (std::abs(to_notched(p)) > 1e-9 || (side == 0 && (p[(axis + 1) % 3] < 0 || p[(axis + 2) % 3] < 0))) continue;
    cloud.positions.emplace_back(p), cloud.normals.emplace_back(normal);
  }
  return cloud;
}

TEST(MpuSurface, IsThePlaneOfSamplesOfAPlane) {
  const Vec3 n = normalized(Vec3{1, 2, -2});
  Vec3 u, v;
  tangent_frame(n, u, v);
  PointSet cloud;
  for (const Vec3& p : somewhere(500, 1)) {
    cloud.positions.emplace_back(u * p.x + v * p.y + n * 0.1);
    cloud.normals.emplace_back(n);
  }
  const MpuSurface surface = mpu_of(cloud);
  const std::vector<Vec3> x = somewhere(200, 0.8);
  const std::vector<double> values = values_at(surface, x);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(values[i], dot(x[i], n) - 0.1, 1e-5);
}

double mean_of(const MpuSurface& surface, std::span<const Vec3> x) {
  double sum = 0;
  for (const double f : values_at(surface, x)) sum += std::abs(f);
  return sum / static_cast<double>(x.size());
}

TEST(MpuSurface, IsNearASphereOfFewSamples) {
  const MpuSurface surface = mpu_of(test::sphere(2000));
  EXPECT_LT(mean_of(surface, on_sphere(2000, 1)), 1e-4);
}

TEST(MpuSurface, ErrorOfATorusFallsWithTheCubeOfTheSpacing) {
  std::vector<Vec3> x;
  for (const Vec3f& p : test::torus(2000, 8).positions) x.emplace_back(p);
  const auto error = [&](std::size_t n) { return mean_of(mpu_of(test::torus(n), {.error = 1e-9, .sharp = false}), x); };
  const double coarse = error(3000), fine = error(48000);  // ratio of the spacings: 4
  EXPECT_LT(coarse, 2e-3);
  EXPECT_LT(fine, coarse / 40);
}

TEST(MpuSurface, ASphereIsNegativeInsideAndPositiveOutsideEverywhere) {
  const MpuSurface surface = mpu_of(test::sphere(3000));
  for (const double r : {0.0, 0.3, 0.8, 0.97})
    for (const double f : values_at(surface, on_sphere(300, r))) EXPECT_LT(f, 0) << r;
  for (const double r : {1.03, 1.1, 1.5, 3.0, 50.0})
    for (const double f : values_at(surface, on_sphere(300, r))) EXPECT_GT(f, 0) << r;
}

TEST(MpuSurface, HasTheEdgesAndCornersOfACube) {
  const PointSet cloud = test::cube(6000);
  const double spacing = std::sqrt(24.0 / 6000);
  std::vector<Vec3> edges, corners;
  for (const Vec3& p : somewhere(400, 1)) {
    const auto side = [](double t) { return t < 0 ? -1.0 : 1.0; };
    edges.push_back({side(p.x), side(p.y), 0.99 * p.z});
    corners.push_back({side(p.x), side(p.y), side(p.z)});
  }
  const auto worst = [&](const MpuSurface& surface, std::span<const Vec3> x) {
    double most = 0;
    for (const double f : values_at(surface, x)) most = std::max(most, std::abs(f));
    return most;
  };
  const MpuSurface sharp = mpu_of(cloud), smooth = mpu_of(cloud, {.sharp = false});
  EXPECT_GT(sharp.report().edges, 100u);
  EXPECT_GE(sharp.report().corners, 8u);
  EXPECT_EQ(smooth.report().edges + smooth.report().corners, 0u);
  EXPECT_LT(worst(sharp, edges), 0.02 * spacing);
  EXPECT_LT(worst(sharp, corners), 0.05 * spacing);
  EXPECT_GT(worst(smooth, edges), 0.2 * spacing);
  EXPECT_GT(worst(smooth, corners), 0.3 * spacing);
}

TEST(MpuSurface, HasConcaveAndMixedEdgesAndCorners) {
  const PointSet cloud = notched_cube(12000);
  const double spacing = std::sqrt(24.0 / 12000);
  const MpuSurface sharp = mpu_of(cloud);
  std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {-1, -1, -1}};
  for (double t = 0.02; t < 1; t += 0.02)
    for (const Vec3& p : {Vec3{t, 0, 0}, Vec3{0, t, 0}, Vec3{1, t, 0}, Vec3{0, t, 1}, Vec3{-1, t, 1}}) x.push_back(p);
  const std::vector<double> values = values_at(sharp, x);
  double sum = 0;
  for (const double f : values) {
    EXPECT_LT(std::abs(f), 0.3 * spacing);
    sum += std::abs(f);
  }
  EXPECT_LT(sum / static_cast<double>(x.size()), 0.02 * spacing);
}

TEST(MpuSurface, KeepsTheSidesOfAWallApart) {
  const std::size_t n = 8000;
  const double spacing = std::sqrt(8.0 / n), half = 0.75 * spacing;
  PointSet cloud;
  for (const Vec3& p : somewhere(n, 1)) {
    cloud.positions.emplace_back(Vec3{p.x, p.y, p.z < 0 ? -half : half});
    cloud.normals.emplace_back(Vec3{0, 0, p.z < 0 ? -1.0 : 1.0});
  }
  const MpuSurface surface =
      mpu_of(cloud, {.error = 0.05 * spacing});  // the default error would treat the wall as noise
  std::vector<Vec3> x;
  for (const Vec3& p : somewhere(500, 0.9)) x.push_back({p.x, p.y, 0}), x.push_back({p.x, p.y, 2 * half});
  const std::vector<double> values = values_at(surface, x);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < x.size(); ++i) wrong += (values[i] < 0) != (i % 2 == 0);
  EXPECT_EQ(wrong, 0u);
}

TEST(MpuSurface, GradientsMatchDifferences) {
  for (const PointSet& cloud : {test::torus(6000), test::sphere(2000, 0.02)}) {
    const MpuSurface surface = mpu_of(cloud);
    std::vector<Vec3> x = somewhere(300, 1.1);
    for (const Vec3& p : somewhere(100, 4)) x.push_back(p);  // outside of the cube
    std::vector<double> values(x.size());
    std::vector<Vec3> gradients(x.size());
    surface.evaluate(x, values, gradients);
    EXPECT_EQ(values, values_at(surface, x));
    const double step = 1e-6;
    std::size_t off = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        std::vector<Vec3> y{x[i], x[i]};
        y[0][k] -= step, y[1][k] += step;
        const std::vector<double> v = values_at(surface, y);
        off += std::abs((v[1] - v[0]) / (2 * step) - gradients[i][k]) > 1e-4 * (1 + norm(gradients[i]));
      }
    EXPECT_LE(off, 3u) << "but at creases, where they jump";
  }
}

TEST(MpuSurface, RangesHoldWhatItsValuesAre) {
  for (const PointSet& cloud : {test::torus(3000), test::cube(3000)}) {
    const MpuSurface surface = mpu_of(cloud);
    const std::vector<Vec3> x = somewhere(200, 1.6);
    for (const double radius : {0.0, 1e-3, 0.05, 0.4}) {
      std::vector<ValueRange> found(x.size());
      surface.ranges(x, radius, found);
      std::vector<Vec3> y = on_sphere(60, radius);
      for (std::size_t i = 0; i < x.size(); ++i) {
        std::vector<Vec3> at;
        for (std::size_t k = 0; k < y.size(); ++k) at.push_back(x[i] + y[k] * (k % 2 == 0 ? 1.0 : 0.5));
        for (const double f : values_at(surface, at)) {
          ASSERT_LE(found[i].least, f);
          ASSERT_GE(found[i].most, f);
        }
        if (radius < 1e-2) {
          EXPECT_LT(found[i].most - found[i].least, 40.0);
        }
      }
    }
  }
}

TEST(MpuSurface, IsTheSameForAnyNumberOfThreads) {
  const PointSet cloud = notched_cube(2000);
  const std::vector<Vec3> x = somewhere(1000, 1.3);
  const KdTree tree(cloud.positions);
  const std::vector<float> radii(cloud.size(), 0.03f);
  test::expect_equal_for_any_threads([&] {
    const MpuSurface surface = mpu_of(cloud);
    std::vector<double> values(x.size());
    std::vector<Vec3> gradients(x.size());
    surface.evaluate(x, values, gradients);
    const BallUnion gaps = surface.gap_balls({tree, radii});
    for (const Vec3& g : gradients) values.push_back(g.x + 2 * g.y + 3 * g.z);
    for (const Vec3f& c : gaps.centers) values.push_back(static_cast<double>(c.x));
    return values;
  });
}

TEST(MpuSurface, TheOrderOfTheSamplesDoesNotMatter) {
  const PointSet cloud = notched_cube(4000);
  PointSet shuffled;
  std::vector<std::size_t> order(cloud.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(8));
  for (const std::size_t i : order)
    shuffled.positions.push_back(cloud.positions[i]), shuffled.normals.push_back(cloud.normals[i]);
  const std::vector<Vec3> x = somewhere(3000, 1.2);
  EXPECT_EQ(values_at(mpu_of(cloud), x), values_at(mpu_of(shuffled), x));
}

TEST(MpuSurface, TurnsWithItsSamples) {
  const PointSet cloud = notched_cube(12000);
  PointSet moved = cloud;
  for (Vec3f& p : moved.positions) p = Vec3f(turned(Vec3(p)));
  for (Vec3f& n : moved.normals) n = Vec3f(turned(Vec3(n)));
  std::vector<Vec3> x, y;
  for (std::size_t i = 0; i < cloud.size(); i += 20)
    for (const double h : {-0.01, 0.0, 0.01})
      x.push_back(Vec3(cloud.positions[i]) + Vec3(cloud.normals[i]) * h), y.push_back(turned(x.back()));
  const std::vector<double> a = values_at(mpu_of(cloud), x), b = values_at(mpu_of(moved), y);
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += std::abs(a[i] - b[i]);
  EXPECT_LT(sum / static_cast<double>(x.size()), 2e-4) << "but for where the cells lie";
}

TEST(MpuSurface, CellsAreDividedUntilTheirSamplesAreNearEnough) {
  const PointSet cloud = test::torus(5000);
  std::size_t before = 0;
  for (const double error : {0.05, 0.01, 0.002}) {
    const MpuSurface surface = mpu_of(cloud, {.error = error, .sharp = false});
    EXPECT_EQ(surface.report().error, error);
    EXPECT_GT(surface.report().leaves, before);
    before = surface.report().leaves;
    std::size_t many = 0, beyond = 0;
    for (const MpuLeaf& l : surface.tree().leaves) {
      std::vector<Vec3> inside;
      for (const Vec3f& p : cloud.positions)
        if (const Vec3 d = Vec3(p) - l.center; norm(d) < 0.999 * l.radius) inside.push_back(d);
      if (l.samples < kLeastSamples) continue;
      LocalShape shape;
      shape.combination = l.combination;
      shape.pieces[0] = surface.tree().pieces[l.first_piece];
      ++many, beyond += shape_error(shape, inside) > error * 1.001;
    }
    EXPECT_GT(many, 0u);
    EXPECT_EQ(beyond, 0u) << error;
  }
  EXPECT_LE(mpu_of(cloud, {.error = 1e-6, .max_depth = 3}).report().depth, 3);
}

TEST(MpuSurface, IsFiniteWhateverTheSamples) {
  std::vector<PointSet> clouds(4);
  for (int i = 0; i < 200; ++i) {
    const float t = static_cast<float>(i) / 50;
    clouds[0].positions.push_back({t, 0, 0}), clouds[0].normals.push_back({0, 0, 1});
    clouds[1].positions.push_back({i % 7 == 0 ? t : 0, 0, 0}),
        clouds[1].normals.push_back({0, i % 2 ? 1.0f : -1.0f, 1});
    clouds[2].positions.push_back({t, t * t, t * t * t}),
        clouds[2].normals.push_back({std::cos(9 * t), std::sin(7 * t), t});
  }
  clouds[3] = test::sphere(9);
  clouds[3].positions.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0}),
      clouds[3].normals.push_back({1, 0, 0});
  for (const PointSet& cloud : clouds) {
    const MpuSurface surface = mpu_of(cloud, {.max_depth = 8});
    std::vector<Vec3> x = somewhere(200, 6);
    x.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
    std::vector<double> values(x.size());
    std::vector<Vec3> gradients(x.size());
    surface.evaluate(x, values, gradients);
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_TRUE(std::isfinite(values[i]));
      ASSERT_TRUE(is_finite(gradients[i]));
    }
  }
}

TEST(MpuSurface, RefusesWhatMakesNoSurface) {
  PointSet none, bare = test::sphere(50), few = test::sphere(8), same;
  bare.normals.clear();
  same.positions.assign(50, {1, 2, 3}), same.normals.assign(50, {0, 0, 1});
  for (const PointSet* cloud : {&none, &bare, &few, &same}) EXPECT_THROW(mpu_of(*cloud), DataError);
  const auto refused = [](const MpuOptions& options, const char* field) {
    try {
      mpu_of(test::sphere(100), options);
      ADD_FAILURE() << field;
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  };
  for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
    refused({.error = wrong}, "`error`");
  for (const int wrong : {-1, 1, 15}) refused({.max_depth = wrong}, "`max_depth`");
}

}  // namespace
}  // namespace sansmesh::inline v1
