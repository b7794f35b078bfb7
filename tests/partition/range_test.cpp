// Bounds of a fitted function: slopes of its local functions, and ranges of its values in balls.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "sansmesh/partition/edit/partition_edit.h"
#include "sansmesh/partition/fit/partition_fit.h"
#include "support/thin_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using Random = std::mt19937_64;

Vec3 point_in_ball(Random& random, const Vec3& center, double radius) {
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> unit(0, 1);
  const Vec3 d = normalized(Vec3{gauss(random), gauss(random), gauss(random)});
  // Half of them on the sphere, where extremes are.
  return center + d * (random() % 2 ? radius : radius * std::cbrt(unit(random)));
}

/// ‖∇f‖ of one local function, by finite differences in double.
double gradient_length(const LocalFunction& f, const Vec3& x) {
  const auto value = [&](const Vec3& p) {
    const Vec3 d = (p - Vec3(f.center)) / static_cast<double>(f.scale);
    const double u = dot(d, Vec3(f.xi)), v = dot(d, Vec3(f.eta)), w = dot(d, Vec3(f.nu));
    double g = 0;
    std::size_t k = 0;
    for (int n = 0; n <= 4; ++n)
      for (int j = 0; j <= n; ++j) g += static_cast<double>(f.coefficient[k++]) * std::pow(u, n - j) * std::pow(v, j);
    return (w - g) * static_cast<double>(f.scale);
  };
  const double h = 1e-5 * static_cast<double>(f.scale);
  Vec3 g;
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 a = x, b = x;
    a[k] -= h, b[k] += h;
    g[k] = (value(b) - value(a)) / (2 * h);
  }
  return norm(g);
}

TEST(LocalSlope, IsNeverExceededAndNearlyReached) {
  Random random(5);
  std::normal_distribution<float> gauss;
  for (int trial = 0; trial < 400; ++trial) {
    LocalFunction f;
    f.degree = trial % 5;
    f.center = {0.3f, -0.2f, 0.1f};
    f.scale = 0.2f;
    f.nu = normalized(Vec3f{gauss(random), gauss(random), gauss(random)});
    tangent_frame(f.nu, f.xi, f.eta);
    for (std::size_t k = 0; k < static_cast<std::size_t>(kBasisSize[static_cast<std::size_t>(f.degree)]); ++k)
      f.coefficient[k] = 0.5f * gauss(random);
    // Also around another point than the function's centre.
    const Vec3f center = f.center + Vec3f{0.02f, 0.05f, -0.03f} * static_cast<float>(trial % 2);
    const float radius = trial % 3 == 0 ? 0.12f : 0.2f;
    const auto slope = static_cast<double>(local_slope(f, center, radius));
    double largest = 0;
    for (int i = 0; i < 1500; ++i)
      largest = std::max(largest, gradient_length(f, point_in_ball(random, Vec3(center), static_cast<double>(radius))));
    ASSERT_LE(largest, slope * (1 + 1e-6)) << trial;
    if (f.degree == 0) {
      ASSERT_NEAR(slope, 1, 1e-3);
    }
    if (f.degree == 1) {
      ASSERT_NEAR(slope, std::hypot(1, f.coefficient[1], f.coefficient[2]), 1e-3 * slope);
    }
    ASSERT_LE(slope, 4 * largest) << trial;  // for polynomials as wild as these; bounds for fits are tighter
  }
}

TEST(LocalSlope, OfAConstantIsZero) {
  LocalFunction f;
  f.coefficient[0] = -3;
  f.scale = 0.5f;
  EXPECT_EQ(local_slope(f, {}, 1), 0);
}

PartitionOfUnity fitted(const PointSet& cloud) {
  Progress progress;
  return fit_partition_of_unity(cloud, {}, progress);
}

struct Shape {
  const char* name;
  test::ThinShape shape;
  double spacing;
};
void PrintTo(const Shape& s, std::ostream* out) { *out << s.name; }

/// No value is outside of the ranges, for any ball.
void expect_true_ranges(const PartitionOfUnity& field, std::size_t balls, std::size_t& bounded) {
  const PartitionData& data = field.data();
  Random random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  const Box3 box = field.bounds();
  for (const double share : {0.001, 0.05, 0.2, 0.6, 1.5, 4.0}) {
    std::vector<Vec3> centers;
    double radius = 0;
    for (std::size_t i = 0; i < data.supports.size(); ++i) radius += static_cast<double>(data.functions[i].radius);
    radius *= share / static_cast<double>(data.supports.size());
    for (std::size_t i = 0; i < balls; ++i) {
      const LocalFunction& f = data.functions[random() % data.supports.size()];
      const double wide = static_cast<double>(f.radius) * (i % 3 == 0 ? 3 : 1);
      Vec3 place = point_in_ball(random, data.origin + Vec3(f.center), wide);
      if (i % 4 == 0)
        for (std::size_t k = 0; k < 3; ++k) place[k] = box.lower[k] + box.size()[k] * unit(random);
      centers.push_back(place);
    }
    std::vector<ValueRange> ranges(balls);
    field.ranges(centers, radius, ranges);
    std::vector<Vec3> x;
    constexpr std::size_t kEach = 50;
    for (const Vec3& c : centers)
      for (std::size_t k = 0; k < kEach; ++k) x.push_back(k == 0 ? c : point_in_ball(random, c, radius));
    std::vector<double> values(x.size());
    field.evaluate(x, values);
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_LE(ranges[i / kEach].least, values[i]) << share << " " << i;
      ASSERT_GE(ranges[i / kEach].most, values[i]) << share << " " << i;
    }
    for (const ValueRange& r : ranges) bounded += !r.holds_zero();
  }
}

class Ranges : public testing::TestWithParam<Shape> {};

TEST_P(Ranges, HoldAllValues) {
  const PartitionOfUnity field = fitted(test::even_samples(GetParam().shape, GetParam().spacing));
  std::size_t bounded = 0;
  expect_true_ranges(field, 400, bounded);
  EXPECT_GT(bounded, 400u);  // out of 2400
  // The same after edits: constants against the surface around them, fits of another degree, removed supports.
  Progress progress;
  SupportQuery query;
  query.half_space = SupportQuery::HalfSpace{{}, {1, 0, 0}};
  const PartitionData& data = field.data();
  const Selection chosen = select_supports(data, query);
  ASSERT_FALSE(chosen.empty());
  for (const PartitionData& edited : {set_constant(data, chosen, 0.5f).data, set_constant(data, chosen, -3).data,
                                      remove_supports(data, chosen).data}) {
    PartitionData again = edited;
    again.find_slopes();
    ASSERT_TRUE(std::equal(again.slopes.begin(), again.slopes.end(), edited.slopes.begin(), edited.slopes.end()));
    ASSERT_NO_THROW(edited.validate());
    expect_true_ranges(PartitionOfUnity(edited), 100, bounded);
  }
}

INSTANTIATE_TEST_SUITE_P(Partition, Ranges,
                         testing::Values(Shape{"gyroid_2", test::gyroid_shell(0.1, 0.6), 0.05},
                                         Shape{"gyroid_5", test::gyroid_shell(0.25, 0.6), 0.05},
                                         Shape{"plate_2", test::perforated_plate(0.08, 3, false), 0.04},
                                         Shape{"plate_sharp", test::perforated_plate(0.12, 3, true), 0.04},
                                         Shape{"tube_3", test::thin_tube(0.12), 0.04},
                                         Shape{"tori_2", test::linked_tori(3, 0.05), 0.05}),
                         [](const auto& of) { return std::string(of.param.name); });

/// Noise, holes, loose ends: any samples.
TEST(PartitionRanges, HoldAllValuesOfNonsense) {
  Random random(3);
  std::normal_distribution<float> gauss;
  PointSet cloud;
  for (int i = 0; i < 3000; ++i) {
    cloud.positions.push_back(Vec3f{gauss(random), gauss(random), gauss(random)} * 0.2f);
    cloud.normals.push_back(normalized(Vec3f{gauss(random), gauss(random), gauss(random)}));
  }
  std::size_t bounded = 0;
  expect_true_ranges(fitted(cloud), 500, bounded);
  EXPECT_GT(bounded, 200u);  // out of 3000
}

/// Floats, so values, are coarse far from the origin.
TEST(PartitionRanges, HoldAllValuesFarAway) {
  test::ThinShape sphere;
  sphere.box = test::cube_of(1.2);
  sphere.value = [](const Vec3& x) { return norm(x) - 1; };
  PointSet cloud = test::even_samples(sphere, 0.1);
  for (const float moved : {0.0f, 150.0f}) {
    for (Vec3f& p : cloud.positions) p += Vec3f{moved, -moved, moved};
    const PartitionOfUnity field = fitted(cloud);
    const Vec3 middle = (field.bounds().lower + field.bounds().upper) * 0.5;
    Random random(7);
    for (const double far : {0.0, 1.1, 3.0, 30.0, 500.0}) {
      std::vector<Vec3> centers(60);
      for (Vec3& c : centers) c = point_in_ball(random, middle, far);
      const double radius = 1e-4;
      std::vector<ValueRange> ranges(centers.size());
      field.ranges(centers, radius, ranges);
      for (std::size_t i = 0; i < centers.size(); ++i) {
        std::vector<Vec3> x(40);
        for (Vec3& p : x) p = point_in_ball(random, centers[i], radius);
        std::vector<double> values(x.size());
        field.evaluate(x, values);
        for (const double v : values) {
          ASSERT_LE(ranges[i].least, v) << moved << ' ' << far;
          ASSERT_GE(ranges[i].most, v) << moved << ' ' << far;
        }
        if (far == 500) {
          ASSERT_FALSE(ranges[i].holds_zero());
        }
      }
    }
  }
}

/// If a function is a distance, a ball of a tenth of the distance to its surface has a range without 0.
TEST(PartitionRanges, OfASphereTellWhereItIsNot) {
  test::ThinShape sphere;
  sphere.box = test::cube_of(1.2);
  sphere.value = [](const Vec3& x) { return norm(x) - 1; };
  const PartitionOfUnity field = fitted(test::even_samples(sphere, 0.05));
  Random random(2);
  for (const double off : {-0.9, -0.5, -0.2, -0.1, -0.03, 0.03, 0.1, 0.2, 0.5}) {
    std::vector<Vec3> x(300);
    for (Vec3& p : x) p = point_in_ball(random, {}, 1), p = normalized(p) * (1 + off);
    std::vector<ValueRange> ranges(x.size());
    field.ranges(x, std::abs(off) / 10, ranges);
    const auto unsure = std::count_if(ranges.begin(), ranges.end(), [](const ValueRange& r) { return r.holds_zero(); });
    EXPECT_LE(unsure, 3) << off;  // out of 300: few points are in a support with a very wrong function
  }
}

TEST(PartitionRanges, AreInfiniteWhereNothingCanBeSaid) {
  const PartitionOfUnity field = fitted(test::even_samples(test::thin_tube(0.2), 0.05));
  const double huge = 1e6, nan = std::nan("");
  std::vector<Vec3> x{{0, 0, 0}, {nan, 0, 0}};
  std::vector<ValueRange> ranges(2);
  field.ranges(x, huge, ranges);
  for (const ValueRange& r : ranges) EXPECT_TRUE(std::isinf(r.least) && std::isinf(r.most) && r.holds_zero());
}

}  // namespace
}  // namespace sansmesh::inline v1
