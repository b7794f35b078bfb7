#include "sansmesh/surface/foot_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "sansmesh/error.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kApart = 0.1f;

/// Projects points onto a unit sphere about the origin, exactly, within half of the radius.
class SphereProjection final : public Projection {
 public:
  Box3 bounds() const override { return {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}}; }
  void project(std::span<const Vec3> x, std::span<FootPoint> feet) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      feet[i] = {};
      feet[i].position = x[i];
      if (std::abs(norm(x[i]) - 1) > 0.5) continue;
      feet[i].position = feet[i].normal = normalized(x[i]);
      feet[i].xx = feet[i].yy = -1;
      feet[i].defined = true;
    }
  }
};

/// Points about `apart` from each other on spirals on a sphere, alternately a little off it.
std::vector<Vec3f> beside_sphere(double apart, double off) {
  const auto n = static_cast<std::size_t>(4 * std::numbers::pi / (apart * apart));
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(n);
    const double turn = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5));
    const double r = std::sqrt(1 - z * z);
    const double scale = 1 + off * (static_cast<double>(i % 3) - 1);
    points.push_back(Vec3f(Vec3{r * std::cos(turn), r * std::sin(turn), z} * scale));
  }
  return points;
}

SurfaceFeet sphere_feet() {
  const std::vector<Vec3f> points = beside_sphere(static_cast<double>(kApart), 0.05);
  return find_feet(SphereProjection(), points, std::vector<float>(points.size(), kApart));
}

std::vector<Vec3> shell(double least, double most) {
  std::vector<Vec3> x;
  for (int i = 0; i < 4000; ++i) {
    const double z = std::sin(0.37 * i), turn = 2.4 * i, r = std::sqrt(1 - z * z);
    const double radius = least + (most - least) * (0.5 + 0.5 * std::sin(1.7 * i));
    x.push_back(Vec3{r * std::cos(turn), r * std::sin(turn), z} * radius);
  }
  return x;
}

TEST(FootField, IsTheDistanceToASphere) {
  const FootField field(sphere_feet());
  const std::vector<Vec3> x = shell(0.95, 1.05);
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  std::vector<std::uint8_t> inside(x.size());
  field.evaluate_in_domain(x, values, gradients, inside);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_EQ(inside[i], 1);
    // A sphere differs from its paraboloid by less than d³ at distance d along it, d at most 1.6 spacings.
    EXPECT_NEAR(values[i], norm(x[i]) - 1, 0.16 * 0.16 * 0.16);
    EXPECT_GT(dot(normalized(gradients[i]), normalized(x[i])), std::cos(0.02));
  }
}

TEST(FootField, ParaboloidsCountNotPlanes) {
  SurfaceFeet flat = sphere_feet();
  for (FootPoint& foot : flat.feet) foot.xx = foot.yy = 0;
  const FootField round(sphere_feet()), planes(flat);
  const std::vector<Vec3> x = shell(1, 1);
  std::vector<double> a(x.size()), b(x.size());
  round.evaluate(x, a);
  planes.evaluate(x, b);
  double of_round = 0, of_planes = 0;
  for (std::size_t i = 0; i < x.size(); ++i) of_round += std::abs(a[i]), of_planes += std::abs(b[i]);
  EXPECT_LT(of_round, 0.05 * of_planes);
}

TEST(FootField, IsUndefinedFarFromFeetAndThenAnotherFieldHolds) {
  class Seven final : public ScalarField {
   public:
    Box3 bounds() const override { return {{-9, -9, -9}, {9, 9, 9}}; }
    void evaluate(std::span<const Vec3>, std::span<double> values, std::span<Vec3> gradients) const override {
      std::fill(values.begin(), values.end(), 7);
      std::fill(gradients.begin(), gradients.end(), Vec3{1, 0, 0});
    }
  } const seven;
  const FootField alone(sphere_feet()), with(sphere_feet(), &seven);
  const std::vector<Vec3> x{{0, 0, 0}, {0, 0, 1}, {0, 0, 1.3}, {3, 0, 0}};
  std::vector<double> values(4);
  std::vector<Vec3> gradients(4);
  std::vector<std::uint8_t> inside(4);
  alone.evaluate_in_domain(x, values, gradients, inside);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 1, 0, 0}));
  EXPECT_EQ(values[0], alone.bounds().diagonal());
  with.evaluate_in_domain(x, values, gradients, inside);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 1, 0, 0}));
  EXPECT_EQ(values[0], 7);
  EXPECT_EQ(gradients[3].x, 1);
  EXPECT_NEAR(values[1], 0, 1e-3);
}

/// Two sheets closer to each other than the width of supports, facing away from each other, are kept apart.
TEST(FootField, KeepsSheetsApart) {
  SurfaceFeet feet;
  for (const double z : {0.04, -0.04})
    for (int j = -10; j <= 10; ++j)
      for (int i = -10; i <= 10; ++i) {
        FootPoint foot;
        foot.position = {i * 0.1, j * 0.1, z};
        foot.normal = {0, 0, z > 0 ? 1.0 : -1.0};
        foot.defined = true;
        feet.feet.push_back(foot);
        feet.spacing.push_back(kApart);
        feet.start.push_back(static_cast<std::uint32_t>(feet.start.size()));
      }
  const FootField field(feet);
  const std::vector<Vec3> x{{0.03, 0.02, 0.06}, {0.03, 0.02, 0.03}, {0.03, 0.02, -0.01}, {0.03, 0.02, -0.07}};
  std::vector<double> values(4);
  field.evaluate(x, values);
  EXPECT_NEAR(values[0], 0.02, 1e-6);
  EXPECT_NEAR(values[1], -0.01, 1e-6);
  EXPECT_NEAR(values[2], -0.03, 1e-6);
  EXPECT_NEAR(values[3], 0.03, 1e-6);
}

TEST(FootField, FeetAreFoundAndStraysAreNot) {
  std::vector<Vec3f> points{{0, 0, 1.1f}, {0, 0, 1.4f}, {0, 0, 2}, {0.9f, 0, 0}};
  const SurfaceFeet feet = find_feet(SphereProjection(), points, std::vector<float>(4, kApart));
  EXPECT_EQ(feet.start, (std::vector<std::uint32_t>{0, 3}));  // four spacings away; undefined
  for (const FootPoint& foot : feet.feet) EXPECT_NEAR(norm(foot.position), 1, 1e-6);
  EXPECT_THROW(FootField(SurfaceFeet{}), DataError);
}

TEST(FootField, DoesNotDependOnThreads) {
  test::expect_equal_for_any_threads([&] {
    const FootField field(sphere_feet());
    const std::vector<Vec3> x = shell(0.9, 1.1);
    std::vector<double> values(x.size());
    field.evaluate(x, values);
    return values;
  });
}

}  // namespace
}  // namespace sansmesh::inline v1
