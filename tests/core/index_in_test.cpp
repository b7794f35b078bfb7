// Conversion of real numbers to integers: equal to a cast where that is defined, otherwise saturating.
#include "sansmesh/core/index_in.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace sansmesh::inline v1 {
namespace {

template <class Pair>
class IndexIn : public ::testing::Test {};

template <class W, class R>
struct Types {
  using Whole = W;
  using Real = R;
};
using All =
    ::testing::Types<Types<int, float>, Types<int, double>, Types<std::uint32_t, float>, Types<std::uint32_t, double>,
                     Types<std::size_t, float>, Types<std::size_t, double>, Types<std::int64_t, float>,
                     Types<std::int64_t, double>, Types<std::uint8_t, float>, Types<std::int8_t, double>>;
TYPED_TEST_SUITE(IndexIn, All);

TYPED_TEST(IndexIn, AgreesWithACastWithinTheRange) {
  using Whole = typename TypeParam::Whole;
  using Real = typename TypeParam::Real;
  for (int i = 0; i <= 4 * 100; ++i) {
    const Real x = static_cast<Real>(i) / 4;
    EXPECT_EQ(index_in<Whole>(x, 0, 100), static_cast<Whole>(x)) << x;
  }
}

TYPED_TEST(IndexIn, StaysInTheRangeWhateverTheNumber) {
  using Whole = typename TypeParam::Whole;
  using Real = typename TypeParam::Real;
  using Limits = std::numeric_limits<Whole>;
  const Real inf = std::numeric_limits<Real>::infinity(), nan = std::numeric_limits<Real>::quiet_NaN();
  for (const auto& [first, last] : {std::pair<Whole, Whole>{0, 100},
                                    {3, 3},
                                    {0, Limits::max()},
                                    {Limits::min(), Limits::max()},
                                    {1, Limits::max() - 1}}) {
    EXPECT_EQ(index_in<Whole>(nan, first, last), first);
    EXPECT_EQ(index_in<Whole>(-inf, first, last), first);
    EXPECT_EQ(index_in<Whole>(inf, first, last), last);
    EXPECT_EQ(index_in<Whole>(std::numeric_limits<Real>::max(), first, last), last);
    EXPECT_EQ(index_in<Whole>(std::numeric_limits<Real>::lowest(), first, last), first);
    // Powers of two and their neighbours, including rounded limits.
    for (int e = -3; e < 70; ++e)
      for (const Real sign : {Real(1), Real(-1)})
        for (const Real to : {Real(0), Real(1), inf}) {
          const Real power = sign * std::exp2(Real(e)), x = to == 1 ? power : std::nextafter(power, sign * to);
          const Whole found = index_in<Whole>(x, first, last);
          EXPECT_GE(found, first) << x;
          EXPECT_LE(found, last) << x;
          if (static_cast<Real>(found) != x && x > static_cast<Real>(first) && x < static_cast<Real>(last)) {
            EXPECT_LT(std::abs(static_cast<Real>(found) - x), 1) << x;
          }
        }
  }
}

TYPED_TEST(IndexIn, TheWholePartIsTheNearestThatTheTypeHolds) {
  using Whole = typename TypeParam::Whole;
  using Real = typename TypeParam::Real;
  using Limits = std::numeric_limits<Whole>;
  const Real inf = std::numeric_limits<Real>::infinity();
  EXPECT_EQ(whole_part<Whole>(std::numeric_limits<Real>::quiet_NaN()), 0);
  EXPECT_EQ(whole_part<Whole>(inf), Limits::max());
  EXPECT_EQ(whole_part<Whole>(-inf), Limits::min());
  EXPECT_EQ(whole_part<Whole>(Real(7.9)), 7);
  EXPECT_EQ(whole_part<Whole>(Real(-0.9)), 0);
  if constexpr (std::is_signed_v<Whole>) {
    EXPECT_EQ(whole_part<Whole>(Real(-7.9)), -7);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
