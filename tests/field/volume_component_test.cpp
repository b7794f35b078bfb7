#include "sansmesh/field/volume_component.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// (x y, z², −x) and its derivatives.
class Wind : public VolumeField {
 public:
  Box3 bounds() const override { return {{0, 0, 0}, {1, 1, 1}}; }
  std::size_t components() const override { return 3; }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3& p = x[i];
      const Vec3 value{p.x * p.y, p.z * p.z, -p.x};
      const Vec3 gradient[3] = {{p.y, p.x, 0}, {0, 0, 2 * p.z}, {-1, 0, 0}};
      for (std::size_t k = 0; k < 3; ++k) {
        if (!wanted.values.empty()) wanted.values[3 * i + k] = value[k];
        if (!wanted.gradients.empty()) wanted.gradients[3 * i + k] = gradient[k];
      }
      if (!wanted.inside.empty()) wanted.inside[i] = bounds().contains(p);
    }
  }
  void spacing(std::span<const Vec3>, std::span<double> found) const override {
    for (double& s : found) s = 0.1;
  }
};

TEST(VolumeComponent, TakesOneOrTheLength) {
  const Wind wind;
  const std::vector<Vec3> x{{0.3, 0.4, 0.5}, {0.9, 0.1, 0.2}, {2, 0, 0}};
  std::vector<double> all(9), found(3);
  std::vector<Vec3> gradients(3);
  std::vector<std::uint8_t> inside(3);
  wind.evaluate(x, {all});
  for (std::size_t k = 0; k < 3; ++k) {
    const VolumeComponent one(wind, k);
    EXPECT_EQ(one.components(), 1u);
    one.evaluate(x, {found, {}, inside});
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(found[i], all[3 * i + k]);
    EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 1, 0}));
  }
  const VolumeComponent length(wind);
  length.evaluate(x, {found, gradients});
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found[i], std::hypot(all[3 * i], all[3 * i + 1], all[3 * i + 2]), 1e-15);
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<Vec3> sides{x[i], x[i]};
      sides[0][k] -= 1e-5, sides[1][k] += 1e-5;
      std::vector<double> values(2);
      length.evaluate(sides, {values});
      EXPECT_NEAR(gradients[i][k], (values[1] - values[0]) / 2e-5, 1e-8);
    }
  }
  // Gradients only; zero where the vector vanishes.
  std::vector<Vec3> alone(3);
  length.evaluate(x, {{}, alone});
  EXPECT_EQ(alone, gradients);
  const std::vector<Vec3> still{{0, 0.5, 0}};
  length.evaluate(still, {{}, std::span(alone).first(1)});
  EXPECT_EQ(alone[0], Vec3{});
  EXPECT_THROW(VolumeComponent(wind, 3), ArgumentError);
}

TEST(VolumeField, RangesAreUnknownUnlessAFieldKnowsThem) {
  const Wind wind;
  const std::vector<Box3> boxes{wind.bounds()};
  std::vector<ValueRange> found(1);
  wind.ranges(boxes, found);
  EXPECT_EQ(found[0].least, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(found[0].most, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace sansmesh::inline v1
