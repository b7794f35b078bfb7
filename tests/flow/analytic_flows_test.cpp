#include "sansmesh/flow_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

struct Asked {
  std::vector<Vec3> vectors;
  std::vector<std::uint8_t> inside;
  std::vector<Jacobian> jacobian;
};

Asked ask(const VectorField& field, const std::vector<Vec3>& x, double t) {
  Asked a{std::vector<Vec3>(x.size()), std::vector<std::uint8_t>(x.size()), std::vector<Jacobian>(x.size())};
  const std::vector<double> moments(x.size(), t);
  field.evaluate(x, moments, a.vectors, a.inside, a.jacobian);
  return a;
}

/// Points in the interior, outside the sphere of the flow past it.
std::vector<Vec3> places(const Box3& box) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0.05, 0.95);
  std::vector<Vec3> x;
  while (x.size() < 200) {
    const Vec3 size = box.size();
    const Vec3 p = box.lower + Vec3{size.x * u(random), size.y * u(random), size.z * u(random)};
    if (std::abs(norm(p) - 1) > 0.05) x.push_back(p);
  }
  return x;
}

TEST(AnalyticFlows, DerivativesAreThoseOfTheVectors) {
  constexpr double kStep = 1e-5;
  for (const AnalyticFlow& known : analytic_flows()) {
    SCOPED_TRACE(std::string(known.name));
    const auto flow = analytic_flow(known.name);
    const std::vector<Vec3> x = places(flow->bounds());
    const Asked here = ask(*flow, x, 0.7);
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<Vec3> more = x, less = x;
      for (std::size_t i = 0; i < x.size(); ++i) more[i][k] += kStep, less[i][k] -= kStep;
      const Asked a = ask(*flow, more, 0.7), b = ask(*flow, less, 0.7);
      for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_LT(norm((a.vectors[i] - b.vectors[i]) / (2 * kStep) - here.jacobian[i][k]), 1e-5) << i << ' ' << k;
    }
  }
}

/// All flows except the tornado are divergence-free.
TEST(AnalyticFlows, KeepVolumes) {
  for (const AnalyticFlow& known : analytic_flows()) {
    if (known.name == "tornado") continue;
    SCOPED_TRACE(std::string(known.name));
    const auto flow = analytic_flow(known.name);
    for (const Jacobian& j : ask(*flow, places(flow->bounds()), 3).jacobian) EXPECT_NEAR(divergence(j), 0, 1e-12);
  }
}

TEST(AnalyticFlows, ChangeInTimeWhereTheySaySo) {
  for (const AnalyticFlow& known : analytic_flows()) {
    const auto flow = analytic_flow(known.name);
    const std::vector<Vec3> x = places(flow->bounds());
    EXPECT_EQ(ask(*flow, x, 0).vectors != ask(*flow, x, 1.3).vectors, known.unsteady) << known.name;
  }
}

TEST(AnalyticFlows, EndWhereTheyEnd) {
  const auto flow = analytic_flow("past-sphere");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Asked a = ask(*flow, {{0.2, 0.1, 0}, {5, 0, 0}, {nan, 0, 0}, {0, 1, 0}}, 0);
  EXPECT_EQ(a.inside, (std::vector<std::uint8_t>{0, 0, 0, 1}));
  EXPECT_EQ(norm(a.vectors[0]) + norm(a.vectors[1]) + norm(a.vectors[2]), 0);
  EXPECT_NEAR(a.vectors[3].x, 1.5, 1e-12);  // 1.5 times the speed at the sphere's equator
  EXPECT_THROW(analytic_flow("nothing"), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
