#include "sansmesh/deform/maps/folds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "deform/handle_sets.h"
#include "sansmesh/error.h"

namespace sansmesh::test {
namespace {

/// Folded where two balls are turned inside out: x is reversed there.
class TwoFolds final : public SpaceMap {
 public:
  explicit TwoFolds(bool gap = false) : gap_(gap) {}
  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool inside = norm(x[i] - Vec3{-0.5, 0, 0}) < 0.3 || norm(x[i] - Vec3{0.5, 0.2, 0.1}) < 0.2;
      wanted.positions[i] = x[i];
      wanted.jacobians[i] = {Vec3{inside ? -2.0 : 1.0, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
      if (!wanted.gaps.empty()) wanted.gaps[i] = x[i].x;
    }
  }
  bool has_gaps() const override { return gap_; }

 private:
  bool gap_;
};

const Box3 kFoldBox{{-1, -1, -1}, {1, 1, 1}};

TEST(Folds, AreFoundWithTheirShareAndPlace) {
  Progress progress;
  const FoldReport report = find_folds(TwoFolds(), kFoldBox, {61, 61, 61}, progress);
  const double large = 4.0 / 3 * std::acos(-1.0) * 0.027 / 8, small = 4.0 / 3 * std::acos(-1.0) * 0.008 / 8;
  EXPECT_NEAR(report.share / (large + small), 1, 0.05);
  EXPECT_EQ(report.least, -2);
  ASSERT_EQ(report.folds.size(), 2u);
  EXPECT_NEAR(report.folds[0].share / large, 1, 0.05);
  EXPECT_NEAR(report.folds[1].share / small, 1, 0.1);
  EXPECT_LT(norm(report.folds[0].center - Vec3{-0.5, 0, 0}), 0.01);
  EXPECT_LT(norm(report.folds[1].center - Vec3{0.5, 0.2, 0.1}), 0.01);
  EXPECT_NEAR(report.folds[0].box.size().x, 0.6, 0.04);
  EXPECT_EQ(report.folds[0].least, -2);
  const auto* values = report.determinants.point_arrays.find<float>("determinant");
  ASSERT_NE(values, nullptr);
  EXPECT_EQ(values->size(), 61u * 61 * 61);
  // Not in a gap.
  const FoldReport half = find_folds(TwoFolds(true), kFoldBox, {61, 61, 61}, progress);
  EXPECT_EQ(half.folds.size(), 1u);
  EXPECT_NEAR(half.share / (2 * large), 1, 0.06);
}

TEST(Folds, OfADeformationAreWhereItIsPushedThroughItself) {
  // A handle is pushed past others that stay.
  std::vector<Handle> handles;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) {
        Handle h;
        h.p = h.q = {x, y, z};
        handles.push_back(h);
      }
  Handle pushed, passed;
  passed.p = passed.q = {0.5, 0, 0};
  handles.push_back(passed);
  pushed.p = {0, 0, 0}, pushed.q = {0.1, 0, 0};
  handles.push_back(pushed);
  Progress progress;
  const FoldReport little = find_folds(MlsDeformation(handles, {}), kFoldBox, {20, 20, 20}, progress);
  EXPECT_EQ(little.share, 0);
  EXPECT_GT(little.least, 0);
  handles.back().q = {0.8, 0, 0};
  const FoldReport far = find_folds(MlsDeformation(handles, {}), kFoldBox, {20, 20, 20}, progress);
  EXPECT_GT(far.share, 0.005);
  EXPECT_LT(far.share, 0.3);
  ASSERT_GE(far.folds.size(), 1u);
  EXPECT_GT(far.folds[0].center.x, 0.3);
  EXPECT_TRUE(far.folds[0].box.contains({0.65, 0, 0}));  // between the two
  EXPECT_LT(far.least, 0);
}

TEST(Folds, NeedALatticeInABox) {
  Progress progress;
  EXPECT_THROW(find_folds(TwoFolds(), {{0, 0, 0}, {0, 1, 1}}, {5, 5, 5}, progress), ArgumentError);
  EXPECT_THROW(find_folds(TwoFolds(), kFoldBox, {5, 1, 5}, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::test
