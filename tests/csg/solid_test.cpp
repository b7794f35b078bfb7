// Properties of each solid: gradients, pieces, boxes, distances.
#include "sansmesh/csg/solid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "csg/catalogue.h"
#include "sansmesh/error.h"
#include "support/any_threads.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Solid, GradientsAreDerivatives) {
  const std::vector<Vec3> x = random_points(3000);
  const double step = 1e-6;
  for (const NamedSolid& s : catalogue()) {
    std::vector<double> v(x.size());
    std::vector<Vec3> g(x.size());
    s.solid.evaluate(x, v, g);
    EXPECT_EQ(v, values_of(s.solid, x)) << s.name;
    std::size_t tried = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      std::vector<Vec3> around;
      for (std::size_t k = 0; k < 6; ++k) {
        around.push_back(x[i]);
        around[k][k / 2] += k % 2 ? step : -step;
      }
      std::vector<std::uint32_t> piece(6);
      s.solid.active(around, piece);
      if (std::any_of(piece.begin(), piece.end(), [&](std::uint32_t p) { return p != piece[0]; })) continue;
      ++tried;
      const std::vector<double> f = values_of(s.solid, around);
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_NEAR(g[i][k], (f[2 * k + 1] - f[2 * k]) / (2 * step), 2e-5) << s.name << " at " << i << ' ' << k;
    }
    EXPECT_GT(tried, 2700u) << s.name;
  }
}

TEST(Solid, PiecesAreTheField) {
  const std::vector<Vec3> x = random_points(4000);
  for (const NamedSolid& s : catalogue()) {
    std::vector<double> v(x.size()), of_piece(x.size());
    std::vector<Vec3> g(x.size()), gradient_of_piece(x.size());
    std::vector<std::uint32_t> active(x.size());
    s.solid.evaluate(x, v, g);
    s.solid.active(x, active);
    for (std::uint32_t p = 0; p < s.solid.pieces(); ++p) {
      s.solid.evaluate_piece(p, x, of_piece, gradient_of_piece);
      for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_LT(active[i], s.solid.pieces());
        if (active[i] != p) continue;
        ASSERT_NEAR(of_piece[i], v[i], 1e-12) << s.name << ' ' << p;
        ASSERT_LT(norm(gradient_of_piece[i] - g[i]), 1e-9) << s.name << ' ' << p;
      }
    }
  }
}

/// Where the piece changes between two close points, both pieces have the value of the solid there, so that a change of
/// the piece is a crease or a smooth transition, never a jump of the field.
TEST(Solid, PiecesMeetWhereTheyChange) {
  const std::vector<Vec3> x = random_points(20000);
  const double step = 1e-3;
  for (const NamedSolid& s : catalogue()) {
    std::vector<Vec3> y = x;
    for (Vec3& p : y) p.x += step;
    std::vector<std::uint32_t> a(x.size()), b(x.size());
    s.solid.active(x, a), s.solid.active(y, b);
    std::size_t changes = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (a[i] == b[i]) continue;
      ++changes;
      double of_a, of_b;
      s.solid.evaluate_piece(a[i], {&x[i], 1}, {&of_a, 1}, {});
      s.solid.evaluate_piece(b[i], {&x[i], 1}, {&of_b, 1}, {});
      ASSERT_NEAR(of_a, of_b, 6 * step) << s.name << ' ' << a[i] << ' ' << b[i];
    }
    if (s.name == "union" || s.name == "box") {
      EXPECT_GT(changes, 5u) << s.name;
    }
  }
}

/// Within the radius that a survey returns there is no other piece, and it returns one where possible.
TEST(Solid, SurveysAreTrue) {
  const std::vector<Vec3> x = random_points(4000), directions = random_points(40, 1, 9);
  for (const NamedSolid& s : catalogue()) {
    std::vector<double> values(x.size());
    std::vector<Surroundings> around(x.size());
    constexpr double kReach = 0.1;  // farther out, only slopes are known
    s.solid.survey(x, {0.05, kReach}, values, around);
    EXPECT_EQ(values, values_of(s.solid, x)) << s.name;
    std::vector<std::uint32_t> here(x.size());
    s.solid.active(x, here);
    std::size_t known = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_GE(around[i].alone, 0) << s.name;
      known += around[i].alone > 0.05;
      const double radius = std::min(around[i].alone, s.solid.slope_bound() ? 1.0 : kReach) * 0.999;
      std::vector<Vec3> y;
      for (const Vec3& d : directions) y.push_back(x[i] + normalized(d) * radius);
      std::vector<std::uint32_t> there(y.size());
      s.solid.active(y, there);
      for (const std::uint32_t p : there) ASSERT_EQ(p, here[i]) << s.name << " " << i << " " << radius;
    }
    if (s.name != "solid as field") {
      EXPECT_GT(known, x.size() / 3) << s.name;
    }
  }
}

/// No value in a ball is outside of its range, and small balls have small ranges.
TEST(Solid, RangesHoldTheValues) {
  SANSMESH_NOT_SANITIZED("judges bounds; others evaluate the same");
  const std::vector<Vec3> x = random_points(2000), directions = random_points(40, 1, 9);
  for (const NamedSolid& s : catalogue()) {
    const std::vector<double> values = values_of(s.solid, x);
    for (const double radius : {0.0, 0.01, 0.1, 0.7}) {
      std::vector<ValueRange> ranges(x.size());
      s.solid.ranges(x, radius, ranges);
      for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_LE(ranges[i].least, values[i]) << s.name;
        ASSERT_GE(ranges[i].most, values[i]) << s.name;
        // The steepest solid is the quadric, at the corners of the box of points.
        ASSERT_LE(ranges[i].most - ranges[i].least, 25 * radius) << s.name;
        std::vector<Vec3> y;
        for (const Vec3& d : directions) y.push_back(x[i] + d * (radius / std::max(norm(d), 1.0)));
        for (const double v : values_of(s.solid, y)) {
          ASSERT_LE(ranges[i].least, v + 1e-12) << s.name << " " << radius;
          ASSERT_GE(ranges[i].most, v - 1e-12) << s.name << " " << radius;
        }
      }
    }
  }
}

/// Knowledge of a field changes the time of evaluation, but no value.
TEST(Solid, KnowledgeOfFieldsChangesNoValue) {
  class Known final : public csg::FieldKnowledge {
   public:
    double detail(const Vec3&, double) const override { return 0.125; }
    double least(double sign, const Vec3& x, double radius) const override {
      ValueRange r{0, 0};
      QuadricField().ranges({&x, 1}, radius, {&r, 1});
      const double nearest = sign > 0 ? r.least : -r.most;
      return nearest > 0.1 ? nearest - 0.05 : -kInfinity;
    }
  };
  using namespace csg;
  const Solid plain = leaf(std::make_shared<QuadricField>()),
              known = leaf(std::make_shared<QuadricField>(), std::make_shared<Known>());
  const auto combined = [](const Solid& field) {
    const Solid moved = scale(rotate(field, {1, 2, 3}, 40), 0.8);
    return offset(
        unite(subtract(moved, cylinder({}, {0, 0, 1}, 0.3)), complement(subtract(moved, sphere({}, 2), 0.1)), 0.05),
        0.02);
  };
  const std::vector<Vec3> x = random_points(20000);
  EXPECT_EQ(values_of(combined(known), x), values_of(combined(plain), x));
  std::vector<ValueRange> with(x.size()), without(x.size());
  combined(known).ranges(x, 0.05, with);
  combined(plain).ranges(x, 0.05, without);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_EQ(with[i].least, without[i].least);
    ASSERT_EQ(with[i].most, without[i].most);
  }
  std::vector<double> values(x.size());
  std::vector<Surroundings> around(x.size());
  scale(known, 4).survey(x, {0.01, 0.01}, values, around);
  for (const Surroundings& s : around) ASSERT_TRUE(s.detail == 0.5 || std::isinf(s.detail));
}

TEST(Solid, KnowsHowThinItsPartsAre) {
  using namespace csg;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const Solid ball = sphere({1, 2, 3}, 0.5), plate = box({0, 0, 0}, {3, 2, 0.2}), ground = half_space({1, 2, 3}, 1);
  const auto twice = [](const Solid& a) { return scale(rotate(a, {1, 2, 3}, 30), 2); };
  EXPECT_EQ(ground.thickness(), kNone);
  EXPECT_DOUBLE_EQ(ball.thickness(), 1);
  EXPECT_DOUBLE_EQ(plate.thickness(), 0.2);
  EXPECT_DOUBLE_EQ(box({0, 0, 0}, {3, 2, 0.2}, 0.05).thickness(), 0.2);
  EXPECT_DOUBLE_EQ(cylinder({}, {1, 0, 1}, 0.3).thickness(), 0.6);
  EXPECT_DOUBLE_EQ(cylinder({}, {1, 0, 1}, 0.3, 0.4).thickness(), 0.4);
  EXPECT_DOUBLE_EQ(cone({}, {1, 0, 1}, 0.3, 0, 4).thickness(), 0.3);
  EXPECT_DOUBLE_EQ(capsule({}, {1, 0, 1}, 0.3).thickness(), 0.6);
  EXPECT_DOUBLE_EQ(torus({}, {0, 0, 1}, 1, 0.25).thickness(), 0.5);
  EXPECT_DOUBLE_EQ(torus({}, {0, 0, 1}, 1, 0.9).thickness(), 0.2);  // the hole
  EXPECT_DOUBLE_EQ(unite(ball, plate).thickness(), 0.2);
  EXPECT_DOUBLE_EQ(subtract(ground, ball, 0.1).thickness(), 1);
  EXPECT_DOUBLE_EQ(twice(ball).thickness(), 2);
  // Offsets make parts thicker, and holes thinner until they vanish.
  EXPECT_DOUBLE_EQ(offset(unite(ball, plate), 0.3).thickness(), 0.8);
  EXPECT_DOUBLE_EQ(offset(ball, -0.3).thickness(), 0.4);
  EXPECT_DOUBLE_EQ(offset(subtract(ground, ball), 0.3).thickness(), 0.4);
  EXPECT_EQ(offset(subtract(ground, ball), 0.6).thickness(), kNone);
  EXPECT_DOUBLE_EQ(offset(offset(ball, -0.6), 0.6).thickness(), 1);
  EXPECT_DOUBLE_EQ(unite(offset(ball, -0.6), plate).thickness(), 0.2);
  // For a shell: the wall, the inner space, or a part that is thinner than the wall.
  EXPECT_DOUBLE_EQ(shell(unite(ground, sphere({}, 0.01)), 0.1, ShellSide::inside).thickness(), 0.02);
  EXPECT_DOUBLE_EQ(shell(ball, 0.1).thickness(), 0.1);
  EXPECT_DOUBLE_EQ(shell(ball, 0.45, ShellSide::inside).thickness(), 0.1);
  EXPECT_DOUBLE_EQ(shell(ball, 0.6, ShellSide::inside).thickness(), 0.6);
  EXPECT_DOUBLE_EQ(shell(complement(ball), 0.45, ShellSide::outside).thickness(), 0.1);
  EXPECT_DOUBLE_EQ(offset(leaf(std::make_shared<Solid>(subtract(ground, ball))), 0.3).thickness(), 0.4);
  EXPECT_DOUBLE_EQ(leaf(std::make_shared<Solid>(subtract(ground, ball))).thickness(), 1);
}

TEST(Solid, LiesInItsBox) {
  const std::vector<Vec3> x = random_points(50000);
  for (const NamedSolid& s : catalogue()) {
    const Box3 box = s.solid.bounds();
    EXPECT_FALSE(box.empty()) << s.name;
    const std::vector<double> v = values_of(s.solid, x);
    std::size_t inside = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (v[i] >= 0) continue;
      ++inside;
      ASSERT_TRUE(box.contains(x[i])) << s.name;
    }
    EXPECT_GT(inside, 50u) << s.name;
  }
}

TEST(Solid, BoxesOfPrimitivesAreTight) {
  SANSMESH_NOT_SANITIZED("judges boxes; others evaluate the same solids");
  // Points of the surface come near all six faces.
  for (const NamedSolid& s : primitives()) {
    const Box3 box = s.solid.bounds();
    if (!is_finite(box.lower) || !is_finite(box.upper) || s.name == "field") continue;
    for (const double degrees : {0.0, 25.0}) {
      const Solid turned = csg::rotate(s.solid, {1, -2, 0.5}, degrees);
      Box3 reached;
      const std::vector<Vec3> x = random_points(400000, 1.8);
      const std::vector<double> v = values_of(turned, x);
      for (std::size_t i = 0; i < x.size(); ++i)
        if (v[i] < 0) reached.extend(x[i]);
      const Box3 bounds = turned.bounds();
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(reached.lower[k], bounds.lower[k], 0.15) << s.name << ' ' << degrees;
        EXPECT_NEAR(reached.upper[k], bounds.upper[k], 0.15) << s.name << ' ' << degrees;
      }
    }
  }
}

TEST(Solid, BoxesKnowWhatIsUnbounded) {
  using namespace csg;
  const Box3 half = half_space({0, 0, -2}, -0.5).bounds();
  EXPECT_EQ(half.lower, (Vec3{-kInfinity, -kInfinity, 0.5}));
  EXPECT_EQ(half.upper, (Vec3{kInfinity, kInfinity, kInfinity}));
  const Box3 pipe = cylinder({1, 2, 3}, {0, 1, 0}, 0.5).bounds();
  EXPECT_EQ(pipe.lower, (Vec3{0.5, -kInfinity, 2.5}));
  EXPECT_EQ(pipe.upper, (Vec3{1.5, kInfinity, 3.5}));
  // Cut off on both sides it is bounded, exactly so after quarter turns.
  const Solid cut =
      subtract(intersect(cylinder({}, {0, 0, 1}, 1), half_space({0, 0, 1}, 2)), half_space({0, 0, 1}, -3));
  EXPECT_EQ(cut.bounds().lower, (Vec3{-1, -1, -3}));
  EXPECT_EQ(cut.bounds().upper, (Vec3{1, 1, 2}));
  const Box3 lying = rotate(cut, {1, 0, 0}, -90).bounds();
  EXPECT_NEAR(lying.lower.y, -3, 1e-12);
  EXPECT_NEAR(lying.upper.y, 2, 1e-12);
  EXPECT_EQ(complement(sphere({}, 1)).bounds().upper.x, kInfinity);
  EXPECT_EQ(complement(unite(complement(sphere({}, 1)), half_space({1, 0, 0}, 0))).bounds().lower.x, 0);
  EXPECT_TRUE(intersect(sphere({}, 1), sphere({3, 0, 0}, 1)).bounds().empty());
  EXPECT_NEAR(offset(box({0, 0, 0}, {1, 1, 1}, 0.1), -0.2).bounds().lower.x, 0.2, 1e-12);
  EXPECT_NEAR(offset(sphere({}, 1), 0.5).bounds().upper.z, 1.5, 1e-12);
}

TEST(Solid, DistancesAreDistances) {
  const std::vector<Vec3> x = random_points(4000), y = random_points(4000, 2, 8);
  for (const NamedSolid& s : catalogue()) {
    std::vector<double> v(x.size()), w(y.size());
    std::vector<Vec3> g(x.size());
    s.solid.evaluate(x, v, g), s.solid.evaluate(y, w);
    for (std::size_t i = 0; i < x.size() && s.name.find("field") == std::string::npos; ++i)
      ASSERT_LE(std::abs(v[i] - w[i]), norm(x[i] - y[i]) * (1 + 1e-12)) << s.name;
    if (!s.exact) continue;
    // The foot point given by value and gradient is on the surface, and no nearer point is.
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(value_at(s.solid, x[i] - v[i] * g[i]), 0, 1e-9) << s.name;
  }
}

TEST(Solid, KnownValues) {
  using namespace csg;
  EXPECT_DOUBLE_EQ(value_at(sphere({1, 0, 0}, 2), {4, 4, 0}), 3);
  EXPECT_DOUBLE_EQ(value_at(box({0, 0, 0}, {2, 2, 2}), {3, 3, 1}), 1);  // the continued face, less than √2
  EXPECT_DOUBLE_EQ(value_at(box({0, 0, 0}, {4, 4, 4}, 1), {6, 7, 2}), 4);
  EXPECT_DOUBLE_EQ(value_at(cylinder({0, 0, 0}, {0, 0, 2}, 1, 4), {0, 0, 5}), 3);
  EXPECT_DOUBLE_EQ(value_at(torus({0, 0, 0}, {0, 0, 1}, 3, 1), {0, 3, 2}), 1);
  EXPECT_DOUBLE_EQ(value_at(capsule({0, 0, 0}, {1, 0, 0}, 0.5), {5, 3, 0}), 4.5);
  EXPECT_NEAR(value_at(cone({0, 0, 0}, {0, 0, 1}, 1, 0, 2), {1.25, 0, 0.5}), 1 * 2 / std::sqrt(5), 1e-12);
  EXPECT_DOUBLE_EQ(value_at(half_space({0, 3, 0}, 1), {7, 5, 7}), 4);
  EXPECT_DOUBLE_EQ(value_at(scale(sphere({0, 0, 0}, 1), 3), {5, 0, 0}), 2);
  EXPECT_NEAR(value_at(rotate(sphere({2, 0, 0}, 1), {0, 0, 1}, 90), {0, 2, 0}), -1, 1e-12);  // counter-clockwise
  EXPECT_NEAR(value_at(rotate(sphere({2, 0, 0}, 1), {0, 0, 1}, 90, {2, 2, 0}), {4, 2, 0}), -1, 1e-12);
  EXPECT_NEAR(value_at(mirror(sphere({2, 0, 0}, 1), {1, 0, 0}, 0.5), {-1, 0, 0}), -1, 1e-12);
  EXPECT_NEAR(value_at(place(sphere({1, 1, 1}, 1), {{10, 0, 0}, 0.5}), {10.5, 0.5, 0.5}), -0.5, 1e-12);
}

TEST(Solid, ManyThreadsAndBatchesMakeNoDifference) {
  const std::vector<Vec3> x = random_points(3000);
  for (const NamedSolid& s : catalogue()) {
    SCOPED_TRACE(s.name);
    test::expect_equal_for_any_threads([&] { return values_of(s.solid, x); });
    const std::vector<double> one = values_of(s.solid, x);
    for (std::size_t i = 0; i < x.size(); i += 97) EXPECT_EQ(value_at(s.solid, x[i]), one[i]) << s.name;
  }
}

/// Counts the points of its evaluations.
class CountingField final : public ScalarField {
 public:
  mutable std::atomic<std::size_t> asked{0};
  Box3 bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    asked += x.size();
    for (std::size_t i = 0; i < x.size(); ++i) {
      values[i] = norm(x[i]) - 0.8;
      if (!gradients.empty()) gradients[i] = normalized(x[i]);
    }
  }
};

TEST(Solid, FieldsFarAwayAreNotAsked) {
  const auto field = std::make_shared<CountingField>();
  const Solid both = csg::unite(csg::leaf(field), csg::sphere({5, 0, 0}, 1));
  std::vector<Vec3> x = random_points(1000, 1.2);
  for (Vec3& p : x) p.x += 5;
  const std::vector<double> v = values_of(both, x);
  EXPECT_EQ(field->asked, 0u);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_DOUBLE_EQ(v[i], norm(x[i] - Vec3{5, 0, 0}) - 1);
  // The same for a subtracted tool: far from it only the other solid counts.
  const Solid cut = csg::subtract(csg::sphere({5, 0, 0}, 1), csg::leaf(field));
  EXPECT_EQ(values_of(cut, x), values_of(csg::sphere({5, 0, 0}, 1), x));
  EXPECT_EQ(field->asked, 0u);
}

TEST(Solid, FieldsEndAtTheirBounds) {
  /// Inside everywhere below z = 0.1.
  class Ground final : public ScalarField {
   public:
    Box3 bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
    void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
      for (std::size_t i = 0; i < x.size(); ++i) {
        values[i] = x[i].z - 0.1;
        if (!gradients.empty()) gradients[i] = {0, 0, 1};
      }
    }
  };
  const Solid ground = csg::leaf(std::make_shared<Ground>());
  EXPECT_DOUBLE_EQ(value_at(ground, {0, 0, -1.5}), 0.5);
  EXPECT_DOUBLE_EQ(value_at(ground, {0.9, 0, -0.5}), -0.1);
  EXPECT_DOUBLE_EQ(value_at(ground, {0, 0, 0.2}), 0.1);
  EXPECT_EQ(ground.bounds().lower, (Vec3{-1, -1, -1}));
}

TEST(Solid, BadNumbersAreRefused) {
  using namespace csg;
  const double nan = std::nan("");
  const Solid ball = sphere({}, 1);
  EXPECT_THROW(sphere({}, 0), ArgumentError);
  EXPECT_THROW(sphere({}, -1), ArgumentError);
  EXPECT_THROW(sphere({nan, 0, 0}, 1), ArgumentError);
  EXPECT_THROW(sphere({}, kInfinity), ArgumentError);
  EXPECT_THROW(box({0, 0, 0}, {1, 0, 1}), ArgumentError);
  EXPECT_THROW(box({0, 0, 0}, {1, 1, 1}, 0.5), ArgumentError);
  EXPECT_THROW(box({0, 0, 0}, {1, 1, 1}, -0.1), ArgumentError);
  EXPECT_THROW(half_space({0, 0, 0}, 1), ArgumentError);
  EXPECT_THROW(cylinder({}, {0, 0, 1}, 1, 0), ArgumentError);
  EXPECT_THROW(cone({}, {0, 0, 1}, 0, 0, 1), ArgumentError);
  EXPECT_THROW(torus({}, {0, 0, 1}, 1, 1), ArgumentError);
  EXPECT_THROW(capsule({1, 1, 1}, {1, 1, 1}, 1), ArgumentError);
  EXPECT_THROW(unite(ball, sphere({}, 2), -0.1), ArgumentError);
  EXPECT_THROW(unite(ball, sphere({}, 2), nan), ArgumentError);
  EXPECT_THROW(offset(ball, nan), ArgumentError);
  EXPECT_THROW(shell(ball, 0), ArgumentError);
  EXPECT_THROW(scale(ball, 0), ArgumentError);
  EXPECT_THROW(scale(ball, -1), ArgumentError);
  EXPECT_THROW(rotate(ball, {0, 0, 0}, 10), ArgumentError);
  EXPECT_THROW(leaf(nullptr), ArgumentError);
  Solid deep = ball;
  EXPECT_THROW(for (int i = 0; i < 5000; ++i) deep = offset(deep, 0.001), ArgumentError);
  EXPECT_NO_THROW(half_space({1e-200, 0, 0}, 1));
  EXPECT_NO_THROW(half_space({1e300, 1e300, 0}, 1));
}

TEST(Solid, DirectionsNextToAnAxisAreUnit) {
  const Vec3 axis{1, 1, 1};
  for (const Solid& s : {csg::torus({}, axis, 4, 0.4), csg::cone({}, axis, 3, 2, 1), csg::cylinder({}, axis, 1)})
    for (int i = 0; i < 200; ++i) {
      const Vec3 x = axis * (0.013 * i) + Vec3{1e-16, -2e-16, 0} * (i % 7);
      double value = 0;
      Vec3 gradient;
      s.evaluate({&x, 1}, {&value, 1}, {&gradient, 1});
      EXPECT_LE(norm(gradient), 1 + 1e-9) << i;
    }
}

}  // namespace
}  // namespace sansmesh::inline v1
