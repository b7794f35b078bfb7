#include "sansmesh/field/deformed_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "sansmesh/field/map_gaps.h"
#include "support/space_maps.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// (x y + z, z²) in the unit cube.
class TwoQuantities final : public VolumeField {
 public:
  Box3 bounds() const override { return {{0, 0, 0}, {1, 1, 1}}; }
  std::size_t components() const override { return 2; }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 p = is_finite(x[i]) ? x[i] : Vec3{};
      if (!wanted.values.empty()) wanted.values[2 * i] = p.x * p.y + p.z, wanted.values[2 * i + 1] = p.z * p.z;
      if (!wanted.gradients.empty())
        wanted.gradients[2 * i] = {p.y, p.x, 1}, wanted.gradients[2 * i + 1] = {0, 0, 2 * p.z};
      if (!wanted.inside.empty()) wanted.inside[i] = bounds().contains(x[i]);
    }
  }
  void spacing(std::span<const Vec3>, std::span<double> found) const override {
    for (double& s : found) s = 0.1;
  }
  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override {
    for (std::size_t i = 0; i < boxes.size(); ++i)
      found[i] = {boxes[i].lower.x * boxes[i].lower.y + boxes[i].lower.z,
                  boxes[i].upper.x * boxes[i].upper.y + boxes[i].upper.z};
  }
};

std::shared_ptr<const VolumeField> source() { return std::make_shared<const TwoQuantities>(); }

TEST(DeformedVolume, IsTheSourceThroughTheMap) {
  const auto map = std::make_shared<const TwistMap>(0.8);
  const DeformedVolume field(source(), map);
  EXPECT_EQ(field.components(), 2u);
  std::vector<Vec3> x;
  for (int i = 0; i < 300; ++i) x.push_back({-0.5 + (i % 7) * 0.2, -0.6 + (i % 11) * 0.15, -0.1 + (i % 13) * 0.1});
  std::vector<Vec3> u(x.size()), gradients(2 * x.size());
  map->map(x, {u, {}, {}, {}});
  std::vector<double> values(2 * x.size()), expected(2 * x.size());
  std::vector<std::uint8_t> inside(x.size()), expected_inside(x.size());
  field.evaluate(x, {values, gradients, inside});
  source()->evaluate(u, {expected, {}, expected_inside});
  EXPECT_EQ(values, expected);
  EXPECT_EQ(inside, expected_inside);
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<Vec3> low = x, high = x;
    for (Vec3& p : low) p[k] -= 1e-5;
    for (Vec3& p : high) p[k] += 1e-5;
    std::vector<double> a(2 * x.size()), b(2 * x.size());
    field.evaluate(low, {a}), field.evaluate(high, {b});
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(gradients[i][k], (b[i] - a[i]) / 2e-5, 1e-8);
  }
  // The bounds contain all points inside the source.
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_TRUE(!inside[i] || field.bounds().contains(x[i]));
  EXPECT_LT(field.bounds().diagonal(), 4);
}

TEST(DeformedVolume, SpacingAndRangesFollowTheStretch) {
  const AffineSpaceMap half({Vec3{0.5, 0, 0}, Vec3{0, 0.5, 0}, Vec3{0, 0, 0.25}}, {});
  const DeformedVolume field(source(), std::make_shared<const AffineSpaceMap>(half));
  const std::vector<Vec3> x{{1, 1, 1}};
  std::vector<double> spacing(1);
  field.spacing(x, spacing);
  EXPECT_NEAR(spacing[0], 0.2, 1e-12);
  const std::vector<Box3> boxes{{{0.4, 0.4, 0.4}, {0.8, 1, 1.2}}};
  std::vector<ValueRange> found(1);
  field.ranges(boxes, found);
  EXPECT_NEAR(found[0].least, 0.2 * 0.2 + 0.1, 1e-12);
  EXPECT_NEAR(found[0].most, 0.4 * 0.5 + 0.3, 1e-12);
  // For maps without bounds: the range of the whole volume.
  const DeformedVolume twisted(source(), std::make_shared<const TwistMap>(0.8));
  twisted.ranges(boxes, found);
  EXPECT_EQ(found[0].least, 0);
  EXPECT_EQ(found[0].most, 2);
}

TEST(DeformedVolume, GapsAreNotInside) {
  const DeformedVolume field(source(), std::make_shared<const SplitMap>(0.25));
  const std::vector<Vec3> x{{0.1, 0.5, 0.5}, {0.3, 0.5, 0.5}, {NAN, 0, 0}};
  std::vector<double> values(6);
  std::vector<Vec3> gradients(6);
  std::vector<std::uint8_t> inside(3);
  field.evaluate(x, {values, gradients, inside});
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_NEAR(values[2], 0.05 * 0.5 + 0.5, 1e-12);
  EXPECT_EQ(values[4], 0);
  EXPECT_EQ(gradients[4], Vec3{});
  // The gap as a field.
  const MapGaps gap(std::make_shared<const SplitMap>(0.25, 0.2), field.bounds());
  std::vector<double> depth(2);
  std::vector<Vec3> slope(2);
  gap.evaluate(std::vector<Vec3>{{0.1, 0.5, 0.5}, {3, 0, 0}}, depth, slope);
  EXPECT_NEAR(depth[0], 0.15, 1e-12);
  EXPECT_EQ(slope[0], (Vec3{-1, 0, 0}));
  EXPECT_EQ(depth[1], -field.bounds().diagonal());
}

}  // namespace
}  // namespace sansmesh::inline v1
