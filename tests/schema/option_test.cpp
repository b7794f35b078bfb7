#include "sansmesh/option.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sansmesh/error.h"

namespace sansmesh::test {
namespace {

enum class Kernel { compact, gaussian };
constexpr std::string_view kKernels[] = {"compact", "gaussian"};

/// A ratio, for example 3:4.
struct Ratio {
  int over = 1, under = 1;
  bool operator==(const Ratio&) const = default;
};
std::string text_of_option(const Ratio& r) { return std::to_string(r.over) + ":" + std::to_string(r.under); }
void option_of_text(std::string_view word, Ratio& to) {
  const std::size_t colon = word.find(':');
  if (colon == std::string_view::npos)
    throw ArgumentError(ArgumentFault{.field = {}, .value = std::string(word), .allowed = "two numbers", .remedy = {}});
  to.over = std::stoi(std::string(word.substr(0, colon)));
  to.under = std::stoi(std::string(word.substr(colon + 1)));
}

struct Inner {
  int width = 800;
  static constexpr OptionRow rows[] = {option<&Inner::width>({.text = "Pixels", .range = {1, 16384}})};
};

struct Options {
  bool clean = true;
  std::optional<int> rounds = {};
  double strength = 0.6;
  std::optional<double> angle = {};
  bool creases = false;
  Kernel kernel = Kernel::compact;
  std::optional<Vec3> at = {};
  std::vector<std::string> names = {};
  Ratio ratio = {};
  std::vector<Ratio> ratios = {};
  Inner inner = {};

  static const OptionSchema& schema() {
    static constexpr OptionRow rows[] = {
        option<&Options::clean>({.text = "Clean"}),
        option<&Options::rounds>({.text = "Rounds", .from_data = "10", .range = {1, 100}, .excludes = "strength"}),
        option<&Options::strength>({.text = "Strength", .range = positive(0.65)}),
        option<&Options::angle>({.text = "Angle", .unit = "degrees", .needs = "creases"}),
        option<&Options::creases>({.text = "Creases"}),
        option<&Options::kernel>({.text = "Weights", .choices = kKernels, .name = "weights"}),
        option<&Options::at>({.text = "Where"}),
        option<&Options::names>({.text = "Names"}),
        option<&Options::ratio>({.text = "Ratio"}),
        option<&Options::ratios>({.text = "Ratios"}),
        option_group<&Options::inner>(Inner::rows)};
    static constexpr OptionSchema schema{rows};
    return schema;
  }
};

/// Message of the error; empty if there is none.
template <class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const ArgumentError& error) {
    return error.what();
  }
  return "";
}

void set(Options& options, std::string_view name, const OptionValue& value) {
  for_each_option(Options::schema(), &options, [&](const OptionRow& row, void* owner) {
    if (row.name == name) set_option(row, owner, value);
  });
}

OptionValue value_of(const Options& options, std::string_view name) {
  OptionValue value;
  for_each_option(Options::schema(), &options, [&](const OptionRow& row, const void* owner) {
    if (row.name == name) value = option_value(row, owner);
  });
  return value;
}

TEST(OptionSchema, RowsAreNamedAfterTheirFieldsInOrderAndReachPartsAndBases) {
  std::vector<std::string_view> names;
  const Options options;
  for_each_option(Options::schema(), &options, [&](const OptionRow& row, const void*) { names.push_back(row.name); });
  EXPECT_EQ(names, (std::vector<std::string_view>{"clean", "rounds", "strength", "angle", "creases", "weights", "at",
                                                  "names", "ratio", "ratios", "width"}));
}

TEST(OptionSchema, ValuesOfAllKindsComeBackAsTheyWereSet) {
  Options o;
  const std::vector<std::pair<std::string_view, OptionValue>> values = {
      {"clean", false},
      {"rounds", std::int64_t{7}},
      {"strength", 0.25},
      {"creases", true},
      {"weights", std::string("gaussian")},
      {"at", std::vector<double>{1, 2, 3}},
      {"names", std::vector<std::string>{"a", "b"}},
      {"ratio", std::string("3:4")},
      {"ratios", std::vector<std::string>{"1:2", "5:6"}},
      {"width", std::int64_t{1024}}};
  for (const auto& [name, value] : values) {
    set(o, name, value);
    EXPECT_EQ(value_of(o, name), value) << name;
  }
  EXPECT_FALSE(o.clean);
  EXPECT_EQ(o.kernel, Kernel::gaussian);
  EXPECT_EQ(o.ratio, (Ratio{3, 4}));
  EXPECT_EQ(o.ratios, (std::vector<Ratio>{{1, 2}, {5, 6}}));
  EXPECT_EQ(o.inner.width, 1024);
  set(o, "rounds", {});
  EXPECT_FALSE(o.rounds);
  set(o, "angle", std::int64_t{5});  // integers convert to real numbers
  EXPECT_EQ(o.angle, 5.0);
}

TEST(OptionSchema, WhatIsSetIsWhatDiffersFromADefaultConstructedStruct) {
  Options o;
  EXPECT_TRUE(options_set(o).empty());
  o.inner.width = 10, o.clean = false, o.rounds = 10;
  EXPECT_EQ(options_set(o), (std::vector<std::string_view>{"clean", "rounds", "width"}));
}

TEST(OptionSchema, WrongValuesAreOneErrorThatNamesFieldValueAndRange) {
  Options o;
  EXPECT_EQ(error_of([&] { set(o, "rounds", std::int64_t{0}); }), "`rounds` must be from 1 to 100, not 0");
  EXPECT_EQ(error_of([&] { set(o, "strength", 0.7); }), "`strength` must be above 0 and at most 0.65, not 0.7");
  EXPECT_EQ(error_of([&] { set(o, "strength", std::nan("")); }),
            "`strength` must be above 0 and at most 0.65, not nan");
  EXPECT_EQ(error_of([&] { set(o, "weights", std::string("cubic")); }),
            "`weights` must be one of compact, gaussian, not 'cubic'");
  EXPECT_EQ(error_of([&] { set(o, "at", std::vector<double>{1, 2}); }), "`at` must be 3 numbers, not 1, 2");
  EXPECT_EQ(error_of([&] { set(o, "rounds", 1.5); }), "`rounds` must be a whole number, not 1.5");
  EXPECT_EQ(error_of([&] { set(o, "strength", {}); }), "`strength` must be a number");
  EXPECT_EQ(error_of([&] { set(o, "ratio", std::string("3")); }), "`ratio` must be two numbers, not 3");
  try {
    set(o, "rounds", std::int64_t{101});
    ADD_FAILURE();
  } catch (const ArgumentError& error) {
    EXPECT_EQ(error.fault().field, "rounds");
    EXPECT_EQ(error.fault().value, "101");
    EXPECT_EQ(error.fault().allowed, "from 1 to 100");
  }
}

TEST(OptionSchema, ValidationSeesRangesNeedsAndExclusions) {
  EXPECT_EQ(error_of([] { validate_options(Options()); }), "");
  Options o;
  o.strength = 2;
  EXPECT_NE(error_of([&] { validate_options(o); }).find("`strength`"), std::string::npos);
  o = {};
  o.inner.width = 0;
  EXPECT_NE(error_of([&] { validate_options(o); }).find("`width`"), std::string::npos);
  o = {};
  o.angle = 3;
  EXPECT_EQ(error_of([&] { validate_options(o); }), "`angle` needs `creases`");
  o.creases = true;
  EXPECT_EQ(error_of([&] { validate_options(o); }), "");
  o.rounds = 3, o.strength = 0.1;
  EXPECT_EQ(error_of([&] { validate_options(o); }), "`rounds` and `strength` exclude each other");
  o = {};
  o.kernel = static_cast<Kernel>(7);
  EXPECT_NE(error_of([&] { validate_options(o); }).find("`weights`"), std::string::npos);
}

TEST(OptionSchema, OptionsThatAMethodDoesNotUseAreNamed) {
  constexpr std::string_view some[] = {"rounds", "angle"}, used[] = {"angle"};
  Options o;
  o.angle = 1, o.clean = false;
  EXPECT_EQ(error_of([&] { check_used(options_set(o), used, some, "apss"); }), "");
  o.rounds = 2;
  EXPECT_EQ(error_of([&] { check_used(options_set(o), used, some, "apss"); }), "`rounds` means nothing to apss");
}

TEST(OptionRange, WordsAndBordersAgree) {
  EXPECT_EQ((OptionRange{1, 10}.words()), "1..10");
  EXPECT_EQ(positive().words(), "above 0");
  EXPECT_EQ(positive(0.5).words(), "above 0, up to 0.5");
  EXPECT_EQ(at_least(3).words(), "3 or more");
  EXPECT_EQ(OptionRange().words(), "");
  EXPECT_FALSE(positive().holds(0));
  EXPECT_FALSE(positive().holds(std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(OptionRange().holds(std::nan("")));
  EXPECT_TRUE(at_least(0).holds(0));
  EXPECT_TRUE((OptionRange{0, 1}.holds(1)));
  EXPECT_FALSE((OptionRange{0, 1, true, true}.holds(1)));
}

}  // namespace
}  // namespace sansmesh::test
