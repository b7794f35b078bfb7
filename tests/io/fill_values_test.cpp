// Fill values: found if they are separate, kept if a quantity passes through them.
#include "sansmesh/io/grids/fill_values.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

template <class T>
GridBlock points_with(std::vector<T> values, std::size_t components = 1) {
  GridBlock block;
  block.kind = GridKind::scattered;
  block.points.resize(values.size() / components);
  block.point_arrays.set("s", std::move(values), components);
  return block;
}

template <class T>
GridData data_with(std::vector<T> values, std::size_t components = 1) {
  GridData data;
  data.blocks.push_back(points_with(std::move(values), components));
  return data;
}

std::size_t missing(const GridData& data, std::size_t block = 0) {
  const Attribute& a = *data.blocks[block].point_arrays.find("s");
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += std::isnan(a.number(i));
  return count;
}

std::vector<double> ramp(std::size_t n, double from, double to) {
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i)
    values[i] = from + (to - from) * static_cast<double>(i) / static_cast<double>(n - 1);
  return values;
}

TEST(FillValues, UsualOnesThatStandApartAreMissing) {
  for (const double fill :
       {9.96921e36, 9.969209968386869e36, 9.97e36, 3.4e38, 3.4028234663852886e38, std::numeric_limits<double>::max(),
        -1e20, 1e30, -1e34, 1.70141e38, -999.0, -999.25, -9999.0}) {
    std::vector<double> values = ramp(30, 0, 10);
    values[13] = fill;
    GridData data = data_with(values);
    const std::vector<std::string> lines = mark_fill_values(data, {});
    ASSERT_EQ(lines.size(), 1u) << fill;
    EXPECT_NE(lines[0].find("1 of 30 values of s"), std::string::npos) << lines[0];
    EXPECT_EQ(missing(data), 1u);
    EXPECT_TRUE(std::isnan(data.blocks[0].point_arrays.find("s")->number(13)));
  }
}

TEST(FillValues, WhatAQuantityPassesThroughIsNone) {
  // Steps of 10 from −20000 on: −9999 is between its neighbours.
  std::vector<double> values = ramp(4001, -20000, 20000);
  values[1000] = -9999;
  values.push_back(-999);
  GridData data = data_with(values);
  EXPECT_TRUE(mark_fill_values(data, {}).empty());
  // At the end of the range, but closer to the rest than the range of the rest.
  data = data_with(std::vector<double>{-999, -900, -800, -700, -600, -500, 0, 100, 500, 1000});
  EXPECT_TRUE(mark_fill_values(data, {}).empty());
  // Surrounded by other numbers.
  values = ramp(2000, 0, 1);
  for (std::size_t i = 0; i < 5; ++i) values[i] = -9999 + 100.0 * static_cast<double>(i);
  data = data_with(values);
  EXPECT_TRUE(mark_fill_values(data, {}).empty());
  // A large number that is not a fill value.
  values = ramp(30, 0, 1), values[3] = 1.23e37;
  data = data_with(values);
  EXPECT_TRUE(mark_fill_values(data, {}).empty());
}

TEST(FillValues, PowersOfTenAreMeasuredToo) {
  const auto layers = [](const std::vector<double>& levels) {
    std::vector<double> values;
    for (const double level : levels) values.insert(values.end(), 500, level);
    return data_with(values);
  };
  // A plasma in vacuum; a mantle below sticky air, with a lithosphere above; a doping.
  for (GridData data : {layers({0, 1e20}), layers({1e18, 1e21}), layers({1e18, 1e21, 1e24}), layers({1e16, 2e16, 1e20}),
                        layers({300, 1e20, 1e24})})
    EXPECT_TRUE(mark_fill_values(data, {}).empty());
  GridData data = layers({250, 280, 300, 1e20});
  EXPECT_EQ(mark_fill_values(data, {}).size(), 1u);
  EXPECT_EQ(missing(data), 500u);
}

TEST(FillValues, AWideRangeDoesNotHideManyOfThem) {
  const auto with_fills = [](double from, double to) {
    std::vector<double> values = ramp(2000, from, to);
    for (std::size_t i = 0; i < 2000; i += 20) values[i] = -999;
    return data_with(values);
  };
  for (const auto& [from, to] : {std::pair{100.0, 1300.0}, {-500.0, 600.0}, {300.0, 900.0}}) {
    GridData data = with_fills(from, to);
    EXPECT_EQ(mark_fill_values(data, {}).size(), 1u);
    EXPECT_EQ(missing(data), 100u);
  }
  // Closer than that, a note names it.
  GridData data = with_fills(-800, 1300);
  const std::vector<std::string> lines = mark_fill_values(data, {});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0], "-999 occurs 100 times in s and may mark missing values: then set `fill_value`");
  EXPECT_EQ(missing(data), 0u);
}

TEST(FillValues, LeastIntegersAreMissing) {
  std::vector<std::int64_t> counts(50, 7);
  counts[3] = std::numeric_limits<std::int64_t>::min() + 2;  // NetCDF's
  GridData data = data_with(counts);
  EXPECT_EQ(mark_fill_values(data, {}).size(), 1u);
  EXPECT_EQ(missing(data), 1u);
}

TEST(FillValues, NoOtherSingleNumberDecides) {
  std::vector<double> values = ramp(200, 0, 1);
  values[5] = 1e12, values[7] = -9999, values[8] = -9999;
  GridData data = data_with(values);
  EXPECT_EQ(mark_fill_values(data, {}).size(), 1u);
  EXPECT_EQ(missing(data), 2u);
}

TEST(FillValues, SamplesThatMissAComponentAreMissing) {
  std::vector<float> values(60);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 7);
  values[31] = 1e20f;
  GridData data = data_with(values, 3);
  const std::vector<std::string> lines = mark_fill_values(data, {});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("1 of 20 values of s"), std::string::npos) << lines[0];
  EXPECT_EQ(missing(data), 3u);
  EXPECT_TRUE(data.blocks[0].point_arrays.find("s")->as<float>());
}

TEST(FillValues, IntegersBecomeRealWhereSomeAreMissing) {
  std::vector<std::int16_t> heights(50);
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = static_cast<std::int16_t>(10 * i);
  GridData data = data_with(heights);
  EXPECT_TRUE(mark_fill_values(data, {}).empty());
  EXPECT_EQ(data.blocks[0].point_arrays.find("s")->type(), NumberType::i16);
  heights[4] = -9999, heights[5] = -32767;
  data = data_with(heights);
  EXPECT_EQ(mark_fill_values(data, {}).size(), 2u);
  EXPECT_EQ(data.blocks[0].point_arrays.find("s")->type(), NumberType::f32);
  EXPECT_EQ(missing(data), 2u);
  EXPECT_EQ(data.blocks[0].point_arrays.find("s")->number(6), 60);
}

TEST(FillValues, BlocksAreJudgedTogetherAndHiddenPointsNotAtAll) {
  std::vector<double> values = ramp(30, 0, 10);
  values[3] = -999;
  GridData data;
  data.blocks = {points_with(values), points_with(ramp(500, -2000, 0))};
  EXPECT_TRUE(mark_fill_values(data, {}).empty());
  data.blocks[1].hidden_points.assign(500, 1);
  EXPECT_EQ(mark_fill_values(data, {}).size(), 1u);
  EXPECT_EQ(missing(data), 1u);
}

TEST(FillValues, AreWhatTheUserSaysTheyAre) {
  std::vector<double> values = ramp(11, 0, 10);
  FillValueOptions options;
  options.values = {0, 4};
  GridData data = data_with(values);
  EXPECT_EQ(mark_fill_values(data, options).size(), 2u);
  EXPECT_EQ(missing(data), 2u);

  options = {};
  options.usual = false;
  values[3] = 9.96921e36;
  data = data_with(values);
  EXPECT_TRUE(mark_fill_values(data, options).empty());
  EXPECT_EQ(missing(data), 0u);
  options.values = {9.96921e36, -5};
  const std::vector<std::string> lines = mark_fill_values(data, options);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NE(lines[1].find("no array has the value -5"), std::string::npos) << lines[1];
  EXPECT_EQ(missing(data), 1u);

  options.values = {std::nan("")};
  EXPECT_THROW(mark_fill_values(data, options), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
