// Unions and intersections of many parts: equal to sequential combinations, but only near parts are evaluated.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <random>

#include "csg/catalogue.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/field/piecewise_field.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

struct Parts {
  std::vector<Solid> all;
  Solid together;
};

/// Parts of all kinds, some rotated, some unbounded, as a union or as the space between them.
Parts many_parts(std::size_t count, bool intersection) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-2, 2), size(0.05, 0.3);
  std::vector<Solid> all;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 c{place(random), place(random), place(random)}, axis{place(random), place(random), 0.5};
    const double s = size(random);
    Solid part = i % 4 == 0   ? csg::sphere(c, s)
                 : i % 4 == 1 ? csg::rotate(csg::box(c - Vec3{s, s, s}, c + Vec3{s, 2 * s, s}), axis, 40 * s, c)
                 : i % 4 == 2 ? csg::cone(c, axis, s, s / 3, 3 * s)
                              : csg::torus(c, axis, s, s / 4);
    if (i == 7) part = csg::cylinder(c, axis, 0.1);
    all.push_back(intersection ? csg::complement(part) : part);
  }
  Solid together = all[0];
  for (std::size_t i = 1; i < count; ++i)
    together = intersection ? csg::intersect(together, all[i]) : csg::unite(together, all[i]);
  return {std::move(all), together};
}

TEST(Group, IsWhatItsPartsSay) {
  for (const bool intersection : {false, true}) {
    const Parts parts = many_parts(150, intersection);
    const std::vector<Vec3> x = random_points(3000, 2.5);
    std::vector<double> expected(x.size(), intersection ? -1e300 : 1e300), value(x.size());
    std::vector<std::uint32_t> expected_piece(x.size()), piece(x.size());
    std::uint32_t first = 0;
    for (const Solid& part : parts.all) {
      const std::vector<double> own = values_of(part, x);
      part.active(x, piece);
      for (std::size_t i = 0; i < x.size(); ++i)
        if (intersection ? own[i] > expected[i] : own[i] < expected[i])
          expected[i] = own[i], expected_piece[i] = first + piece[i];
      first += part.pieces();
    }
    EXPECT_EQ(parts.together.pieces(), first);
    std::vector<Vec3> gradient(x.size()), of_piece(x.size());
    parts.together.evaluate(x, value, gradient);
    parts.together.active(x, piece);
    EXPECT_EQ(value, expected);
    EXPECT_EQ(piece, expected_piece);
    for (std::size_t i = 0; i < 200; ++i) {
      parts.together.evaluate_piece(piece[i], std::span(x).subspan(i, 1), std::span(value).first(1),
                                    std::span(of_piece).first(1));
      EXPECT_EQ(value[0], expected[i]);
      EXPECT_EQ(of_piece[0], gradient[i]);
    }
  }
}

/// Solids with faces in the same planes, and points on the planes half-way between them, where two or more values are
/// equal or differ by rounding.
std::vector<Solid> solids_with_ties() {
  std::vector<Solid> all;
  Solid row = csg::box({0, 0, 0}, {1, 1, 1}), turned = row, between = csg::complement(row);
  for (int k = 1; k < 40; ++k) {
    const Solid next = csg::box({0.1 * k, 0, 0}, {0.1 * k + 1, 1 + 0.1 * (k % 3), 1});
    row = csg::unite(row, next);
    between = csg::intersect(between, csg::complement(csg::translate(next, {0.7, 0.1 * k, 0.3})));
    turned = csg::unite(turned, csg::rotate(csg::sphere({0.3 * k, 0.1, 0}, 0.1 + 0.01 * (k % 4)), {1, 2, 3}, 30 * k));
  }
  all = {row, between, turned, csg::rotate(row, {1, 1, 2}, 50, {0.3, 0.1, 7}),
         csg::scale(csg::translate(between, {1000.1, -300.7, 0.3}), 0.1)};
  all.push_back(csg::unite(csg::box({-1, -1, -1}, {0.1, 1, 1}), csg::box({0.3, -1, -1}, {1, 1, 1})));
  all.push_back(csg::intersect(csg::offset(row, 0.1), csg::shell(csg::unite(row, turned), 0.1)));
  return all;
}

TEST(Group, TiesAreTheSameForOnePointAsForMany) {
  std::vector<Vec3> x;
  for (int i = -3; i < 12; ++i)
    for (int j = -3; j < 8; ++j)
      for (int k = -3; k < 8; ++k) x.push_back({0.2 * i, 0.25 * j, 0.3 * k});
  for (std::size_t i = 0; i < x.size(); i += 7) x[i] = 10 * x[i] + Vec3{0, 0.5, 0.5};
  std::size_t solid_number = 0;
  for (const Solid& solid : solids_with_ties()) {
    SCOPED_TRACE(solid_number++);
    std::vector<double> value(x.size());
    std::vector<Vec3> gradient(x.size());
    std::vector<std::uint32_t> piece(x.size());
    solid.evaluate(x, value, gradient);
    solid.active(x, piece);
    std::size_t differ = 0;
    for (std::size_t few : {1, 2, 3, 40}) {
      std::vector<double> v(few);
      std::vector<Vec3> g(few);
      std::vector<std::uint32_t> p(few);
      for (std::size_t first = 0; first + few <= x.size(); first += few) {
        const auto at = std::span<const Vec3>(x).subspan(first, few);
        solid.evaluate(at, v, g);
        solid.active(at, p);
        for (std::size_t k = 0; k < few; ++k)
          differ += v[k] != value[first + k] || g[k] != gradient[first + k] || p[k] != piece[first + k];
      }
    }
    EXPECT_EQ(differ, 0u) << "of " << 4 * x.size();
  }
}

TEST(Group, SurveysTellHowFarAPieceIsAlone) {
  const Parts parts = many_parts(60, false);
  const std::vector<Vec3> x = random_points(400, 1.5);
  std::vector<double> value(x.size());
  std::vector<Surroundings> around(x.size());
  parts.together.survey(x, {0.1, 0.3}, value, around);
  EXPECT_EQ(value, values_of(parts.together, x));
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::size_t known = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double radius = std::min(0.3, around[i].alone);
    if (radius < 0.01) continue;
    ++known;
    std::vector<Vec3> near{x[i]};
    for (int k = 0; k < 40; ++k)
      near.push_back(x[i] + 0.999 * radius * normalized(Vec3{normal(random), normal(random), normal(random)}));
    std::vector<std::uint32_t> piece(near.size());
    parts.together.active(near, piece);
    for (const std::uint32_t p : piece) EXPECT_EQ(p, piece[0]) << i;
  }
  EXPECT_GT(known, 200u);
}

/// A ball that counts its evaluations.
class CountedBall final : public ScalarField {
 public:
  CountedBall(const Vec3& center, double radius, std::atomic<std::size_t>& asked)
      : center_(center), radius_(radius), asked_(asked) {}
  Box3 bounds() const override {
    const Vec3 r{radius_, radius_, radius_};
    return {center_ - r, center_ + r};
  }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    asked_ += x.size();
    for (std::size_t i = 0; i < x.size(); ++i) {
      values[i] = norm(x[i] - center_) - radius_;
      if (!gradients.empty()) gradients[i] = normalized(x[i] - center_);
    }
  }

 private:
  Vec3 center_;
  double radius_;
  std::atomic<std::size_t>& asked_;
};

TEST(Group, FewOfAThousandPartsAreAsked) {
  std::atomic<std::size_t> asked = 0;
  Solid all = csg::sphere({-1, -1, -1}, 0.1);
  for (int x = 0; x < 10; ++x)
    for (int y = 0; y < 10; ++y)
      for (int z = 0; z < 10; ++z)
        all = csg::unite(all,
                         csg::distance_leaf(std::make_shared<CountedBall>(Vec3{1. * x, 1. * y, 1. * z}, 0.3, asked)));
  std::vector<Vec3> x = random_points(50000, 5);
  for (Vec3& p : x) p += Vec3{4.5, 4.5, 4.5};
  asked = 0;
  const std::vector<double> value = values_of(all, x);
  EXPECT_LT(asked, 150 * x.size());
  for (std::size_t i = 0; i < x.size(); i += 97) {
    Vec3 nearest;
    for (std::size_t k = 0; k < 3; ++k) nearest[k] = std::clamp(std::round(x[i][k]), 0.0, 9.0);
    EXPECT_NEAR(value[i], norm(x[i] - nearest) - 0.3, 1e-12);
  }
}

/// Nodes at the maximum depth that alternate between unions and differences.
TEST(Group, NestedGroupsAskEachPartAboutOnce) {
  constexpr std::size_t kDepth = 480;
  std::atomic<std::size_t> asked = 0;
  std::vector<Solid> balls;
  for (std::size_t k = 0; k <= kDepth; ++k)
    balls.push_back(csg::distance_leaf(std::make_shared<CountedBall>(Vec3{0.001 * static_cast<double>(k), 0, 0},
                                                                     1 + 0.01 * static_cast<double>(k % 7), asked)));
  Solid all = balls[0];
  for (std::size_t k = 1; k <= kDepth; ++k) all = k % 2 ? csg::subtract(all, balls[k]) : csg::unite(all, balls[k]);
  const std::vector<Vec3> x = random_points(640, 2);
  std::vector<double> expected = values_of(balls[0], x);
  for (std::size_t k = 1; k <= kDepth; ++k) {
    const std::vector<double> next = values_of(balls[k], x);
    for (std::size_t i = 0; i < x.size(); ++i)
      expected[i] = k % 2 ? std::max(expected[i], -next[i]) : std::min(expected[i], next[i]);
  }
  asked = 0;
  EXPECT_EQ(values_of(all, x), expected);
  EXPECT_LT(asked, 3 * kDepth * x.size() / 2);
  asked = 0;
  EXPECT_EQ(value_at(all, x[0]), expected[0]);
  EXPECT_LE(asked, kDepth + 1);
  std::vector<double> value(x.size());
  std::vector<Surroundings> around(x.size());
  asked = 0;
  all.survey(x, {0.1, 0.3}, value, around);
  EXPECT_EQ(value, expected);
  EXPECT_LT(asked, 3 * kDepth * x.size() / 2);
}

TEST(Group, AnyNumberOfThreads) {
  const Parts parts = many_parts(150, false);
  const std::vector<Vec3> x = random_points(5000);
  const std::vector<double> once = values_of(parts.together, x);
  const ThreadScope one(1);
  EXPECT_EQ(values_of(parts.together, x), once);
}

}  // namespace
}  // namespace sansmesh::inline v1
