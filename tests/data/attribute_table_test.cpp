#include "sansmesh/attribute_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// 0, 1, …, n·components − 1 in every type, with one and with three components.
AttributeTable every_type(std::size_t n) {
  AttributeTable table;
  for (int t = 0; t < 10; ++t)
    for (const std::size_t components : {1, 3}) {
      Attribute a{std::string(name_of(static_cast<NumberType>(t))) + " " + std::to_string(components),
                  empty_values(static_cast<NumberType>(t)), components};
      std::visit(
          [&](auto& values) {
            values.resize(n * components);
            std::iota(values.begin(), values.end(), typename std::decay_t<decltype(values)>::value_type{0});
          },
          a.values);
      table.set(std::move(a));
    }
  return table;
}

TEST(AttributeTable, TypesAreThoseOfTheirNumbers) {
  for (int t = 0; t < 10; ++t) {
    const auto type = static_cast<NumberType>(t);
    const Attribute a{"a", empty_values(type)};
    EXPECT_EQ(a.type(), type);
    std::visit(
        [&](const auto& values) {
          using T = typename std::decay_t<decltype(values)>::value_type;
          EXPECT_EQ(number_type_of<T>(), type);
          EXPECT_EQ(sizeof(T), size_of(type));
          EXPECT_EQ(std::is_floating_point_v<T>, is_real(type));
          EXPECT_EQ(std::is_signed_v<T>, is_signed(type));
        },
        a.values);
  }
}

TEST(AttributeTable, NamesAreUnique) {
  AttributeTable table;
  table.set("a", std::vector<float>{1, 2});
  table.set("b", std::vector<std::int8_t>{3, 4, 5, 6}, 2);
  table.set("a", std::vector<double>{7, 8});
  ASSERT_EQ(table.size(), 2u);
  EXPECT_EQ(table[0].name, "a");
  EXPECT_EQ(*table.find<double>("a"), (std::vector<double>{7, 8}));
  EXPECT_EQ(table.find<float>("a"), nullptr);
  EXPECT_EQ(table.find("c"), nullptr);
  EXPECT_TRUE(table.erase("a"));
  EXPECT_FALSE(table.erase("a"));
  EXPECT_EQ(table.size(), 1u);
  // A single array may change its length.
  table.set("b", std::vector<float>{1});
  EXPECT_EQ(table[0].rows(), 1u);
}

TEST(AttributeTable, RefusesWhatFitsNot) {
  AttributeTable table;
  table.set("a", std::vector<float>{1, 2});
  EXPECT_THROW(table.set("", std::vector<float>{1, 2}), ArgumentError);
  EXPECT_THROW(table.set("b", std::vector<float>{1}), ArgumentError);
  EXPECT_THROW(table.set("b", std::vector<float>{1, 2, 3}, 2), ArgumentError);
  EXPECT_THROW(table.set("b", std::vector<float>{1, 2}, 0), ArgumentError);
  EXPECT_EQ(table.size(), 1u);
  EXPECT_NO_THROW(table.check_rows(2, "points"));
  EXPECT_THROW(table.check_rows(3, "points"), ArgumentError);
}

TEST(AttributeTable, RowsMoveAsTheyAreInEveryType) {
  const AttributeTable table = every_type(30);
  std::vector<std::uint8_t> mask(30);
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < 30; ++i) {
    mask[i] = i % 4 == 1;
    if (!mask[i]) kept.push_back(i);
  }
  AttributeTable fewer = table;
  fewer.remove_rows(mask);
  EXPECT_EQ(fewer, table.taken(kept));
  for (const Attribute& a : fewer) {
    EXPECT_EQ(a.type(), table.find(a.name)->type());
    ASSERT_EQ(a.rows(), kept.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      ASSERT_EQ(a.number(i), static_cast<double>(kept[i / a.components] * a.components + i % a.components));
  }
  AttributeTable joined = table.taken(std::vector<std::uint32_t>{0, 1});
  joined.append(table, std::vector<std::uint32_t>{29, 5});
  joined.append_copy(1);
  EXPECT_EQ(joined, table.taken(std::vector<std::uint32_t>{0, 1, 29, 5, 1}));
}

TEST(AttributeTable, RealsAreMixedIntegersAreNot) {
  AttributeTable table = every_type(8);
  table.append_between(2, 6, 0.25f);
  table.append_between(2, 6, 0.75f);
  table.append_between(6, 2, 0.5f);
  table.append_between(3, 4, 0);
  table.append_between(3, 4, 1);
  const double real[] = {3, 5, 4, 3, 4}, whole[] = {2, 6, 6, 3, 4};
  for (const Attribute& a : table) {
    const double width = static_cast<double>(a.components);
    ASSERT_EQ(a.rows(), 13u);
    for (std::size_t r = 0; r < 5; ++r)
      for (std::size_t c = 0; c < a.components; ++c)
        EXPECT_EQ(a.number((8 + r) * a.components + c),
                  (is_real(a.type()) ? real[r] : whole[r]) * width + static_cast<double>(c))
            << a.name;
  }
  const AttributeTable blend = every_type(8).blended(3, std::vector<std::uint32_t>{1, 2, 5, 0, 7, 7},
                                                     std::vector<double>{0.25, 0.25, 0.5, 1, 0, 0});
  for (const Attribute& a : blend) {
    ASSERT_EQ(a.rows(), 2u);
    for (std::size_t c = 0; c < a.components; ++c) {
      const double width = static_cast<double>(a.components), at = static_cast<double>(c);
      EXPECT_EQ(a.number(c), (is_real(a.type()) ? 3.25 : 5) * width + at) << a.name;
      EXPECT_EQ(a.number(a.components + c), at) << a.name;
    }
  }
  const AttributeTable mean =
      every_type(5).means(std::vector<std::uint32_t>{1, 0, 0, 1, 1}, std::vector<double>{1, 1, 3, 2, 2}, 2);
  for (const Attribute& a : mean) {
    ASSERT_EQ(a.rows(), 2u);
    for (std::size_t c = 0; c < a.components; ++c) {
      const double width = static_cast<double>(a.components), at = static_cast<double>(c);
      // Equal weights take the first integer.
      EXPECT_NEAR(a.number(c), (is_real(a.type()) ? 1.75 : 2) * width + at, 1e-6) << a.name;
      EXPECT_NEAR(a.number(a.components + c), (is_real(a.type()) ? 14.0 / 5 : 3) * width + at, 1e-6) << a.name;
    }
  }
}

TEST(AttributeTable, WhatHasNoWeightDoesNotMatter) {
  AttributeTable table;
  table.set("a", std::vector<float>{1, std::numeric_limits<float>::quiet_NaN()});
  table.append_between(0, 1, 0);
  const AttributeTable blend = table.blended(2, std::vector<std::uint32_t>{0, 1}, std::vector<double>{1, 0});
  EXPECT_EQ((*table.find<float>("a"))[2], 1);
  EXPECT_EQ((*blend.find<float>("a"))[0], 1);
}

TEST(AttributeTable, WhatAnotherHasNotIsUnknown) {
  AttributeTable a, b;
  a.set("real", std::vector<double>{1});
  a.set("whole", std::vector<std::int16_t>{2});
  a.set("shared", std::vector<float>{3});
  b.set("real", std::vector<float>{4, 5});  // another type
  b.set("shared", std::vector<float>{6, 7});
  b.set("extra", std::vector<float>{8, 9});
  AttributeTable joined = a;
  joined.append(b, std::vector<std::uint32_t>{1});
  EXPECT_EQ(joined.size(), 3u);
  EXPECT_TRUE(std::isnan((*joined.find<double>("real"))[1]));
  EXPECT_EQ((*joined.find<std::int16_t>("whole"))[1], 0);
  EXPECT_EQ((*joined.find<float>("shared"))[1], 7);
  const AttributeTable* const others[] = {&b};
  EXPECT_EQ(keep_common(a, others), (std::vector<std::string>{"real", "whole"}));
  EXPECT_EQ(a.size(), 1u);
}

TEST(AttributeTable, IntegersOf64BitsLoseNothing) {
  const std::int64_t large = std::numeric_limits<std::int64_t>::max() - 1;
  AttributeTable table;
  table.set("id", std::vector<std::int64_t>{large, large - 1});
  table.append_between(0, 1, 0.3f);
  const AttributeTable mean = table.means(std::vector<std::uint32_t>{0, 0, 0}, std::vector<double>{1, 2, 1}, 1);
  EXPECT_EQ((*table.find<std::int64_t>("id"))[2], large);
  EXPECT_EQ((*mean.find<std::int64_t>("id"))[0], large - 1);
}

TEST(AttributeTable, MeansLeaveOutWhatIsUnknown) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  AttributeTable table;
  table.set("pair", std::vector<double>{1, nan, 4, 6, nan, nan}, 2);
  const AttributeTable mean = table.means(std::vector<std::uint32_t>{0, 0, 1}, std::vector<double>{1, 2, 1}, 2);
  const std::vector<double>& pair = *mean.find<double>("pair");
  EXPECT_EQ(pair[0], 3);
  EXPECT_EQ(pair[1], 6);
  EXPECT_TRUE(std::isnan(pair[2]) && std::isnan(pair[3]));
}

/// Each part is unchanged, with unknown numbers for missing arrays.
TEST(AttributeTable, RowsOfSeveralTables) {
  const AttributeTable every = every_type(5), none;
  const AttributeTable* const tables[] = {&none, &every, &none, &every};
  const std::size_t rows[] = {2, 5, 0, 5};
  const AttributeTable all = join_rows(tables, rows);
  ASSERT_EQ(all.size(), every.size());
  for (const Attribute& a : all) {
    ASSERT_EQ(a.rows(), 12u);
    const Attribute& part = *every.find(a.name);
    EXPECT_EQ(a.type(), part.type());
    for (std::size_t i = 0; i < 2 * a.components; ++i) {
      if (is_real(a.type()))
        EXPECT_TRUE(std::isnan(a.number(i))) << a.name;
      else
        EXPECT_EQ(a.number(i), 0) << a.name;
    }
    for (std::size_t i = 0; i < part.size(); ++i)
      for (const std::size_t first : {2, 7}) EXPECT_EQ(a.number(first * a.components + i), part.number(i)) << a.name;
  }
}

TEST(AttributeTable, RowsOfTablesThatAgreeOnNamesOnly) {
  AttributeTable a, b, c;
  a.set("id", std::vector<std::uint8_t>{1, 2});
  b.set("id", std::vector<float>{3, 4, 5});
  b.set("height", std::vector<float>{6, 7, 8});
  c.set("id", std::vector<std::uint8_t>{9, 10}, 2);
  const AttributeTable* const tables[] = {&a, &b, &c};
  const std::size_t rows[] = {2, 3, 1};
  const AttributeTable all = join_rows(tables, rows);
  EXPECT_EQ(*all.find<std::uint8_t>("id"), (std::vector<std::uint8_t>{1, 2, 0, 0, 0, 0}));
  const std::vector<float>& height = *all.find<float>("height");
  EXPECT_EQ(height[3], 7);
  EXPECT_TRUE(std::isnan(height[1]) && std::isnan(height[5]));
  EXPECT_TRUE(join_rows({}, {}).empty());
}

}  // namespace
}  // namespace sansmesh::inline v1
