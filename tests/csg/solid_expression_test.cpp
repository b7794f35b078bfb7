// Minima and maxima of smooth functions: blends of many parts evaluate only near ones, with the same result.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "csg/catalogue.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/field/piece_expression.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

constexpr double kBlend = 0.2;

struct BlendedBalls {
  std::vector<Solid> balls;
  Solid together;

  explicit BlendedBalls(std::size_t count) : balls{csg::sphere({0, 0, 0}, 0.55)}, together(balls[0]) {
    for (std::size_t i = 1; i < count; ++i) {
      const std::size_t row = i / 10;
      balls.push_back(csg::sphere({static_cast<double>(i % 10), static_cast<double>(row), 0}, 0.55));
      together = csg::unite(together, balls.back(), kBlend);
    }
  }
};

std::vector<Vec3> places(std::size_t count, double wide) {
  std::vector<Vec3> x = random_points(count, 1);
  for (Vec3& p : x) p = {4.5 + wide * p.x, 4.5 + wide * p.y, p.z};
  return x;
}

/// Shells of a box have few planes, but each doubles the number of nodes; most of these are equal.
TEST(SolidExpression, NestedShellsAreFewNodesOrNone) {
  Solid shells = csg::box({0, 0, 0}, {1, 1, 1});
  for (int depth = 1; depth <= 22; ++depth) {
    shells = csg::shell(shells, 1e-3);
    if (depth % 7 != 1) continue;
    const auto expression = shells.expression(1e-9);
    EXPECT_EQ(expression == nullptr, depth > 16) << depth;
    if (!expression) continue;
    EXPECT_LT(expression->nodes().size(), 4000u) << depth;
    // The minima and maxima of the pieces equal the values of the solid.
    std::vector<double> expected(200);
    const std::vector<Vec3> x = random_points(expected.size(), 1.5);
    shells.evaluate(x, expected);
    std::vector<std::vector<double>> values;
    for (const auto& n : expression->nodes()) {
      std::vector<double>& own = values.emplace_back(x.size());
      if (n.kind == PieceExpression::Node::Kind::piece) expression->evaluate_piece(n.a, x, own, {});
      for (std::size_t i = 0; i < x.size() && n.kind != PieceExpression::Node::Kind::piece; ++i)
        own[i] = n.kind == PieceExpression::Node::Kind::least ? std::min(values[n.a][i], values[n.b][i])
                                                              : std::max(values[n.a][i], values[n.b][i]);
    }
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(values.back()[i], expected[i], 1e-7) << depth;
  }
}

TEST(SolidExpression, BlendsOfManyPartsAreThoseOfAllParts) {
  SANSMESH_NOT_SANITIZED("judges values; others ask the same regions");
  const BlendedBalls solid(100);
  const auto expression = solid.together.expression(0);
  ASSERT_TRUE(expression);
  ASSERT_EQ(expression->nodes().size(), 1u);
  const std::uint32_t piece = expression->nodes()[0].a;
  const std::vector<Vec3> x = places(20000, 6);  // some outside the bounds
  std::vector<double> value(x.size()), expected(x.size());
  std::vector<Vec3> gradient(x.size()), slope(x.size());
  expression->evaluate_piece(piece, x, value, gradient);
  for (std::size_t k = 0; k < solid.balls.size(); ++k) {
    std::vector<double> b(x.size());
    std::vector<Vec3> g(x.size());
    solid.balls[k].evaluate(x, b, g);
    for (std::size_t i = 0; i < x.size(); ++i) {
      double& a = expected[i];
      const double d = a - b[i], weight = k == 0 ? 1 : std::clamp(0.5 + d / (2 * kBlend), 0.0, 1.0);
      if (weight == 1) {
        a = b[i];
      } else if (weight > 0) {
        a = (a + b[i]) / 2 - (kBlend * kBlend + d * d) / (4 * kBlend);
      }
      slope[i] = (1 - weight) * slope[i] + weight * g[i];
    }
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_NEAR(value[i], expected[i], 1e-14) << i;
    ASSERT_NEAR(norm(gradient[i] - slope[i]), 0, 1e-13) << i;
  }
}

TEST(SolidExpression, BlendsKnowTheBallsThatTheyAre) {
  const BlendedBalls solid(100);
  const auto expression = solid.together.expression(0);
  ASSERT_TRUE(expression);
  const std::uint32_t piece = expression->nodes()[0].a;
  const auto at = [&](const Vec3& x, double radius) { return expression->same_within(piece, x, radius); };
  const Vec3 pole{4, 4, 0.55}, neck{4.5, 4, 0.2};
  const std::uint32_t ball = at(pole, 0.01);
  EXPECT_NE(ball, piece);
  EXPECT_EQ(at({4, 4, 0.5}, 0.02), ball);
  EXPECT_LT(ball, expression->pieces());
  EXPECT_LT(at(neck, 0.01), expression->pieces());
  EXPECT_NE(at(neck, 0.01), ball);
  EXPECT_EQ(at(pole, 5), piece);
  const std::vector<Vec3> both{pole, {5, 4, 0.55}}, one{pole, {4, 4, 0.5}};
  EXPECT_EQ(expression->same_at(piece, one), ball);
  EXPECT_NE(expression->same_at(piece, both), ball);
  EXPECT_NEAR(expression->curvature_bound(piece, pole, 1e-3), 1 / 0.55, 1e-2);
  EXPECT_GT(expression->curvature_bound(piece, neck, 1e-3), 1 / 0.55);
}

}  // namespace
}  // namespace sansmesh::inline v1
