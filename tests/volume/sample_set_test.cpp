#include "sansmesh/volume/samples/sample_set.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace sansmesh::test {
namespace {

TEST(SampleSet, ContainsInsertedSamplesUntilCleared) {
  std::mt19937 random(5);
  SampleSet set;
  EXPECT_FALSE(set.contains(0));
  for (const std::size_t count : {3u, 1000u, 20u, 5000u, 0u, 300u}) {
    set.clear();
    std::set<std::uint32_t> truth;
    for (std::size_t i = 0; i < count; ++i) {
      const auto sample = static_cast<std::uint32_t>(random() % (2 * count));
      EXPECT_EQ(set.insert(sample), truth.insert(sample).second);
    }
    for (std::uint32_t sample = 0; sample < 2 * count + 10; ++sample)
      ASSERT_EQ(set.contains(sample), truth.count(sample) == 1) << sample;
  }
}

TEST(SampleSet, DistinguishesLargeIndices) {
  SampleSet set;
  EXPECT_TRUE(set.insert(0xffffffffu));
  EXPECT_TRUE(set.insert(0xfffffffeu));
  EXPECT_TRUE(set.insert(0));
  EXPECT_FALSE(set.insert(0xffffffffu));
  EXPECT_FALSE(set.contains(0x7fffffffu));
}

}  // namespace
}  // namespace sansmesh::test
