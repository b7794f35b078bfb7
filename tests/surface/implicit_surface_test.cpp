#include "sansmesh/surface/implicit_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/surface/iterated_planes.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

ImplicitSurface make(const PointSet& cloud, const ImplicitOptions& options) {
  Progress progress;
  return make_implicit_surface(prepare_samples(cloud, progress), options, progress);
}

/// A flat patch z = 0 with jittered samples, |x|, |y| < 1.
PointSet patch(int n, double jitter, unsigned seed, float z = 0, float side = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-jitter, jitter);
  PointSet cloud;
  const double step = 2.0 / n;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = -1 + (i + 0.5 + u(random)) * step, y = -1 + (j + 0.5 + u(random)) * step;
      cloud.positions.push_back({static_cast<float>(x), static_cast<float>(y), z});
      cloud.normals.push_back({0, 0, side});
    }
  return cloud;
}

std::vector<Vec3> points_near_sphere(std::size_t n, double radius, double spread, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> g;
  std::uniform_real_distribution<double> u(-spread, spread);
  std::vector<Vec3> x;
  while (x.size() < n) x.push_back(normalized(Vec3{g(random), g(random), g(random)}) * (radius + u(random)));
  return x;
}

class EveryMethod : public testing::TestWithParam<std::string> {
 protected:
  ImplicitOptions options() const {
    ImplicitOptions o;
    o.method = implicit_method(GetParam());
    if (GetParam() == "amls") o.order = 4, o.iterations = 3, o.smoothing = 1.2;
    return o;
  }
};

TEST_P(EveryMethod, IsTheSignedDistanceToAPlane) {
  const ImplicitSurface f = make(patch(40, 0.35, 3), options());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-0.7, 0.7), z(-0.02, 0.02);
  std::vector<Vec3> x;
  for (int i = 0; i < 500; ++i) x.push_back({u(random), u(random), z(random)});
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  std::vector<std::uint8_t> inside(x.size());
  f.evaluate_in_domain(x, values, gradients, inside);
  // Orders 4 and 6 and the extremal energy measure distances off the surface in another scale.
  const bool metric = GetParam() != "amls" && GetParam() != "extremal";
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_TRUE(inside[i]);
    EXPECT_EQ(values[i] > 0, x[i].z > 0);
    if (metric) {
      EXPECT_NEAR(values[i], x[i].z, 1e-6);
    }
    EXPECT_GT(normalized(gradients[i]).z, metric ? 0.999999 : 0.98);
  }
}

TEST_P(EveryMethod, FindsASphere) {
  const ImplicitSurface f = make(test::sphere(8000), options());
  const std::vector<Vec3> x = points_near_sphere(2000, 1, 0.004, 7);
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  f.evaluate(x, values, gradients);
  double error = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double distance = norm(x[i]) - 1;
    const double found = values[i] / norm(gradients[i]);
    error += std::abs(found - distance);
    EXPECT_GT(dot(normalized(gradients[i]), normalized(x[i])), 0.98);
  }
  // Spacing 0.04: planes have errors of about κ h² / 2, spheres and higher orders do not.
  const std::string& name = GetParam();
  const double limit = name == "apss" ? 1e-5 : name == "amls" ? 2e-4 : name == "dey" ? 3e-3 : 1.5e-3;
  EXPECT_LT(error / static_cast<double>(x.size()), limit);
}

TEST_P(EveryMethod, HasExactGradients) {
  const ImplicitSurface f = make(test::torus(6000), options());
  std::mt19937 random(11);
  std::uniform_real_distribution<double> angle(0, 6.28), off(-0.01, 0.01);
  constexpr double kStep = 2e-4;
  std::size_t tested = 0, seams = 0;
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    const double u = angle(random), v = angle(random);
    const Vec3 n{std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)};
    const Vec3 x = Vec3{std::cos(u), std::sin(u), 0} + n * (0.35 + off(random));
    std::vector<Vec3> around{x};
    for (std::size_t k = 0; k < 3; ++k)
      for (const double s : {-1.0, 1.0}) {
        Vec3 y = x;
        y[k] += s * kStep;
        around.push_back(y);
      }
    std::vector<double> values(around.size());
    std::vector<Vec3> gradients(around.size());
    f.evaluate(around, values, gradients);
    const Vec3 numeric{(values[2] - values[1]) / (2 * kStep), (values[4] - values[3]) / (2 * kStep),
                       (values[6] - values[5]) / (2 * kStep)};
    const double error = norm(numeric - gradients[0]) / norm(gradients[0]);
    // hoppe is piecewise linear: finite differences across a seam are meaningless, elsewhere the gradient is the
    // sample's normal.
    if (GetParam() == "hoppe" && error > 0.02) {
      ++seams;
      ++tested;
      continue;
    }
    worst = std::max(worst, error);
    ++tested;
  }
  EXPECT_EQ(tested, 300u);
  EXPECT_LT(worst, 0.02);
  EXPECT_LT(seams, 30u);
}

TEST_P(EveryMethod, KeepsTwoSheetsApart) {
  // A plate of thickness 1.2 spacings, less than the supports.
  PointSet plate = patch(50, 0.3, 5, 0.024f, 1);
  const PointSet bottom = patch(50, 0.3, 6, -0.024f, -1);
  plate.positions.insert(plate.positions.end(), bottom.positions.begin(), bottom.positions.end());
  plate.normals.insert(plate.normals.end(), bottom.normals.begin(), bottom.normals.end());
  const ImplicitSurface f = make(plate, options());
  std::vector<Vec3> x;
  for (const double at : {-0.4, 0.0, 0.3})
    for (double z = -0.1; z <= 0.1; z += 0.001) x.push_back({at, 0.1, z});
  std::vector<double> values(x.size());
  std::vector<std::uint8_t> inside(x.size());
  f.evaluate_in_domain(x, values, {}, inside);
  std::size_t within = 0, above = 0, below = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!inside[i] || std::abs(std::abs(x[i].z) - 0.024) < 0.004) continue;
    EXPECT_EQ(values[i] < 0, std::abs(x[i].z) < 0.024) << x[i].z;
    ++(std::abs(x[i].z) < 0.024 ? within : x[i].z > 0 ? above : below);
  }
  // Steps of 0.001 at three points: at least half a spacing deep on each side of both sheets.
  for (const std::size_t n : {within, above, below}) EXPECT_GT(n, 30u);
}

TEST_P(EveryMethod, EndsAtTheBallsOfItsBorder) {
  const PointSet cloud = patch(40, 0, 1);
  ImplicitOptions o = options();
  o.reach = 1.5;
  const ImplicitSurface f = make(cloud, o);
  const double spacing = f.report().spacing;
  const double edge = 1 - 0.025;  // the outermost samples
  std::vector<Vec3> x{{0, 0, 0}, {edge + 1.2 * spacing, 0, 0}, {edge + 2 * spacing, 0, 0}, {5, 0, 0.1}, {0, 0, 3}};
  std::vector<double> values(x.size());
  std::vector<std::uint8_t> inside(x.size());
  f.evaluate_in_domain(x, values, {}, inside);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 1, 0, 0, 0}));
  for (const double v : values) EXPECT_TRUE(std::isfinite(v));
  EXPECT_GT(values[4], 2);  // beyond all supports: the distance to the nearest sample
}

TEST_P(EveryMethod, TurnsAndScalesWithItsSamples) {
  const PointSet cloud = test::torus(3000);
  PointSet turned = cloud;
  const auto turn = [](const Vec3f& p) { return Vec3f{p.y, p.z, p.x}; };
  for (Vec3f& p : turned.positions) p = turn(p) * 512.0f;
  for (Vec3f& n : turned.normals) n = turn(n);
  ImplicitOptions o = options();
  o.smoothing = 1.3;
  const ImplicitSurface f = make(cloud, o), g = make(turned, o);
  std::vector<Vec3> x, y;
  for (std::size_t i = 0; i < cloud.size(); i += 10) {
    x.push_back(Vec3(cloud.positions[i]) + Vec3(cloud.normals[i]) * 0.005);
    y.push_back(Vec3{x.back().y, x.back().z, x.back().x} * 512.0);
  }
  std::vector<double> a(x.size()), b(x.size());
  f.evaluate(x, a);
  g.evaluate(y, b);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(a[i] * 512, b[i], 512 * 2e-5);
}

TEST_P(EveryMethod, DoesNotDependOnTheThreads) {
  SANSMESH_RUNS_ONCE("compares results; others run the same loops");
  const PointSet cloud = test::sphere(20000, 0.01, 4);
  const std::vector<Vec3> x = points_near_sphere(3000, 1, 0.03, 2);
  test::expect_equal_for_any_threads([&] {
    const ImplicitSurface f = make(cloud, options());
    std::vector<double> values(x.size());
    f.evaluate(x, values);
    return values;
  });
}

INSTANTIATE_TEST_SUITE_P(Implicit, EveryMethod,
                         testing::ValuesIn(std::vector<std::string>(std::begin(kImplicitMethods),
                                                                    std::end(kImplicitMethods))),
                         [](const auto& test) { return test.param; });

/// The iteration of tejada2008, 4.3.1, exactly as published: g_i fixed at x, iterated again for each x.
double iterated_by_definition(const SurfaceSamples& s, double width, int order, int iterations, const Vec3& x) {
  const std::size_t n = s.size();
  const auto laguerre = [order](double r) {
    return order == 2 ? 1 : order == 4 ? 2.5 - r : 4.375 - 3.5 * r + 0.5 * r * r;
  };
  const double mean = order == 2 ? 1 : order == 4 ? 1.5 : 1.875;
  const auto functions = [&](const Vec3& at) {
    std::vector<double> phi(n, 0);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double r = squared_norm(at - Vec3(s.positions[i])) / (width * width);
      if (r >= 12) continue;
      const double w = std::exp(-r) * s.spacing[i] * s.spacing[i];
      sum += w;
      phi[i] = w * laguerre(r);
    }
    for (double& p : phi) p /= sum * mean;
    return phi;
  };
  std::vector<std::vector<double>> a(n);
  for (std::size_t i = 0; i < n; ++i) a[i] = functions(Vec3(s.positions[i]));
  std::vector<double> g(n);
  for (std::size_t i = 0; i < n; ++i) g[i] = dot(x - Vec3(s.positions[i]), Vec3(s.normals[i]));
  std::vector<double> at_samples(n, 0);  // Mⁿ at the samples
  const std::vector<double> phi = functions(x);
  double value = 0;
  for (int k = 0; k <= iterations; ++k) {
    std::vector<double> residual(n);
    for (std::size_t i = 0; i < n; ++i) residual[i] = g[i] - at_samples[i];
    for (std::size_t i = 0; i < n; ++i) value += residual[i] * phi[i];
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) at_samples[i] += a[i][j] * residual[j];
  }
  return value;
}

TEST(IteratedPlanes, ArePrecomputedForAnyPoint) {
  const PointSet cloud = test::sphere(400);
  Progress progress;
  const SurfaceSamples samples = prepare_samples(cloud, progress);
  for (const int order : {2, 4, 6})
    for (const int iterations : {0, 1, 4, 10}) {
      ImplicitOptions o;
      o.method = ImplicitMethod::amls;
      o.order = order, o.iterations = iterations, o.bandwidth = 0.25, o.separate_sheets = false, o.reach = 1.2;
      const ImplicitSurface f = make_implicit_surface(samples, o, progress);
      const std::vector<Vec3> x = points_near_sphere(20, 1, 0.05, 3);
      std::vector<double> values(x.size());
      std::vector<std::uint8_t> inside(x.size());
      f.evaluate_in_domain(x, values, {}, inside);
      for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_TRUE(inside[i]);
        EXPECT_NEAR(values[i], iterated_by_definition(samples, 0.25, order, iterations, x[i]), 2e-6)
            << "order " << order << ", iterations " << iterations;
      }
    }
}

TEST(IteratedPlanes, ApproachTheSamples) {
  const PointSet cloud = test::torus(2000);
  double last = 1;
  for (const int iterations : {0, 3, 10, 40}) {
    ImplicitOptions o;
    o.method = ImplicitMethod::amls;
    o.order = 2, o.iterations = iterations, o.smoothing = 1.5;
    const ImplicitSurface f = make(cloud, o);
    std::vector<Vec3> x(cloud.positions.begin(), cloud.positions.end());
    std::vector<double> values(x.size());
    f.evaluate(x, values);
    double sum = 0;
    for (const double v : values) sum += std::abs(v);
    sum /= static_cast<double>(values.size());
    EXPECT_LT(sum, 0.7 * last);
    last = sum;
  }
  EXPECT_LT(last, 3e-4);
}

TEST(IteratedPlanes, CrossValidationSmoothsNoiseAndFollowsCleanSamples) {
  SANSMESH_RUNS_ONCE("judges a choice; others make it, too");
  Progress progress;
  detail::IterationOptions options;
  const auto clean = detail::choose_iterations(prepare_samples(test::torus(6000), progress), options, 0, -1);
  PointSet noisy = test::torus(6000);
  std::mt19937 random(9);
  std::normal_distribution<float> g(0, 0.02f);
  for (std::size_t i = 0; i < noisy.size(); ++i) noisy.positions[i] += noisy.normals[i] * g(random);
  const auto rough = detail::choose_iterations(prepare_samples(noisy, progress), options, 0, -1);
  EXPECT_LT(clean.smoothing, rough.smoothing);
  EXPECT_NEAR(rough.error, 0.02, 0.006);  // the remaining error is the noise of the sample left out
  EXPECT_LT(clean.error, 0.002);
}

TEST(IteratedPlanes, TheNoiseChoosesTheOrder) {
  SANSMESH_RUNS_ONCE("judges a choice; others make it, too");
  const PointSet cloud = test::sphere(8000, 0.04);  // one spacing
  ImplicitOptions o;
  o.method = ImplicitMethod::amls;
  const ImplicitSurface f = make(cloud, o);
  EXPECT_EQ(f.report().order, 2);
  EXPECT_EQ(f.report().iterations, 1);
  EXPECT_GT(f.report().smoothing, 2.5);
  std::vector<Vec3> x;
  for (const Vec3f& p : test::sphere(500, 0, 2).positions) x.push_back(normalized(Vec3(p)));
  std::vector<double> values(x.size());
  f.evaluate(x, values);
  double squares = 0;
  for (const double v : values) squares += v * v;
  EXPECT_LT(std::sqrt(squares / static_cast<double>(x.size())), 0.4 * 0.04) << "the noise does not stay";
  o.order = 4;
  EXPECT_EQ(make(cloud, o).report().order, 4);
}

TEST(ImplicitSurface, NoiseMakesNoSpots) {
  // There is no second zero between the surface and points well outside or inside, and gradients point outward.
  const PointSet cloud = test::sphere(6000, 0.03);  // ⅔ of a spacing
  for (const ImplicitMethod method : {ImplicitMethod::extremal, ImplicitMethod::hoppe}) {
    ImplicitOptions o;
    o.method = method;
    const ImplicitSurface f = make(cloud, o);
    for (const double radius : {0.93, 1.07}) {
      std::vector<Vec3> x;
      for (const Vec3f& p : test::sphere(3000, 0, 3).positions) x.push_back(normalized(Vec3(p)) * radius);
      std::vector<double> values(x.size());
      std::vector<Vec3> gradients(x.size());
      f.evaluate(x, values, gradients);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < x.size(); ++i)
        wrong += (values[i] < 0) != (radius < 1) || dot(gradients[i], x[i]) < 0.5;
      EXPECT_LE(wrong, 30u) << static_cast<int>(method) << " at " << radius;
    }
  }
}

TEST(ImplicitSurface, RefusesWhatItCannotUse) {
  Progress progress;
  PointSet bare = test::sphere(100);
  bare.normals.clear();
  EXPECT_THROW(prepare_samples(bare, progress), DataError);
  PointSet few = test::sphere(5);
  EXPECT_THROW(prepare_samples(few, progress), DataError);
  PointSet same;
  same.positions.assign(50, {1, 2, 3});
  same.normals.assign(50, {0, 0, 1});
  EXPECT_THROW(prepare_samples(same, progress), DataError);
  PointSet holey = test::sphere(100);
  holey.positions[3].x = NAN;
  holey.normals[5] = {};
  EXPECT_EQ(prepare_samples(holey, progress).size(), 98u);
  EXPECT_THROW(ImplicitOptions{.bandwidth = 0}.validate(), ArgumentError);
  EXPECT_THROW(ImplicitOptions{.smoothing = -1}.validate(), ArgumentError);
  EXPECT_THROW(ImplicitOptions{.order = 3}.validate(), ArgumentError);
  EXPECT_THROW(ImplicitOptions{.iterations = 1000}.validate(), ArgumentError);
}

TEST(ImplicitSurface, LeavesPointsThatAreNotFiniteAlone) {
  const ImplicitSurface f = make(test::sphere(500), {});
  const std::vector<Vec3> x{{NAN, 0, 0}, {1, 0, 0}, {INFINITY, 0, 0}};
  std::vector<double> values(3, 7);
  std::vector<std::uint8_t> inside(3, 1);
  f.evaluate_in_domain(x, values, {}, inside);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_TRUE(std::isfinite(values[0]) && std::isfinite(values[2]));
}

}  // namespace
}  // namespace sansmesh::inline v1
