#include "sansmesh/core/number_words.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace sansmesh::inline v1 {
namespace {

TEST(NumberWords, DigitsStandInGroupsOfThree) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(1234567), "1,234,567");
  EXPECT_EQ(grouped(std::numeric_limits<std::uint64_t>::max()), "18,446,744,073,709,551,615");
}

TEST(NumberWords, OnlyOneIsSingular) {
  EXPECT_EQ(counted(0, "sample"), "0 samples");
  EXPECT_EQ(counted(1, "sample"), "1 sample");
  EXPECT_EQ(counted(2, "sample"), "2 samples");
  EXPECT_EQ(counted(20001, "sample"), "20,001 samples");
}

}  // namespace
}  // namespace sansmesh::inline v1
