#include "sansmesh/approximation/orthogonal_polynomials.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

template <int D>
struct Cloud {
  std::array<std::vector<double>, D> x;
  std::vector<double> f, w;
  std::size_t size() const { return f.size(); }
  ApproximationSamples<D> view() const {
    ApproximationSamples<D> samples;
    for (std::size_t k = 0; k < D; ++k) samples.positions[k] = x[k];
    samples.values = f;
    samples.weights = w;
    return samples;
  }
  std::array<double, D> point(std::size_t i) const {
    std::array<double, D> p;
    for (std::size_t k = 0; k < D; ++k) p[k] = x[k][i];
    return p;
  }
  void add(const std::array<double, D>& p, double value) {
    for (std::size_t k = 0; k < D; ++k) x[k].push_back(p[k]);
    f.push_back(value);
  }
};

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

// Off-centre, anisotropic samples with values of a smooth function.
template <int D>
Cloud<D> random_cloud(std::size_t n, bool weighted, unsigned seed) {
  std::mt19937 random(seed);
  Cloud<D> cloud;
  for (std::size_t i = 0; i < n; ++i) {
    std::array<double, D> p;
    double s = 0.3;
    for (std::size_t k = 0; k < D; ++k) {
      p[k] = 5.0 + static_cast<double>(k) + uniform(random, -2, 2) / (1 + static_cast<double>(k));
      s += (1.0 + static_cast<double>(k)) * p[k];
    }
    cloud.add(p, std::sin(s) + 0.1 * uniform(random, -1, 1));
    if (weighted) cloud.w.push_back(uniform(random, 0, 2));
  }
  return cloud;
}

template <int D>
double monomial(int j, const std::array<double, D>& u) {
  double t = 1;
  for (std::size_t k = 0; k < D; ++k) t *= std::pow(u[k], PolynomialOrder<D>::get()[j].exponent[k]);
  return t;
}

template <int D>
std::array<double, D> local(const ApproximationFrame<D>& frame, std::array<double, D> x) {
  for (std::size_t k = 0; k < D; ++k) x[k] = (x[k] - frame.center[k]) / frame.scale;
  return x;
}

// Weighted inner products of the functions ψ_j, evaluated again at the samples.
template <int D>
Eigen::MatrixXd basis_matrix(const OrthogonalFit<D>& fit, const Cloud<D>& cloud) {
  Eigen::MatrixXd m(cloud.size(), fit.size());
  std::vector<double> values(static_cast<std::size_t>(fit.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    fit.basis(cloud.point(i), values);
    const double root = cloud.w.empty() ? 1 : std::sqrt(cloud.w[i]);
    for (int j = 0; j < fit.size(); ++j)
      m(static_cast<Eigen::Index>(i), j) = root * values[static_cast<std::size_t>(j)];
  }
  return m;
}

// Slow reference: QR of the weighted monomials, with the minimum norm where they are dependent.
template <int D>
Eigen::VectorXd reference_residual(const Cloud<D>& cloud, const ApproximationFrame<D>& frame, int degree,
                                   Eigen::VectorXd* coefficients = nullptr) {
  const auto n = static_cast<Eigen::Index>(cloud.size());
  Eigen::MatrixXd a(n, monomial_count(D, degree));
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto s = static_cast<std::size_t>(i);
    const double root = cloud.w.empty() ? 1 : std::sqrt(cloud.w[s]);
    for (Eigen::Index j = 0; j < a.cols(); ++j)
      a(i, j) = root * monomial<D>(static_cast<int>(j), local<D>(frame, cloud.point(s)));
    b[i] = root * cloud.f[s];
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-9);
  qr.compute(a);
  const Eigen::VectorXd x = qr.solve(b);
  if (coefficients) *coefficients = x;
  return b - a * x;
}

template <int D>
void check_against_qr(std::size_t n, bool weighted, int degree, unsigned seed) {
  SCOPED_TRACE(testing::Message() << D << "D n=" << n << " weighted=" << weighted << " degree=" << degree);
  const Cloud<D> cloud = random_cloud<D>(n, weighted, seed);
  OrthogonalFit<D> fit;
  fit.reset(cloud.view());
  for (int d = 0; d <= degree; ++d) ASSERT_TRUE(fit.raise());
  ASSERT_EQ(fit.degree(), degree);
  ASSERT_TRUE(fit.dropped().empty());

  const Eigen::MatrixXd basis = basis_matrix<D>(fit, cloud);
  const Eigen::MatrixXd gram = basis.transpose() * basis;
  for (int j = 0; j < fit.size(); ++j) {
    EXPECT_NEAR(gram(j, j) / fit.squared_norm(j), 1, 1e-10);
    for (int l = 0; l < j; ++l) EXPECT_LT(std::abs(gram(j, l)) / std::sqrt(gram(j, j) * gram(l, l)), 1e-10);
  }

  Eigen::VectorXd x;
  const Eigen::VectorXd r = reference_residual<D>(cloud, fit.frame(), degree, &x);
  EXPECT_NEAR(fit.squared_error(), r.squaredNorm(), 1e-10 * (1 + r.squaredNorm()));
  for (Eigen::Index i = 0; i < r.size(); ++i)
    EXPECT_NEAR(fit.weighted_residuals()[static_cast<std::size_t>(i)], r[i], 1e-8);
  std::vector<double> a(static_cast<std::size_t>(fit.size()) + 2, -1.0);
  fit.monomial_coefficients(a);
  for (Eigen::Index j = 0; j < x.size(); ++j)
    EXPECT_NEAR(a[static_cast<std::size_t>(j)], x[j], 1e-7 * (1 + x.cwiseAbs().maxCoeff()));
  EXPECT_EQ(a.back(), 0);

  // The recurrence, the monomials and finite differences agree between the samples.
  std::mt19937 random(seed);
  for (int trial = 0; trial < 20; ++trial) {
    std::array<double, D> p;
    for (std::size_t k = 0; k < D; ++k) p[k] = fit.frame().center[k] + fit.frame().scale * uniform(random, -0.8, 0.8);
    double sum = 0;
    for (int j = 0; j < fit.size(); ++j)
      sum += a[static_cast<std::size_t>(j)] * monomial<D>(j, local<D>(fit.frame(), p));
    const auto [value, gradient] = fit.value_and_gradient(p);
    EXPECT_NEAR(value, sum, 1e-8);
    EXPECT_DOUBLE_EQ(fit.value(p), value);
    for (std::size_t k = 0; k < D; ++k) {
      const double h = 1e-5;
      auto ahead = p, behind = p;
      ahead[k] += h, behind[k] -= h;
      EXPECT_NEAR(gradient[k], (fit.value(ahead) - fit.value(behind)) / (2 * h), 1e-5);
    }
  }
}

TEST(OrthogonalFit, IsOrthogonalAndEqualsQr) {
  unsigned seed = 1;
  for (const bool weighted : {false, true})
    for (int degree = 0; degree <= 4; ++degree) {
      check_against_qr<1>(40, weighted, degree, ++seed);
      check_against_qr<2>(60, weighted, degree, ++seed);
      check_against_qr<2>(333, weighted, degree, ++seed);
      check_against_qr<3>(400, weighted, degree, ++seed);
    }
  check_against_qr<2>(900, true, 8, ++seed);
  check_against_qr<3>(900, true, 6, ++seed);
}

// On nearly collinear samples the remainder of a row after subtraction is mostly rounding, unless it is orthogonalised
// again.
TEST(OrthogonalFit, StaysOrthogonalOnThinSets) {
  for (const double width : {1e-2, 1e-3, 1e-4, 1e-5}) {
    std::mt19937 random(21);
    Cloud<2> cloud;
    for (int i = 0; i < 300; ++i) {
      const double t = uniform(random, -1, 1);
      cloud.add({t, t * 0.7 + width * uniform(random, -1, 1)}, std::cos(3 * t));
    }
    OrthogonalFit<2> fit;
    fit.reset(cloud.view());
    for (int d = 0; d <= 4; ++d) fit.raise();
    EXPECT_EQ(fit.rank(), 15);
    const Eigen::MatrixXd m = basis_matrix<2>(fit, cloud);
    double worst = 0;
    for (int j = 0; j < fit.size(); ++j)
      for (int l = 0; l < j; ++l)
        worst = std::max(worst, std::abs(m.col(j).dot(m.col(l))) / (m.col(j).norm() * m.col(l).norm()));
    EXPECT_LT(worst, 1e-10);
  }
}

template <int D>
void check_reproduction(bool weighted) {
  for (int degree = 0; degree <= 5; ++degree) {
    Cloud<D> cloud = random_cloud<D>(200, weighted, 77 + static_cast<unsigned>(degree));
    for (int j = 0; j < monomial_count(D, degree); ++j) {
      const ApproximationFrame<D> frame{cloud.point(0), 1.5};
      for (std::size_t i = 0; i < cloud.size(); ++i) cloud.f[i] = monomial<D>(j, local<D>(frame, cloud.point(i)));
      OrthogonalFit<D> fit;
      fit.reset(cloud.view());
      for (int d = 0; d <= degree; ++d) fit.raise();
      EXPECT_LT(fit.squared_error(), 1e-20 * static_cast<double>(cloud.size()));
      std::array<double, D> p = fit.frame().center;
      p[0] += 0.1;
      EXPECT_NEAR(fit.value(p), monomial<D>(j, local<D>(frame, p)), 1e-9);
    }
  }
}

TEST(OrthogonalFit, ReproducesEveryPolynomialOfItsDegree) {
  for (const bool weighted : {false, true}) {
    check_reproduction<1>(weighted);
    check_reproduction<2>(weighted);
    check_reproduction<3>(weighted);
  }
}

TEST(OrthogonalFit, RaisingTheDegreeEqualsFittingAfresh) {
  const Cloud<3> cloud = random_cloud<3>(150, true, 5);
  OrthogonalFit<3> grown;
  grown.reset(cloud.view());
  double before = std::numeric_limits<double>::infinity();
  for (int degree = 0; degree <= 4; ++degree) {
    ASSERT_TRUE(grown.raise());
    EXPECT_LE(grown.squared_error(), before);
    before = grown.squared_error();
    OrthogonalFit<3> fresh;
    fresh.reset(random_cloud<3>(40, false, 6).view());  // earlier content must not matter
    while (fresh.degree() < 2) fresh.raise();
    fresh.reset(cloud.view());
    while (fresh.size() < monomial_count(3, degree)) fresh.add_polynomial();
    ASSERT_EQ(fresh.size(), grown.size());
    EXPECT_EQ(fresh.degree(), degree);
    EXPECT_EQ(fresh.squared_error(), grown.squared_error());
    for (int j = 0; j < fresh.size(); ++j) {
      EXPECT_EQ(fresh.coefficient(j), grown.coefficient(j));
      EXPECT_EQ(fresh.squared_norm(j), grown.squared_norm(j));
    }
  }
}

template <int D>
void check_savings(bool weighted) {
  const Cloud<D> cloud = random_cloud<D>(500, weighted, 9);
  OrthogonalFit<D> fit;
  fit.reset(cloud.view());
  while (fit.degree() < 5) ASSERT_TRUE(fit.raise());
  const Eigen::MatrixXd basis = basis_matrix<D>(fit, cloud);
  for (int j = 1; j < fit.size(); ++j) {
    const auto& step = PolynomialOrder<D>::get()[j];
    Eigen::VectorXd product = basis.col(step.predecessor);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      product[static_cast<Eigen::Index>(i)] *=
          local<D>(fit.frame(), cloud.point(i))[static_cast<std::size_t>(step.variable)];
    for (int l = 0; l < j; ++l) {
      const double alpha = product.dot(basis.col(l)) / basis.col(l).squaredNorm();
      const double unit = std::sqrt(product.squaredNorm() / basis.col(l).squaredNorm());
      EXPECT_NEAR(fit.alpha(j, l), alpha, 1e-10 * unit) << j << ' ' << l;
      if (l < step.first) {
        EXPECT_EQ(fit.alpha(j, l), 0);
      }
    }
  }
}

TEST(OrthogonalFit, SkippedProductsVanishAndReusedOnesAgree) {
  for (const bool weighted : {false, true}) {
    check_savings<1>(weighted);
    check_savings<2>(weighted);
    check_savings<3>(weighted);
  }
}

// Samples that do not separate all polynomials: the result is finite and still the least-squares solution.
template <int D>
void check_deficient(const Cloud<D>& cloud, int degree, int expected_rank) {
  OrthogonalFit<D> fit;
  fit.reset(cloud.view());
  while (fit.size() < monomial_count(D, degree)) fit.add_polynomial();
  EXPECT_EQ(fit.degree(), degree);
  EXPECT_EQ(fit.rank(), expected_rank);
  EXPECT_EQ(static_cast<int>(fit.dropped().size()), fit.size() - expected_rank);
  for (const int j : fit.dropped()) {
    EXPECT_TRUE(fit.is_dropped(j));
    EXPECT_EQ(fit.coefficient(j), 0);
  }
  const Eigen::VectorXd r = reference_residual<D>(cloud, fit.frame(), degree);
  double scale = 1;
  for (const double f : cloud.f) scale = std::max(scale, std::abs(f));
  EXPECT_NEAR(fit.squared_error(), r.squaredNorm(), 1e-8 * scale * scale);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto [value, gradient] = fit.value_and_gradient(cloud.point(i));
    EXPECT_TRUE(std::isfinite(value));
    for (const double g : gradient) EXPECT_TRUE(std::isfinite(g));
    const double root = cloud.w.empty() ? 1 : std::sqrt(cloud.w[i]);
    EXPECT_NEAR(root * (cloud.f[i] - value), r[static_cast<Eigen::Index>(i)], 1e-6 * scale);
  }
}

TEST(OrthogonalFit, DropsWhatCollinearSamplesCannotDetermine) {
  std::mt19937 random(3);
  for (const auto& direction :
       {std::array{1.0, 0.0}, std::array{0.0, 1.0}, std::array{1.0, -2.0}, std::array{1e-3, 1.0}}) {
    Cloud<2> cloud;
    for (int i = 0; i < 50; ++i) {
      const double t = uniform(random, -1, 1);
      cloud.add({3 + t * direction[0], 7 + t * direction[1]}, std::cos(3 * t));
    }
    for (int degree = 1; degree <= 4; ++degree) check_deficient<2>(cloud, degree, degree + 1);
  }
}

TEST(OrthogonalFit, DropsWhatCoplanarSamplesCannotDetermine) {
  std::mt19937 random(4);
  const std::array<double, 3> normals[] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {1, 2, -1}};
  for (const auto& n : normals) {
    Cloud<3> cloud;
    for (int i = 0; i < 200; ++i) {
      std::array<double, 3> p{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
      const double off = (p[0] * n[0] + p[1] * n[1] + p[2] * n[2]) / (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (std::size_t k = 0; k < 3; ++k) p[k] -= off * n[k];
      cloud.add(p, std::cos(2 * p[0]) + p[1] * p[2]);
    }
    for (int degree = 1; degree <= 4; ++degree) check_deficient<3>(cloud, degree, monomial_count(2, degree));
  }
}

TEST(OrthogonalFit, DropsWhatTooFewOrCoincidentSamplesCannotDetermine) {
  for (std::size_t n = 1; n <= 8; ++n) {
    Cloud<2> cloud = random_cloud<2>(n, n % 2 == 0, 40 + static_cast<unsigned>(n));
    check_deficient<2>(cloud, 4, static_cast<int>(n));
    Cloud<2> twice = cloud;
    for (std::size_t i = 0; i < n; ++i) {
      twice.add(cloud.point(i), cloud.f[i] + 0.5);
      if (!cloud.w.empty()) twice.w.push_back(1);
    }
    check_deficient<2>(twice, 4, static_cast<int>(n));
    const Cloud<3> space = random_cloud<3>(n, false, 60 + static_cast<unsigned>(n));
    check_deficient<3>(space, 2, static_cast<int>(n));
  }
  Cloud<2> same;
  for (int i = 0; i < 30; ++i) same.add({2, -1}, i);
  check_deficient<2>(same, 3, 1);
  OrthogonalFit<2> fit;
  fit.reset(same.view());
  EXPECT_TRUE(fit.raise());
  EXPECT_FALSE(fit.raise());
  EXPECT_DOUBLE_EQ(fit.value({9, 9}), 14.5);
}

TEST(OrthogonalFit, NoSamplesOrNoWeightGiveZero) {
  OrthogonalFit<2> fit;
  fit.reset({});
  EXPECT_FALSE(fit.raise());
  EXPECT_EQ(fit.rank(), 0);
  EXPECT_EQ(fit.value({1, 2}), 0);
  Cloud<2> cloud = random_cloud<2>(20, true, 1);
  std::fill(cloud.w.begin(), cloud.w.end(), 0.0);
  fit.reset(cloud.view());
  EXPECT_FALSE(fit.raise());
  EXPECT_FALSE(fit.raise());
  EXPECT_EQ(fit.value({5, 6}), 0);
  EXPECT_EQ(fit.squared_error(), 0);
}

TEST(OrthogonalFit, ZeroWeightMeansAbsent) {
  Cloud<2> cloud = random_cloud<2>(80, true, 12), fewer;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i % 3 == 0) {
      cloud.w[i] = 0;
    } else {
      fewer.add(cloud.point(i), cloud.f[i]);
      fewer.w.push_back(cloud.w[i]);
    }
  }
  const ApproximationFrame<2> frame{{5, 6}, 2};
  OrthogonalFit<2> a, b;
  a.reset(cloud.view(), frame);
  b.reset(fewer.view(), frame);
  for (int d = 0; d <= 4; ++d) a.raise(), b.raise();
  EXPECT_NEAR(a.squared_error(), b.squared_error(), 1e-12);
  EXPECT_NEAR(a.value({5.1, 6.2}), b.value({5.1, 6.2}), 1e-10);
}

TEST(OrthogonalFit, StopsAtItsHighestDegree) {
  OrthogonalFit<2> fit;
  const Cloud<2> cloud = random_cloud<2>(400, false, 8);
  fit.reset(cloud.view());
  while (fit.raise()) {
  }
  EXPECT_EQ(fit.degree(), OrthogonalFit<2>::kMaxDegree);
  EXPECT_FALSE(fit.add_polynomial());
  EXPECT_EQ(fit.size(), PolynomialOrder<2>::kSize);
}

TEST(OrthogonalFit, SurvivesExtremeScales) {
  for (const double scale : {1e-150, 1e-12, 1e12, 1e150}) {
    Cloud<2> cloud = random_cloud<2>(100, false, 15);
    OrthogonalFit<2> unit, scaled;
    unit.reset(cloud.view());
    for (auto& x : cloud.x)
      for (double& v : x) v *= scale;
    scaled.reset(cloud.view());
    for (int d = 0; d <= 4; ++d) unit.raise(), scaled.raise();
    EXPECT_TRUE(scaled.dropped().empty());
    EXPECT_NEAR(scaled.squared_error(), unit.squared_error(), 1e-9);
  }
}

TEST(OrthogonalFit, RefusesBadInput) {
  EXPECT_THROW(OrthogonalFit<2>({.rank_tolerance = 0}), ArgumentError);
  EXPECT_THROW(OrthogonalFit<2>({.rank_tolerance = 1}), ArgumentError);
  OrthogonalFit<2> fit;
  const Cloud<2> good = random_cloud<2>(10, true, 1);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  Cloud<2> bad = good;
  bad.x[1].pop_back();
  EXPECT_THROW(fit.reset(bad.view()), ArgumentError);
  bad = good, bad.w.pop_back();
  EXPECT_THROW(fit.reset(bad.view()), ArgumentError);
  bad = good, bad.w[3] = -1;
  EXPECT_THROW(fit.reset(bad.view()), ArgumentError);
  bad = good, bad.w[3] = nan;
  EXPECT_THROW(fit.reset(bad.view()), ArgumentError);
  bad = good, bad.f[3] = inf;
  EXPECT_THROW(fit.reset(bad.view()), ArgumentError);
  bad = good, bad.x[0][9] = nan;
  EXPECT_THROW(fit.reset(bad.view()), ArgumentError);
  EXPECT_THROW(fit.reset(good.view(), ApproximationFrame<2>{{0, 0}, 0}), ArgumentError);
  fit.reset(good.view());
  fit.raise(), fit.raise();
  std::vector<double> small(2);
  EXPECT_THROW(fit.monomial_coefficients(small), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
