#include "sansmesh/approximation/moving_least_squares.h"

#include <gtest/gtest.h>

#include <limits>

#include "approximation/approximation_samples.h"
#include "sansmesh/error.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using test::smooth;

template <int D>
std::vector<double> evaluated(const MovingLeastSquares<D>& mls, const std::vector<Position<D>>& x) {
  std::vector<double> values(x.size());
  mls.evaluate(x, values);
  return values;
}

template <int D>
double polynomial(int degree, const Position<D>& x) {
  double sum = 0;
  for (int j = 0; j < monomial_count(D, degree); ++j) {
    double t = 1.0 / (1 + j % 7);
    for (std::size_t k = 0; k < D; ++k) t *= std::pow(2 * x[k] - 1, PolynomialOrder<D>::get()[j].exponent[k]);
    sum += t;
  }
  return sum;
}

template <int D>
void check_reproduction(std::size_t n, int max_degree) {
  const auto x = test::random_positions<D>(n, 71);
  const auto points = test::random_positions<D>(40, 72);
  for (int degree = 0; degree <= max_degree; ++degree)
    for (const auto function : {WeightFunction::kCompact, WeightFunction::kWendland, WeightFunction::kGaussian}) {
      SCOPED_TRACE(testing::Message() << D << " variables, degree " << degree << ", " << name_of(function));
      const auto f = [&](const Position<D>& p) { return polynomial<D>(degree, p); };
      const MovingLeastSquares<D> mls(x, test::sampled<D>(x, f), {.degree = degree, .weight = function});
      std::vector<double> values(points.size());
      std::vector<Position<D>> gradients(points.size());
      std::vector<std::int8_t> degrees(points.size());
      mls.evaluate(points, values, gradients, degrees);
      for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(degrees[i], degree);
        ASSERT_NEAR(values[i], f(points[i]), 1e-8);
        for (std::size_t k = 0; k < D; ++k)
          ASSERT_NEAR(gradients[i][k], test::difference<D>(f, points[i], k, 1e-5), 1e-5);
      }
    }
}

TEST(MovingLeastSquares, ReproducesPolynomialsOfItsDegree) {
  check_reproduction<1>(200, 8);
  check_reproduction<2>(500, 6);
  check_reproduction<3>(900, 4);
}

template <int D>
void check_gradients(std::size_t n, int degree, const MovingLeastSquaresOptions& options) {
  auto x = test::random_positions<D>(n, 73);
  for (auto& p : x) p[0] *= p[0];  // density decreases to the right
  auto f = test::sampled<D>(x, smooth<D>);
  std::mt19937 random(7);
  for (double& v : f) v += test::uniform(random, -0.2, 0.2);  // large residuals make the weights' derivative matter
  MovingLeastSquaresOptions all = options;
  all.degree = degree;
  const MovingLeastSquares<D> mls(x, f, all);
  const auto points = test::random_positions<D>(60, 74, 0.15, 0.85);
  std::vector<double> values(points.size());
  std::vector<Position<D>> gradients(points.size());
  mls.evaluate(points, values, gradients);
  const auto plain = evaluated<D>(mls, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_NEAR(values[i], plain[i], 1e-12);
    for (std::size_t k = 0; k < D; ++k) {
      const auto value = [&](const Position<D>& p) { return evaluated<D>(mls, {p})[0]; };
      const double slope = test::difference<D>(value, points[i], k, 1e-6);
      ASSERT_NEAR(gradients[i][k], slope, 1e-4 * (1 + std::abs(slope))) << D << " degree " << degree;
    }
  }
}

TEST(MovingLeastSquares, GradientsAreDerivatives) {
  for (int degree = 0; degree <= 3; ++degree) {
    check_gradients<1>(60, degree, {});
    check_gradients<2>(400, degree, {});
    check_gradients<3>(800, degree, {});
    check_gradients<2>(400, degree, {.weight = WeightFunction::kWendland});
    check_gradients<2>(400, degree, {.weight = WeightFunction::kCompact, .radius = 0.3});
  }
}

template <int D>
double largest_error(int degree, std::size_t n) {
  const double h = 1.0 / static_cast<double>(n);
  const auto x = test::grid<D>(n + 9, -4 * h, h);
  const MovingLeastSquares<D> mls(x, test::sampled<D>(x, smooth<D>), {.degree = degree, .radius = (degree + 2.3) * h});
  const auto points = test::random_positions<D>(300, 75);
  const auto values = evaluated<D>(mls, points);
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) worst = std::max(worst, std::abs(values[i] - smooth<D>(points[i])));
  return worst;
}

// The order of convergence is degree + 1.
TEST(MovingLeastSquares, ConvergesWithItsOrder) {
  for (int degree = 0; degree <= 4; ++degree) {
    const double in_2d = std::log2(largest_error<2>(degree, 16) / largest_error<2>(degree, 32));
    EXPECT_GT(in_2d, degree + 0.75);
    RecordProperty("degree" + std::to_string(degree), std::to_string(in_2d));
    if (degree <= 3) {
      EXPECT_GT(std::log2(largest_error<3>(degree, 6) / largest_error<3>(degree, 12)), degree + 0.5);
    }
  }
}

TEST(MovingLeastSquares, FallsBackWhereSamplesAreFewOrFlat) {
  // One sample, two samples and coincident samples lower the degree.
  std::vector<std::int8_t> degrees(1);
  std::vector<double> value(1);
  std::vector<Position<2>> gradient(1);
  const std::vector<Position<2>> point{{0.3, 0.4}};
  for (std::size_t n : {1, 2, 3, 5}) {
    const auto x = test::random_positions<2>(n, 3);
    const MovingLeastSquares<2> mls(x, std::vector<double>(n, 2.5), {.degree = 3, .radius = 5});
    mls.evaluate(point, value, gradient, degrees);
    EXPECT_NEAR(value[0], 2.5, 1e-12);
    EXPECT_EQ(degrees[0], n < 3 ? 0 : 1);
  }
  const std::vector<Position<2>> same(20, {0.3, 0.3});
  const MovingLeastSquares<2> coincident(same, std::vector<double>(20, -1.0));
  EXPECT_NEAR(evaluated<2>(coincident, {{0.3, 0.31}})[0], -1, 1e-12);
  // Far from all samples the value is the nearest one.
  coincident.evaluate(std::vector<Position<2>>{{1e6, 0}}, value, gradient, degrees);
  EXPECT_EQ(value[0], -1);
  EXPECT_EQ(degrees[0], -1);
  EXPECT_EQ(gradient[0][0], 0);
  // Samples in a plane of space give the result of the plane.
  auto flat = test::random_positions<3>(300, 4);
  for (auto& p : flat) p[2] = 0.5 * p[0] + 0.2 * p[1];
  const auto f = [](const Position<3>& p) { return 1 + p[0] * p[1] - p[1] * p[1]; };
  const MovingLeastSquares<3> plane(flat, test::sampled<3>(flat, f));
  const Position<3> q{0.4, 0.6, 0.32};
  EXPECT_NEAR(evaluated<3>(plane, {q})[0], f(q), 1e-9);
}

TEST(MovingLeastSquares, ManySamplesOfVaryingDensity) {
  auto x = test::random_positions<3>(100000, 81);
  for (auto& p : x) p[0] = p[0] * p[0] * p[0];
  const MovingLeastSquares<3> mls(x, test::sampled<3>(x, smooth<3>));
  const auto points = test::random_positions<3>(3000, 82, 0.1, 0.9);
  const auto values = evaluated<3>(mls, points);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_NEAR(values[i], smooth<3>(points[i]), 0.01);
}

TEST(MovingLeastSquares, DoesNotDependOnThreads) {
  const auto x = test::random_positions<3>(2000, 83);
  const auto f = test::sampled<3>(x, smooth<3>);
  const auto points = test::random_positions<3>(500, 84);
  test::expect_equal_for_any_threads([&] { return evaluated<3>(MovingLeastSquares<3>(x, f), points); });
}

TEST(MovingLeastSquares, BadInput) {
  const auto x = test::random_positions<2>(30, 1);
  std::vector<double> f(30, 1.0);
  using Mls = MovingLeastSquares<2>;
  EXPECT_THROW(Mls(x, f, {.degree = 9}), ArgumentError);
  EXPECT_THROW(Mls(x, f, {.degree = -1}), ArgumentError);
  EXPECT_THROW(Mls(x, f, {.radius = 0}), ArgumentError);
  EXPECT_THROW(Mls(x, f, {.neighbours = 0}), ArgumentError);
  EXPECT_THROW(Mls(x, f, {.rank_tolerance = 2}), ArgumentError);
  EXPECT_THROW(Mls(x, std::vector<double>(29)), ArgumentError);
  EXPECT_THROW(Mls({}, {}), DataError);
  const Mls good(x, f);
  std::vector<double> room(2);
  EXPECT_THROW(good.evaluate(x, room), ArgumentError);
  room.resize(1);
  good.evaluate(std::vector<Position<2>>{{std::numeric_limits<double>::quiet_NaN(), 0}}, room);
  EXPECT_TRUE(std::isnan(room[0]));
  f[3] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Mls(x, f), DataError);
}

}  // namespace
}  // namespace sansmesh::inline v1
