// Solids for property tests: each primitive, each operation, and trees of several.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "sansmesh/csg/solid.h"

namespace sansmesh::test {

struct NamedSolid {
  std::string name;
  Solid solid;
  bool exact = false;  ///< an exact signed distance everywhere
};

/// A smooth field that is not a distance: an ellipsoid-like quadric over its slope, defined in a box.
class QuadricField final : public ScalarField {
 public:
  Box3 bounds() const override { return {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 p = x[i];
      values[i] = 0.5 * (p.x * p.x + 1.5 * p.y * p.y + 2 * p.z * p.z - 1);
      if (!gradients.empty()) gradients[i] = {p.x, 1.5 * p.y, 2 * p.z};
    }
  }
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 p = x[i];
      const double value = 0.5 * (p.x * p.x + 1.5 * p.y * p.y + 2 * p.z * p.z - 1);
      const double change = norm(Vec3{p.x, 1.5 * p.y, 2 * p.z}) * radius + radius * radius;
      found[i] = {value - change, value + change};
    }
  }
};

inline std::vector<NamedSolid> primitives() {
  using namespace csg;
  return {
      {"sphere", sphere({0.2, -0.1, 0.3}, 0.9), true},
      {"half-space", half_space({1, 2, -1}, 0.3), true},
      {"box", box({-1, -0.5, -0.7}, {0.8, 0.9, 0.6})},
      {"rounded box", box({-1, -0.5, -0.7}, {0.8, 0.9, 0.6}, 0.25), true},
      {"pipe", cylinder({0.1, 0.2, 0}, {1, 1, 3}, 0.6), true},
      {"cylinder", cylinder({0.1, 0.2, 0}, {1, -1, 2}, 0.6, 1.5)},
      {"cone", cone({0, 0.1, 0}, {0.2, 1, 0.4}, 0.9, 0, 1.4)},
      {"frustum", cone({0, 0.1, 0}, {-0.2, 1, 0.4}, 0.4, 0.9, 0.7)},
      {"torus", torus({0.1, 0, 0}, {1, 0, 2}, 0.9, 0.3), true},
      {"capsule", capsule({-0.6, 0.2, 0}, {0.5, -0.4, 0.7}, 0.4), true},
      {"field", leaf(std::make_shared<QuadricField>())},
  };
}

inline std::vector<NamedSolid> catalogue() {
  using namespace csg;
  std::vector<NamedSolid> all = primitives();
  const Solid ball = sphere({0.2, 0, 0}, 0.8), block = box({-0.9, -0.6, -0.5}, {0.4, 0.7, 0.6});
  const Solid bar = cylinder({0, 0, 0}, {0, 1, 1}, 0.3, 3);
  const std::vector<NamedSolid> more = {
      {"union", unite(ball, block)},
      {"intersection", intersect(ball, block)},
      {"difference", subtract(block, ball)},
      {"complement", complement(block)},
      {"blended union", unite(ball, bar, 0.3)},
      {"blended intersection", intersect(ball, block, 0.2)},
      {"blended difference", subtract(block, bar, 0.25)},
      {"blend of blends", unite(subtract(block, bar, 0.2), torus({}, {0, 0, 1}, 1, 0.25), 0.3)},
      {"grown", offset(subtract(block, bar), 0.2)},
      {"shrunk", offset(unite(block, bar), -0.15)},
      {"shell", shell(block, 0.2)},
      {"shell inside", shell(unite(ball, block, 0.2), 0.1, ShellSide::inside)},
      {"shell outside", shell(ball, 0.3, ShellSide::outside)},
      {"shell of a complement", shell(complement(ball), 0.3, ShellSide::inside)},
      {"moved", translate(rotate(block, {1, 2, 3}, 40), {0.3, -0.2, 0.4})},
      {"scaled", scale(subtract(ball, bar), 1.6, {0.2, 0.1, 0})},
      {"mirrored", mirror(cone({0.5, 0, 0}, {1, 1, 0}, 0.8, 0.1, 1), {1, 0.2, 0.3}, 0.1)},
      {"placed", place(rotate(box({0, 0, 0}, {8, 4, 6}, 1), {0, 0, 1}, 20), {{-0.8, -0.5, -0.4}, 0.2})},
      {"field less bar", subtract(leaf(std::make_shared<QuadricField>()), bar)},
      {"field with field", unite(scale(leaf(std::make_shared<QuadricField>()), 0.7),
                                 translate(scale(leaf(std::make_shared<QuadricField>()), 0.4), {1, 1, 0.5}), 0.2)},
      {"solid as field", leaf(std::make_shared<Solid>(subtract(block, ball)))},
      {"turned field grown", offset(rotate(leaf(std::make_shared<QuadricField>()), {1, 1, 0}, 30), 0.1)},
  };
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

inline std::vector<Vec3> random_points(std::size_t count, double reach = 2, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::vector<Vec3> x(count);
  for (Vec3& p : x) {
    p.x = coordinate(random);
    p.y = coordinate(random);
    p.z = coordinate(random);
  }
  return x;
}

inline std::vector<double> values_of(const ScalarField& field, const std::vector<Vec3>& x) {
  std::vector<double> v(x.size());
  field.evaluate(x, v);
  return v;
}

inline double value_at(const ScalarField& field, const Vec3& x) { return values_of(field, {x})[0]; }

}  // namespace sansmesh::test
