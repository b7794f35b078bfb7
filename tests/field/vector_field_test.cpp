// Contract of vector fields, tested on a closed-form field.
#include "sansmesh/vector_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

/// In the unit ball, for 0 ≤ t ≤ 2: a rotation by ω that increases with time, and a source at the centre.
class SwirlingSource final : public VectorField {
 public:
  Box3 bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
  TimeRange times() const override { return {0, 2}; }
  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian> jacobian = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      inside[i] = norm(x[i]) <= 1 && times().contains(t[i]);
      vectors[i] = inside[i] ? velocity(x[i], t[i]) : Vec3{};
      if (jacobian.empty()) continue;
      jacobian[i] = {};
      if (!inside[i]) continue;
      const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      for (std::size_t k = 0; k < 3; ++k)
        jacobian[i][k] = cross(omega(t[i]), axes[k]) + axes[k] * squared_norm(x[i]) + x[i] * (2 * x[i][k]);
    }
  }
  static Vec3 omega(double t) { return Vec3{0.3, -0.2, 1} * (1 + t); }
  static Vec3 velocity(const Vec3& x, double t) { return cross(omega(t), x) + x * squared_norm(x); }
};

struct Answer {
  std::vector<Vec3> vectors;
  std::vector<std::uint8_t> inside;
  std::vector<Jacobian> jacobian;

  Answer(const VectorField& field, std::span<const Vec3> x, std::span<const double> t)
      : vectors(x.size()), inside(x.size()), jacobian(x.size()) {
    field.evaluate(x, t, vectors, inside, jacobian);
  }
};

class VectorFieldContract : public ::testing::Test {
 protected:
  VectorFieldContract() {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(-1.2, 1.2);
    for (int i = 0; i < 500; ++i) {
      x.push_back({u(random), u(random), u(random)});
      t.push_back(1 + u(random));
    }
    x.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
    t.push_back(1);
    x.push_back({0, 0, 0});
    t.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  const SwirlingSource swirl;
  const VectorField& field = swirl;
  std::vector<Vec3> x;
  std::vector<double> t;
};

TEST_F(VectorFieldContract, IsZeroWhereAndWhenItIsNotDefined) {
  const Answer all(field, x, t);
  std::size_t defined = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_EQ(all.inside[i] != 0, norm(x[i]) <= 1 && t[i] >= 0 && t[i] <= 2);
    defined += all.inside[i];
    if (all.inside[i]) {
      ASSERT_TRUE(field.bounds().contains(x[i]) && field.times().contains(t[i]));
    } else {
      ASSERT_EQ(all.vectors[i], Vec3{});
      ASSERT_EQ(all.jacobian[i], Jacobian{});
    }
  }
  EXPECT_GT(defined, 100u);
  EXPECT_LT(defined, 400u);
}

TEST_F(VectorFieldContract, EachAnswerIsItsOwn) {
  const Answer all(field, x, t);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Answer one(field, std::span(&x[i], 1), std::span(&t[i], 1));
    ASSERT_EQ(one.vectors[0], all.vectors[i]);
    ASSERT_EQ(one.inside[0], all.inside[i]);
    ASSERT_EQ(one.jacobian[0], all.jacobian[i]);
  }
  std::vector<Vec3> vectors(x.size());
  std::vector<std::uint8_t> inside(x.size());
  field.evaluate(x, t, vectors, inside);  // without derivatives
  EXPECT_EQ(vectors, all.vectors);
  EXPECT_EQ(inside, all.inside);
}

TEST_F(VectorFieldContract, DerivativesAgreeWithDifferences) {
  const double h = 1e-5;
  const Answer all(field, x, t);
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<Vec3> ahead = x, behind = x;
    for (std::size_t i = 0; i < x.size(); ++i) ahead[i][k] += h, behind[i][k] -= h;
    const Answer a(field, ahead, t), b(field, behind, t);
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!a.inside[i] || !b.inside[i] || !all.inside[i]) continue;
      ASSERT_LT(norm((a.vectors[i] - b.vectors[i]) / (2 * h) - all.jacobian[i][k]), 1e-8);
    }
  }
}

TEST_F(VectorFieldContract, CurlIsTwiceTheRotationAndDivergenceTheSource) {
  const Answer all(field, x, t);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!all.inside[i]) continue;
    ASSERT_LT(norm(curl(all.jacobian[i]) - SwirlingSource::omega(t[i]) * 2.0), 1e-12);
    ASSERT_NEAR(divergence(all.jacobian[i]), 5 * squared_norm(x[i]), 1e-12);
  }
}

TEST(VectorField, IsSteadyUnlessItSaysOtherwise) {
  class Steady final : public VectorField {
    Box3 bounds() const override { return {{0, 0, 0}, {1, 1, 1}}; }
    void evaluate(std::span<const Vec3>, std::span<const double>, std::span<Vec3>, std::span<std::uint8_t>,
                  std::span<Jacobian>) const override {}
  };
  const Steady steady;
  EXPECT_TRUE(static_cast<const VectorField&>(steady).times().contains(-1e300));
  EXPECT_TRUE(static_cast<const VectorField&>(steady).times().contains(1e300));
}

}  // namespace
}  // namespace sansmesh::inline v1
