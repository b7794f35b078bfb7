#include "sansmesh/image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sansmesh::inline v1 {
namespace {

TEST(Image, LevelsComeBack) {
  for (int level = 0; level < 256; ++level) {
    const auto byte = static_cast<std::uint8_t>(level);
    EXPECT_EQ(to_byte(from_byte(byte)), byte);
    for (const float threshold : {1.0f / 512, 0.25f, 0.75f, 511.0f / 512})
      EXPECT_EQ(to_byte(from_byte(byte), threshold), byte) << "dither leaves levels alone";
  }
  EXPECT_EQ(from_byte(0), 0);
  EXPECT_EQ(from_byte(255), 1);
}

TEST(Image, TheNearestLevelIsNoMoreThanHalfAStepOff) {
  std::uint8_t before = 0;
  for (int i = 0; i <= 100000; ++i) {
    const float value = static_cast<float>(i) / 100000;
    const std::uint8_t level = to_byte(value);
    ASSERT_LE(std::abs(255 * value - static_cast<float>(level)), 0.5f + 1e-4f);
    ASSERT_GE(level, before);
    before = level;
  }
}

TEST(Image, WhatIsBeyondIsClampedAndNothingIsZero) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float threshold : {0.01f, 0.5f, 1.0f}) {
    for (const float value : {-1e-30f, -0.5f, -1e30f, -infinity, std::numeric_limits<float>::quiet_NaN(), -0.0f})
      EXPECT_EQ(to_byte(value, threshold), 0);
    for (const float value : {1.0f, 1.0001f, 2.0f, 1e30f, std::numeric_limits<float>::max(), infinity})
      EXPECT_EQ(to_byte(value, threshold), 255);
  }
}

/// Evenly distributed thresholds preserve the mean.
TEST(Image, DitheredLevelsAreRightOnAverage) {
  constexpr int n = 64;
  for (int i = 0; i <= 500; ++i) {
    const float value = static_cast<float>(i) / 500;
    double sum = 0;
    for (int k = 0; k < n; ++k) sum += to_byte(value, (static_cast<float>(k) + 0.5f) / n);
    EXPECT_NEAR(sum / n, 255.0 * static_cast<double>(value), 0.5 / n + 1e-4);
  }
}

TEST(PixelMap, RowsFollowEachOther) {
  PixelMap<int> map(4, 3, 7);
  ASSERT_EQ(map.pixels.size(), 12u);
  map.at(1, 2) = 5;
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(map.pixels[i], i == 9 ? 5 : 7);
  EXPECT_EQ(Image(2, 1).at(1, 0), (Rgba{0, 0, 0, 0}));
  EXPECT_TRUE(DepthMap().pixels.empty());
}

}  // namespace
}  // namespace sansmesh::inline v1
