#include "sansmesh/flow/seed_curve.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

TEST(SeedCurve, IsByLength) {
  const SeedCurve open{{{0, 0, 0}, {3, 0, 0}, {3, 0, 0}, {3, 1, 0}}};
  EXPECT_EQ(open.length(), 4);
  EXPECT_EQ(open.at(1.5), (Vec3{1.5, 0, 0}));
  EXPECT_EQ(open.at(3), (Vec3{3, 0, 0}));
  EXPECT_EQ(open.at(3.25), (Vec3{3, 0.25, 0}));
  EXPECT_EQ(open.at(-1), open.points.front());
  EXPECT_EQ(open.at(4), open.points.back());
  EXPECT_EQ(open.at(9), open.points.back());
}

TEST(SeedCurve, ReturnsWhereItIsClosed) {
  const SeedCurve square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, true};
  EXPECT_EQ(square.length(), 4);
  EXPECT_EQ(square.at(3.5), (Vec3{0, 0.5, 0}));
  EXPECT_EQ(square.at(4), square.points.front());
  EXPECT_EQ(square.at(5.25), square.at(1.25));
  EXPECT_EQ(square.at(-0.5), square.at(3.5));
  const std::vector<double> s{0, 0.5, 2.75, 3.99};
  const std::vector<Vec3> many = square.at(s);
  for (std::size_t i = 0; i < s.size(); ++i) EXPECT_EQ(many[i], square.at(s[i]));
}

TEST(SeedCurve, RefusesWhatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const SeedCurve& bad : {SeedCurve{}, SeedCurve{{{0, 0, 0}}}, SeedCurve{{{0, 0, 0}, {1, 0, 0}}, true},
                               SeedCurve{{{1, 2, 3}, {1, 2, 3}}}, SeedCurve{{{0, 0, 0}, {nan, 0, 0}}}}) {
    EXPECT_THROW(bad.validate(), ArgumentError);
    EXPECT_THROW(bad.at(0), ArgumentError);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
