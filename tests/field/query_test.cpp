// Common interface of batch queries: the results equal those of the overridden functions, and only requested ones are
// computed.
#include "sansmesh/query.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/space_map.h"
#include "sansmesh/vector_field.h"
#include "support/space_maps.h"

namespace sansmesh::test {
namespace {

constexpr Vec3 kSlope{1, -2, 0.5};

/// Linear field, defined for x >= 0.
class HalfField final : public ScalarField {
 public:
  Box3 bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) values[i] = dot(kSlope, x[i]);
    for (Vec3& g : gradients) g = kSlope;
  }
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override {
    evaluate(x, values, gradients);
    for (std::size_t i = 0; i < x.size(); ++i) inside[i] = x[i].x >= 0;
  }
};

/// Flow along x that accelerates until time 2.
class Breeze final : public VectorField {
 public:
  Box3 bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
  void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<Vec3> vectors,
                std::span<std::uint8_t> inside, std::span<Jacobian> jacobian = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) vectors[i] = {x[i].x + t[i], 0, 0}, inside[i] = t[i] <= 2;
    for (Jacobian& j : jacobian) j = {Vec3{1, 0, 0}, Vec3{}, Vec3{}};
  }
};

const std::vector<Vec3> kPlaces{{0.5, 0, 0}, {-0.5, 0.25, 1}, {0, 1, 0}};

TEST(Query, ScalarsAndWhereTheyAreDefined) {
  const HalfField field;
  std::vector<double> values(3);
  std::vector<Vec3> gradients(3);
  std::vector<std::uint8_t> inside(3);
  field.query({.points = kPlaces}, {values, gradients, inside});
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(values[i], dot(kSlope, kPlaces[i]));
  EXPECT_EQ(gradients[1], kSlope);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 0, 1}));
  inside.assign(3, 7);
  field.query({.points = kPlaces}, {.inside = inside});
  EXPECT_EQ(inside[1], 0);
  EXPECT_THROW(field.query({.points = kPlaces}, {.values = std::span(values).first(2)}), ArgumentError);
}

TEST(Query, VectorsAtTheirMoments) {
  const Breeze wind;
  std::vector<Vec3> values(3);
  std::vector<std::uint8_t> inside(3);
  wind.query({.points = kPlaces, .times = std::vector<double>{0, 1, 3}}, {.values = values, .inside = inside});
  EXPECT_EQ(values[1].x, 0.5);
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 1, 0}));
  wind.query({.points = kPlaces, .times = std::vector<double>{2}}, {.values = values});
  EXPECT_EQ(values[0].x, 2.5);
  wind.query({.points = kPlaces}, {.values = values});
  EXPECT_EQ(values[0].x, 0.5);
  std::vector<Jacobian> gradients(3);
  wind.query({.points = kPlaces}, {.gradients = gradients});
  EXPECT_EQ(divergence(gradients[2]), 1);
  EXPECT_THROW(wind.query({.points = kPlaces, .times = std::vector<double>{0, 1}}, {values}), ArgumentError);
}

/// Undefined at one point.
class Hole final : public SpaceMap {
 public:
  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < wanted.positions.size(); ++i)
      wanted.positions[i] = x[i] == kPlaces[0] ? Vec3{kNone, kNone, kNone} : x[i];
    for (std::size_t i = 0; i < wanted.gaps.size(); ++i) wanted.gaps[i] = x[i] == kPlaces[1] ? 1 : -1;
  }
  bool has_gaps() const override { return true; }
};

TEST(Query, MapsAndWhereSomethingComesFromSomewhere) {
  const AffineSpaceMap map({Vec3{2, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, {0, 0, 3});
  std::vector<Vec3> values(3);
  std::vector<Jacobian> gradients(3);
  std::vector<std::uint8_t> inside(3);
  map.query({.points = kPlaces}, {values, gradients, inside});
  EXPECT_EQ(values[0], (Vec3{1, 0, 3}));
  EXPECT_EQ(gradients[0][0], (Vec3{2, 0, 0}));
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 1, 1}));
  Hole().query({.points = kPlaces}, {.inside = inside});
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 0, 1}));
}

}  // namespace
}  // namespace sansmesh::test
