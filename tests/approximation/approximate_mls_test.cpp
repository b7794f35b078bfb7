#include "sansmesh/approximation/approximate_mls.h"
#include "sansmesh/approximation/approximate_mls_choice.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "approximation/approximation_samples.h"
#include "sansmesh/error.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using test::smooth;

template <int D>
std::vector<double> evaluated(const ApproximateMls<D>& mls, const std::vector<Position<D>>& x) {
  std::vector<double> values(x.size() * mls.components());
  mls.evaluate(x, values);
  return values;
}

// Largest error on a grid on [0, 1]^D, far from the boundary.
template <int D>
double interior_error(int order, std::size_t n, double shape) {
  const double h = 1.0 / static_cast<double>(n);
  // The grid continues around the box, so that its boundary has no effect.
  const auto margin = static_cast<std::size_t>(D == 3 ? 9 : 12);
  const auto x = test::grid<D>(n + 2 * margin + 1, -h * static_cast<double>(margin), h);
  ApproximateMlsOptions options;
  options.order = order;
  options.shape = shape;
  options.iterations = 0;
  options.normalisation = Normalisation::kNone;
  options.cutoff = 1e-12;
  const ApproximateMls<D> mls(x, test::sampled<D>(x, smooth<D>), options);
  const auto points = test::random_positions<D>(200, 9);
  const auto values = evaluated<D>(mls, points);
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) worst = std::max(worst, std::abs(values[i] - smooth<D>(points[i])));
  return worst;
}

TEST(ApproximateMls, ConvergesWithItsOrderOnRegularSamples) {
  for (const int order : {2, 4, 6}) {
    const double in_1d = std::log2(interior_error<1>(order, 12, 0.35) / interior_error<1>(order, 24, 0.35));
    EXPECT_NEAR(in_1d, order, 0.35);
    const double in_2d = std::log2(interior_error<2>(order, 16, 0.35) / interior_error<2>(order, 32, 0.35));
    EXPECT_NEAR(in_2d, order, 0.35);
    const double in_3d = std::log2(interior_error<3>(order, 6, 0.5) / interior_error<3>(order, 12, 0.5));
    EXPECT_NEAR(in_3d, order, 0.5);
    RecordProperty("order" + std::to_string(order),
                   std::to_string(in_1d) + " " + std::to_string(in_2d) + " " + std::to_string(in_3d));
  }
}

// Dense K of the φ_j, computed by the formula.
template <int D>
Eigen::MatrixXd dense(const std::vector<Position<D>>& a, const std::vector<Position<D>>& b, int order, double shape,
                      double h) {
  const LaguerreGaussian phi(D, order, shape, h);
  Eigen::MatrixXd k(static_cast<Eigen::Index>(a.size()), static_cast<Eigen::Index>(b.size()));
  for (Eigen::Index i = 0; i < k.rows(); ++i)
    for (Eigen::Index j = 0; j < k.cols(); ++j)
      k(i, j) = phi(squared_distance<D>(a[static_cast<std::size_t>(i)], b[static_cast<std::size_t>(j)]));
  return k;
}

Eigen::MatrixXd divided(Eigen::MatrixXd m, const Eigen::MatrixXd& gaussians) {
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    m.row(i) /= std::max(gaussians.row(i).sum(), 0.55 * m.row(i).cwiseAbs().sum());
  return m;
}

// Irregular samples, some of double density.
template <int D>
void check_limit(int order, Normalisation normalisation, const std::vector<Position<D>>& x, double shape,
                 int iterations) {
  SCOPED_TRACE(testing::Message() << D << " variables, order " << order << ", normalisation "
                                  << static_cast<int>(normalisation));
  ApproximateMlsOptions options;
  options.order = order;
  options.shape = shape;
  options.iterations = iterations;
  options.normalisation = normalisation;
  options.cutoff = 1e-16;
  const auto f = test::sampled<D>(x, smooth<D>);
  const ApproximateMls<D> mls(x, f, options);
  ASSERT_LT(mls.residuals().back(), 1e-9);
  const auto points = test::random_positions<D>(100, 8);
  const auto values = evaluated<D>(mls, points);
  const Eigen::Map<const Eigen::VectorXd> rhs(f.data(), static_cast<Eigen::Index>(f.size()));
  const Eigen::MatrixXd k = dense<D>(x, x, order, shape, mls.spacing());
  const Eigen::MatrixXd at = dense<D>(points, x, order, shape, mls.spacing());
  Eigen::VectorXd interpolant;
  if (normalisation == Normalisation::kPartition) {
    // Interpolant of the divided functions.
    const double h = mls.spacing();
    interpolant = divided(at, dense<D>(points, x, 2, shape, h)) *
                  divided(k, dense<D>(x, x, 2, shape, h)).partialPivLu().solve(rhs);
  } else {
    interpolant = at * k.llt().solve(rhs);
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_NEAR(values[i], interpolant[static_cast<Eigen::Index>(i)], 1e-8);
}

TEST(ApproximateMls, IterationTendsToTheInterpolant) {
  auto irregular = test::grid<2>(11, 0, 0.1);
  std::mt19937 random(4);
  for (auto& p : irregular)
    for (double& v : p) v += test::uniform(random, -0.02, 0.02);
  const auto dense_half = test::grid<1>(30, 0, 1.0 / 60);
  auto graded = test::grid<1>(16, 0.53, 1.0 / 32);
  graded.insert(graded.end(), dense_half.begin(), dense_half.end());
  const auto cube = test::grid<3>(7, 0, 1.0 / 6);
  for (const int order : {2, 4, 6}) {
    check_limit<3>(order, Normalisation::kNone, cube, order == 2 ? 3 : order == 4 ? 2 : 1.6, 300);
    for (const auto normalisation : {Normalisation::kSamples, Normalisation::kPartition}) {
      check_limit<2>(order, normalisation, irregular, 5, 3000);
      check_limit<1>(order, normalisation, graded, 6, 6000);
    }
  }
}

TEST(ApproximateMls, PrecomputedCoefficientsAreTheIteration) {
  const auto x = test::random_positions<2>(150, 12);
  const auto f = test::sampled<2>(x, smooth<2>);
  const int order = 4;
  const double shape = 1.2;
  for (const int n : {0, 1, 5}) {
    ApproximateMlsOptions options;
    options.order = order, options.shape = shape, options.iterations = n, options.cutoff = 1e-15;
    const ApproximateMls<2> mls(x, f, options);
    const Eigen::MatrixXd a =
        divided(dense<2>(x, x, order, shape, mls.spacing()), dense<2>(x, x, 2, shape, mls.spacing()));
    const Eigen::Map<const Eigen::VectorXd> rhs(f.data(), static_cast<Eigen::Index>(f.size()));
    // The definition (fasshauer2007): the approximation of the residual is added n times.
    Eigen::VectorXd m = a * rhs;
    for (int i = 0; i < n; ++i) m += a * (rhs - m);
    const auto values = evaluated<2>(mls, x);
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(values[i], m[static_cast<Eigen::Index>(i)], 1e-11);
    ASSERT_EQ(mls.residuals().size(), static_cast<std::size_t>(n == 0 ? 0 : n + 1));
    if (n > 0) {
      EXPECT_NEAR(mls.residuals().back(), (rhs - m).norm() / std::sqrt(150.0), 1e-11);
    }
  }
}

template <int D>
void check_gradients() {
  const auto x = test::random_positions<D>(D == 1 ? 40 : 300, 21);
  std::vector<double> f;
  for (const auto& p : x) f.push_back(smooth<D>(p)), f.push_back(p[0] - 3);
  for (const auto normalisation : {Normalisation::kNone, Normalisation::kSamples, Normalisation::kPartition})
    for (const int order : {2, 4, 6}) {
      ApproximateMlsOptions options;
      options.order = order;
      options.normalisation = normalisation;
      options.iterations = 2;
      options.cutoff = 1e-13;  // differences must not see the ends of supports
      const ApproximateMls<D> mls(x, f, options);
      ASSERT_EQ(mls.components(), 2u);
      const auto points = test::random_positions<D>(20, 22, 0.05, 0.95);
      std::vector<double> values(2 * points.size()), gradients(2 * D * points.size());
      mls.evaluate(points, values, gradients);
      EXPECT_TRUE(values == evaluated<D>(mls, points));
      for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t m = 0; m < 2; ++m)
          for (std::size_t k = 0; k < D; ++k) {
            const auto value = [&](const Position<D>& p) { return evaluated<D>(mls, {p})[m]; };
            const double slope = test::difference<D>(value, points[i], k, 1e-6);
            ASSERT_NEAR(gradients[(i * 2 + m) * D + k], slope, 1e-5 * (1 + std::abs(slope)));
          }
    }
}

TEST(ApproximateMls, GradientsAreDerivatives) {
  check_gradients<1>();
  check_gradients<2>();
  check_gradients<3>();
}

TEST(ApproximateMls, PartitionKeepsConstants) {
  const auto x = test::random_positions<3>(400, 2);
  ApproximateMlsOptions options;
  options.order = 2;
  const ApproximateMls<3> mls(x, std::vector<double>(x.size(), 7.5), options);
  for (const double v : evaluated<3>(mls, test::random_positions<3>(50, 3))) EXPECT_NEAR(v, 7.5, 1e-12);
}

// Leaves out each sample in turn and recomputes everything.
TEST(ApproximateMls, LeavingOneOutIsWhatItSays) {
  const auto x = test::random_positions<2>(160, 31);
  const auto f = test::sampled<2>(x, smooth<2>);
  for (const auto normalisation : {Normalisation::kNone, Normalisation::kSamples, Normalisation::kPartition}) {
    ApproximateMlsOptions options;
    options.order = 2;
    options.normalisation = normalisation;
    options.spacing = SampleIndex<2>(x).spacing();
    ApproximateMlsSearch search;
    search.shapes = {1.5};
    search.max_iterations = 6;
    const auto choice = choose_shape_and_iterations<2>(x, f, options, search);
    for (const int n : {0, 2, 6}) {
      options.shape = 1.5;
      options.iterations = n;
      double sum = 0;
      for (std::size_t k = 0; k < x.size(); ++k) {
        auto others = x;
        auto values = f;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
        values.erase(values.begin() + static_cast<std::ptrdiff_t>(k));
        const double e = evaluated<2>(ApproximateMls<2>(others, values, options), {x[k]})[0] - f[k];
        sum += e * e;
      }
      const double error = std::sqrt(sum / static_cast<double>(x.size()));
      EXPECT_NEAR(choice.errors[0][static_cast<std::size_t>(n)] / error, 1, 2e-2) << n;
    }
  }
}

TEST(ApproximateMls, ChoosesFewIterationsForNoiseAndManyForCleanValues) {
  const auto x = test::random_positions<2>(1200, 41);
  const auto clean = test::sampled<2>(x, smooth<2>);
  auto noisy = clean;
  std::mt19937 random(5);
  for (double& v : noisy) v += test::uniform(random, -0.5, 0.5);
  const auto for_clean = choose_shape_and_iterations<2>(x, clean);
  const auto for_noisy = choose_shape_and_iterations<2>(x, noisy);
  EXPECT_GE(for_clean.iterations, 15);
  EXPECT_LE(for_noisy.iterations, 4);
  EXPECT_LT(for_clean.error, 0.005);
  // No prediction of a noisy value has a smaller error than the noise, whose deviation is 1/√12; a good one has hardly
  // more.
  EXPECT_GT(for_noisy.error, 0.9 / std::sqrt(12.0));
  EXPECT_LT(for_noisy.error, 1.2 / std::sqrt(12.0));
  EXPECT_LE(for_noisy.shape, for_clean.shape);
  // The approximation of the noisy values is nearer to the truth than the samples are.
  ApproximateMlsOptions options;
  options.shape = for_noisy.shape, options.iterations = for_noisy.iterations;
  const auto values = evaluated<2>(ApproximateMls<2>(x, noisy, options), x);
  double error = 0, noise = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    error += (values[i] - clean[i]) * (values[i] - clean[i]);
    noise += (noisy[i] - clean[i]) * (noisy[i] - clean[i]);
  }
  EXPECT_LT(error, 0.2 * noise);
}

TEST(ApproximateMls, ManySamples) {
  const auto x = test::random_positions<3>(100000, 51);
  const auto f = test::sampled<3>(x, smooth<3>);
  ApproximateMlsOptions options;
  options.cutoff = 1e-3, options.shape = 1.5, options.iterations = 8;
  const ApproximateMls<3> mls(x, f, options);
  const auto points = test::random_positions<3>(5000, 52, 0.1, 0.9);
  const auto values = evaluated<3>(mls, points);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(values[i], smooth<3>(points[i]), 0.05);
}

TEST(ApproximateMls, DoesNotDependOnThreads) {
  const auto x = test::random_positions<3>(3000, 61);
  const auto f = test::sampled<3>(x, smooth<3>);
  const auto points = test::random_positions<3>(500, 62);
  ApproximateMlsSearch search;
  search.shapes = {2, 3}, search.max_iterations = 3, search.left_out = 20, search.max_samples = 1000;
  test::expect_equal_for_any_threads([&] { return evaluated<3>(ApproximateMls<3>(x, f), points); });
  test::expect_equal_for_any_threads([&] { return choose_shape_and_iterations<3>(x, f, {}, search).errors; });
}

TEST(ApproximateMls, BadInput) {
  const auto x = test::random_positions<2>(30, 1);
  const std::vector<double> f(30, 1.0);
  const auto with = [&](auto change) {
    ApproximateMlsOptions options;
    change(options);
    return ApproximateMls<2>(x, f, options);
  };
  EXPECT_THROW(with([](auto& o) { o.order = 3; }), ArgumentError);
  EXPECT_THROW(with([](auto& o) { o.shape = 0; }), ArgumentError);
  EXPECT_THROW(with([](auto& o) { o.spacing = -1; }), ArgumentError);
  EXPECT_THROW(with([](auto& o) { o.iterations = -1; }), ArgumentError);
  EXPECT_THROW(with([](auto& o) { o.cutoff = 0; }), ArgumentError);
  EXPECT_THROW(with([](auto& o) { o.max_entries = 100; }), DataError);
  EXPECT_THROW(ApproximateMls<2>({}, {}), DataError);
  EXPECT_THROW(ApproximateMls<2>(x, std::vector<double>(31)), ArgumentError);
  EXPECT_THROW(ApproximateMls<2>(x, {}), ArgumentError);
  auto bad = f;
  bad[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ApproximateMls<2>(x, bad), DataError);
  // Without normalisation a dense cloud diverges and is reported.
  EXPECT_THROW(with([](auto& o) {
                 o.normalisation = Normalisation::kNone;
                 o.spacing = 1;
                 o.iterations = 2000;
               }),
               DataError);
  // Coincident samples, one sample, points far away.
  const std::vector<Position<2>> same(5, {1, 2});
  const ApproximateMls<2> constant(same, std::vector<double>(5, 3.0));
  EXPECT_NEAR(evaluated<2>(constant, {{1, 2}})[0], 3, 1e-12);
  EXPECT_EQ(evaluated<2>(constant, {{1e9, 2}})[0], 0);
  EXPECT_EQ(evaluated<2>(constant, {{std::numeric_limits<double>::infinity(), 2}})[0], 0);
  std::vector<double> room(3);
  EXPECT_THROW(constant.evaluate(same, room), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
