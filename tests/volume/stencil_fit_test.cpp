// Robust fits at a sample (tejada2008, 6.2).
#include "sansmesh/volume/samples/stencil_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace sansmesh::test {
namespace {

struct Stencil {
  std::vector<Vec3> u;
  std::vector<double> f;
  std::vector<bool> other;  ///< true for samples of the second material
};

// A ball of samples around a sample at 0.
Stencil ball(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return 2 * (static_cast<double>(random()) / 4294967296.0) - 1; };
  Stencil s;
  s.u.push_back({});
  while (s.u.size() < count) {
    const double x = uniform(), y = uniform(), z = uniform();
    if (norm(Vec3{x, y, z}) < 1) s.u.push_back(Vec3{x, y, z} * 2.2);
  }
  return s;
}

double plane(const Vec3& u) { return 0.4 * u.x - 0.3 * u.y + 0.2 * u.z; }

double value_of(const StencilFit& fit, const Vec3& u) {
  const auto& order = PolynomialOrder<3>::get();
  const auto c = fit.monomials(0);
  std::vector<double> m{1.0};
  double sum = c[0];
  for (std::size_t j = 1; j < c.size(); ++j) {
    const auto& step = order[static_cast<int>(j)];
    m.push_back(u[static_cast<std::size_t>(step.variable)] * m[static_cast<std::size_t>(step.predecessor)]);
    sum += c[j] * m[j];
  }
  return sum;
}

// Layers of samples across z; the values of those above a height are larger by one.
Stencil layers_with_step(double lowest, double highest, double height) {
  Stencil s;
  s.u.push_back({});
  for (double z = lowest; z <= highest; z += 1)
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y)
        if (x != 0 || y != 0 || z != 0) s.u.push_back({0.8 * x, 0.8 * y, z});
  for (const Vec3& u : s.u) s.f.push_back(0.01 * u.x + (u.z > height ? 1 : 0));
  return s;
}

TEST(StencilFit, AcceptsAStepUnlessOneSideIsASingleLayer) {
  const std::vector<Vec3> tests{{0.4, 0.4, -0.5}};
  StencilFit fit({});
  // The sample and another layer are on one side: the slope across is determined.
  Stencil two = layers_with_step(-2, 1, -0.5);
  for (double& f : two.f) f -= 1;
  fit.fit(two.u, two.f, 1, tests);
  EXPECT_TRUE(fit.split());
  EXPECT_NEAR(value_of(fit, {0, 0, -1}), 0, 1e-9);
  // Only the uppermost layer is on this side: the slope to the next one is undetermined.
  Stencil one = layers_with_step(-2, 0, -0.5);
  for (double& f : one.f) f -= 1;
  fit.fit(one.u, one.f, 1, tests);
  EXPECT_FALSE(fit.split());
  EXPECT_LT(value_of(fit, {0, 0, -1}), -0.5);
}

// Two other materials, each beyond its own plane: no gap of the values stands out.
TEST(StencilFit, KeepsToItsMaterialBesideTwoOthers) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Stencil s = ball(90, seed);
    std::mt19937 random(seed);
    for (const Vec3& u : s.u) {
      const double noise = 0.004 * (static_cast<double>(random()) / 4294967296.0 - 0.5);
      s.other.push_back(u.x > 1.5 || u.y < -1.6);
      s.f.push_back(u.x > 1.5 ? 3.5 : u.y < -1.6 ? -3 : plane(u) + noise);
    }
    const double own = s.f[0];
    for (double& f : s.f) f -= own;
    const std::vector<Vec3> tests{{0.5, 0.5, 0.5}, {-0.5, -0.5, 0.5}};
    StencilFit robust({1, true, 1.1}), plain({1, false, 1.1});
    robust.fit(s.u, s.f, 1, tests);
    plain.fit(s.u, s.f, 1, tests);
    double smeared = 0, kept = 0;
    for (std::size_t i = 0; i < s.u.size(); ++i) {
      if (s.other[i] || norm(s.u[i]) > 1) continue;
      smeared = std::max(smeared, std::abs(value_of(plain, s.u[i]) - s.f[i]));
      kept = std::max(kept, std::abs(value_of(robust, s.u[i]) - s.f[i]));
    }
    EXPECT_LT(kept, 0.01);  // a three-hundredth of the step
    EXPECT_GT(smeared, 0.03);
  }
}

// The weights are the distance weights times ψ' of the residuals of the resulting fit: weighted least squares by
// another method gives the same polynomial.
TEST(StencilFit, IsAFixedPointOfItsWeights) {
  int tried = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Stencil s = ball(80, seed);
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < s.u.size(); ++i) {
      const double t = static_cast<double>(random()) / 4294967296.0;
      // Errors of all sizes: some weights are between 0 and 1.
      const double off = i == 0 ? 0 : i % 12 == 0 ? 0.3 + 2 * t : i % 12 == 6 ? 0.12 : 0;
      s.f.push_back(plane(s.u[i]) - plane(s.u[0]) + (i == 0 ? 0 : 0.05 * (t - 0.5)) + off);
    }
    const std::vector<Vec3> tests{{0.5, 0.5, 0.5}};
    StencilFit fit({1, true, 1.1});
    fit.fit(s.u, s.f, 1, tests);
    if (fit.split() || fit.degree() != 1) continue;  // the largest errors far from all others: another rule
    ++tried;
    const std::size_t n = s.u.size();
    std::vector<double> e(n), sorted(n);
    for (std::size_t i = 0; i < n; ++i) e[i] = s.f[i] - value_of(fit, s.u[i]), sorted[i] = std::abs(e[i]);
    std::sort(sorted.begin(), sorted.end());
    const double sigma = 3 * sorted[n / 2] / 0.6745;
    ASSERT_GT(sorted.back(), 5 * sorted[n / 2] / 0.6745);
    Eigen::MatrixXd a(static_cast<Eigen::Index>(n), 4);
    Eigen::VectorXd b(static_cast<Eigen::Index>(n));
    for (std::size_t i = 0; i < n; ++i) {
      const double distance = std::max(std::exp(-squared_norm(s.u[i]) / (1.1 * 1.1)), 1e-4);
      const double root = std::sqrt(distance * (i == 0 ? 1 : std::exp(-e[i] * e[i] / (2 * sigma * sigma))));
      const auto row = static_cast<Eigen::Index>(i);
      a.row(row) << root, root * s.u[i].x, root * s.u[i].y, root * s.u[i].z;
      b(row) = root * s.f[i];
    }
    const Eigen::VectorXd c = a.colPivHouseholderQr().solve(b);
    for (int j = 0; j < 4; ++j)
      EXPECT_NEAR(fit.monomials(0)[static_cast<std::size_t>(j)], c(j), 0.15 * sorted[n / 2]) << j;
  }
  EXPECT_GE(tried, 15);
}

TEST(StencilFit, CleanDataKeepTheirWeights) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Stencil s = ball(100, seed);
    for (const Vec3& u : s.u) s.f.push_back(std::sin(0.6 * u.x) + std::cos(0.5 * u.y - 0.3 * u.z) - 1);
    const std::vector<Vec3> tests{{0.5, 0.5, 0.5}};
    StencilFit robust({}), plain({3, false, 1.1});
    robust.fit(s.u, s.f, 1, tests);
    plain.fit(s.u, s.f, 1, tests);
    ASSERT_EQ(robust.degree(), plain.degree());
    for (std::size_t j = 0; j < plain.monomials(0).size(); ++j)
      EXPECT_EQ(robust.monomials(0)[j], plain.monomials(0)[j]) << j;
  }
}

}  // namespace
}  // namespace sansmesh::test
