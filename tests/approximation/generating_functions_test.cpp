#include "sansmesh/approximation/generating_functions.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>

#include "approximation/approximation_samples.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr RadialFunction kAllKernels[] = {RadialFunction::kThinPlate,           RadialFunction::kBiharmonic,
                                          RadialFunction::kTriharmonic,         RadialFunction::kMultiquadric,
                                          RadialFunction::kInverseMultiquadric, RadialFunction::kGaussian,
                                          RadialFunction::kWendlandC2,          RadialFunction::kWendlandC4};
constexpr WeightFunction kWeights[] = {WeightFunction::kCompact, WeightFunction::kWendland, WeightFunction::kGaussian};

TEST(RadialKernel, ValueAndSlopeAgree) {
  for (const RadialFunction function : kAllKernels) {
    const RadialKernel kernel(function, 1.7);
    for (const double r : {0.05, 0.3, 1.0, 1.5, 1.69, 1.8, 4.0}) {
      SCOPED_TRACE(testing::Message() << name_of(function) << " at " << r);
      const double h = 1e-5;
      const double slope = (kernel((r + h) * (r + h)) - kernel((r - h) * (r - h))) / (2 * h) / r;
      EXPECT_NEAR(kernel.with_slope(r * r).slope, slope, 1e-6 * (1 + std::abs(slope)));
      EXPECT_DOUBLE_EQ(kernel.with_slope(r * r).value, kernel(r * r));
    }
    EXPECT_TRUE(std::isfinite(kernel(0)) && std::isfinite(kernel.with_slope(0).slope));
  }
  for (const WeightFunction function : kWeights) {
    for (const double r : {0.05, 0.6, 1.2, 1.99}) {
      const double h = 1e-5;
      const double slope =
          (weight(function, (r + h) * (r + h), 2).value - weight(function, (r - h) * (r - h), 2).value) / (2 * h) / r;
      EXPECT_NEAR(weight(function, r * r, 2).slope, slope, 1e-6);
    }
    EXPECT_EQ(weight(function, 4, 2).value, 0);
    EXPECT_NEAR(weight(function, 3.999999999, 2).value, 0, 1e-9);
    EXPECT_NEAR(weight(function, 0, 2).value, 1, 2e-4);
  }
  EXPECT_THROW(RadialKernel(RadialFunction::kGaussian, 0), ArgumentError);
}

// cᵀ A c > 0 for all c that are orthogonal to the polynomials of degree < order().
TEST(RadialKernel, IsPositiveDefiniteUpToItsOrder) {
  const auto x = test::random_positions<3>(60, 3);
  for (const RadialFunction function : kAllKernels) {
    const RadialKernel kernel(function, 0.6);
    const auto n = static_cast<Eigen::Index>(x.size());
    Eigen::MatrixXd a(n, n), p(n, kernel.order() == 0 ? 0 : kernel.order() == 1 ? 1 : 4);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& xi = x[static_cast<std::size_t>(i)];
      for (Eigen::Index j = 0; j < n; ++j) a(i, j) = kernel(squared_distance<3>(xi, x[static_cast<std::size_t>(j)]));
      for (Eigen::Index j = 0; j < p.cols(); ++j) p(i, j) = j == 0 ? 1 : xi[static_cast<std::size_t>(j - 1)];
    }
    const Eigen::MatrixXd q = p.cols() == 0 ? Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n))
                                            : Eigen::MatrixXd(Eigen::HouseholderQR<Eigen::MatrixXd>(p).householderQ());
    const Eigen::MatrixXd z = q.rightCols(n - p.cols());
    const Eigen::VectorXd eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(z.transpose() * a * z).eigenvalues();
    EXPECT_GT(eigenvalues[0], 0) << name_of(function);
  }
}

// ∫ φ = h^s; the moments of degree 2 … 2d + 1 vanish (radially: r^2 and r^4), that of degree 2d + 2 does not.
TEST(LaguerreGaussian, HasTheMomentsOfADelta) {
  for (int s = 1; s <= 3; ++s)
    for (const int order : {2, 4, 6}) {
      const double h = 0.7;
      const LaguerreGaussian phi(s, order, 0.8, h);
      const double sphere = s == 1 ? 2 : s == 2 ? 2 * std::numbers::pi : 4 * std::numbers::pi;
      const auto moment = [&](int m) {
        double sum = 0;
        const double dr = 1e-3;
        for (double r = dr / 2; r < 12; r += dr) sum += phi(r * r) * std::pow(r, s - 1 + m) * dr;
        return sphere * sum / std::pow(h, s);
      };
      SCOPED_TRACE(testing::Message() << s << " variables, order " << order);
      EXPECT_NEAR(moment(0), 1, 1e-5);
      for (int m = 2; m < order; m += 2) EXPECT_NEAR(moment(m), 0, 1e-5);
      EXPECT_GT(std::abs(moment(order)), 0.05);
      for (const double r : {0.1, 0.5, 1.3, 2.5}) {
        const double e = 1e-5;
        EXPECT_NEAR(phi.with_slope(r * r).slope, (phi((r + e) * (r + e)) - phi((r - e) * (r - e))) / (2 * e) / r, 1e-7);
      }
      for (const double fraction : {1e-2, 1e-5, 1e-12}) {
        const double cut = phi.cutoff(fraction);
        EXPECT_NEAR(std::abs(phi(cut * cut)), fraction * phi(0), 1e-6 * fraction * phi(0));
        for (double r = cut; r < 3 * cut; r += 0.01) EXPECT_LE(std::abs(phi(r * r)), fraction * phi(0) * (1 + 1e-9));
      }
    }
  EXPECT_THROW(LaguerreGaussian(3, 3, 1, 1), ArgumentError);
  EXPECT_THROW(LaguerreGaussian(4, 2, 1, 1), ArgumentError);
  EXPECT_THROW(LaguerreGaussian(3, 2, -1, 1), ArgumentError);
  EXPECT_THROW(LaguerreGaussian(3, 2, 1, 0), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
