#include "sansmesh/measure/smallest_box.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "measure/measure_shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/measure/body_measures.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using Axes = std::array<Vec3, 3>;

Vec3 turned_about(const Vec3& p, const Vec3& axis, double angle) {
  return p * std::cos(angle) + cross(axis, p) * std::sin(angle) + axis * (dot(axis, p) * (1 - std::cos(angle)));
}

std::vector<Vec3f> turned(std::vector<Vec3f> points, const Vec3& axis, double angle) {
  for (Vec3f& p : points) p = Vec3f(turned_about(Vec3(p), normalized(axis), angle));
  return points;
}

double volume_along(const std::vector<Vec3f>& points, const Axes& axes) {
  double volume = 1;
  for (const Vec3& axis : axes) {
    double low = INFINITY, high = -INFINITY;
    for (const Vec3f& p : points) low = std::min(low, dot(axis, Vec3(p))), high = std::max(high, dot(axis, Vec3(p)));
    volume *= high - low;
  }
  return volume;
}

double volume_of(const OrientedBox& box) { return box.sizes[0] * box.sizes[1] * box.sizes[2]; }

const Axes kUpright{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

Axes random_axes(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Vec3 u = normalized(Vec3{normal(random), normal(random), normal(random)});
  const Vec3 v = normalized(cross(u, {normal(random), normal(random), normal(random)}));
  return {u, v, cross(u, v)};
}

/// The smallest of very many frames; random rotations improve the best of them.
double brute_force(const std::vector<Vec3f>& points, std::mt19937& random) {
  double least = volume_along(points, kUpright);
  std::normal_distribution<double> normal;
  for (int start = 0; start < 30; ++start) {
    Axes best = random_axes(random);
    double volume = volume_along(points, best);
    for (int i = 0; i < 100; ++i) {
      const Axes other = random_axes(random);
      if (const double v = volume_along(points, other); v < volume) best = other, volume = v;
    }
    double step = 0.2;
    for (int i = 0; i < 600; ++i, step *= 0.985) {
      const Vec3 axis = normalized(Vec3{normal(random), normal(random), normal(random)});
      Axes near = best;
      const double angle = step * normal(random);
      for (Vec3& a : near) a = turned_about(a, axis, angle);
      if (const double v = volume_along(points, near); v < volume) best = near, volume = v;
    }
    least = std::min(least, volume);
  }
  return least;
}

void expect_holds(const OrientedBox& box, const std::vector<Vec3f>& points) {
  for (std::size_t k = 0; k < 3; ++k) {
    double low = INFINITY, high = -INFINITY;
    for (const Vec3f& p : points) {
      const double along = dot(Vec3(p) - box.center, box.axes[k]);
      low = std::min(low, along), high = std::max(high, along);
    }
    EXPECT_NEAR(low, -0.5 * box.sizes[k], 1e-6);
    EXPECT_NEAR(high, 0.5 * box.sizes[k], 1e-6);
  }
  EXPECT_NEAR(norm(cross(box.axes[0], box.axes[1]) - box.axes[2]), 0, 1e-9);
  EXPECT_GE(box.sizes[0], box.sizes[1]);
  EXPECT_GE(box.sizes[1], box.sizes[2]);
}

TEST(SmallestBox, OfATorusIsNoLargerThanAlignedBoxes) {
  const TriangleMesh torus = test::torus_mesh(80, 30);
  for (const double angle : {0.0, 0.3, 1.1, 2.9}) {
    for (const Vec3& axis : {Vec3{1, 2, 3}, Vec3{0, 0, 1}}) {
      TriangleMesh mesh = torus;
      mesh.vertices = turned(torus.vertices, axis, angle);
      const SolidMeasures m = measure_solid(mesh);
      SCOPED_TRACE(angle);
      expect_holds(m.smallest_box, mesh.vertices);
      const double volume = volume_of(m.smallest_box);
      EXPECT_LE(volume, volume_along(mesh.vertices, kUpright) * (1 + 1e-12));
      EXPECT_LE(volume, volume_along(mesh.vertices, m.whole.mass->axes) * (1 + 1e-12));
      EXPECT_GT(volume, 0.985 * 2.7 * 2.7 * 0.7);
    }
  }
}

TEST(SmallestBox, OfABoxIsTheBox) {
  std::mt19937 random(2);
  const TriangleMesh box = test::box_mesh({-1, -2, -3}, {1, 2, 3});
  for (int i = 0; i < 10; ++i) {
    const Axes axes = random_axes(random);
    const OrientedBox found = smallest_box(turned(box.vertices, axes[0], 0.4 * i));
    EXPECT_NEAR(volume_of(found), 48, 1e-4);
    EXPECT_NEAR(found.sizes[0], 6, 1e-5);
  }
}

TEST(SmallestBox, OfRandomPointsIsAsSmallAsBruteForceFinds) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (const std::size_t count : {4u, 6u, 9u, 14u, 40u}) {
    std::vector<Vec3f> points(count);
    for (Vec3f& p : points) p = {normal(random), 0.7f * normal(random), 0.4f * normal(random)};
    const OrientedBox box = smallest_box(points);
    expect_holds(box, points);
    EXPECT_LE(volume_of(box), 1.002 * brute_force(points, random)) << count;
  }
}

TEST(SmallestBox, OfAFlatSheetIsItsRectangle) {
  std::vector<Vec3f> sheet;
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) sheet.push_back({0.3f * static_cast<float>(x), 0.1f * static_cast<float>(y), 0});
  const OrientedBox box = smallest_box(turned(sheet, {3, 1, 2}, 0.8));
  EXPECT_NEAR(box.sizes[0], 2.7, 1e-5);
  EXPECT_NEAR(box.sizes[1], 0.9, 1e-5);
  EXPECT_NEAR(box.sizes[2], 0, 1e-5);
}

TEST(SmallestBox, IsNoLargerThanGivenBoxes) {
  const std::vector<Vec3f> points = turned(test::octasphere(3).vertices, {1, 1, 3}, 0.5);
  std::mt19937 random(7);
  for (int i = 0; i < 5; ++i) {
    const Axes axes[] = {random_axes(random)};
    EXPECT_LE(volume_of(smallest_box(points, axes)), volume_along(points, axes[0]) * (1 + 1e-12));
  }
}

TEST(SmallestBox, OfFewPoints) {
  EXPECT_THROW(smallest_box({}), DataError);
  EXPECT_EQ(smallest_box({{1, 2, 3}}).center, (Vec3{1, 2, 3}));
  EXPECT_NEAR(smallest_box({{0, 0, 0}, {1, 1, 1}}).sizes[2], 0, 1e-6);
  EXPECT_NEAR(smallest_box({{0, 0, 0}, {1, 1, 1}, {NAN, 0, 0}}).sizes[0], std::sqrt(3.0), 1e-6);
}

TEST(SmallestBox, DoesNotDependOnTheNumberOfThreads) {
  const std::vector<Vec3f> points = turned(test::torus_mesh(90, 40).vertices, {1, 1, 0}, 0.3);
  test::compare_threads([&] { return smallest_box(points); },
                        [](const OrientedBox& one, const OrientedBox& many) {
                          EXPECT_EQ(one.sizes, many.sizes);
                          EXPECT_EQ(one.center, many.center);
                        });
}

}  // namespace
}  // namespace sansmesh::inline v1
