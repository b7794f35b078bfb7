// Reports as data: rows of fields, functions, nested reports, lists and bases.
#include "sansmesh/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace sansmesh::test {
namespace {

enum class End { time, boundary };
constexpr std::string_view kEnds[] = {"time", "boundary"};

struct Part {
  double area = 0;

  static const ReportSchema& schema() {
    static constexpr ReportRow rows[] = {reported<&Part::area>({.text = "Area", .unit = "length²"})};
    static constexpr ReportSchema schema{rows};
    return schema;
  }
};

struct Found {
  std::size_t points = 3;
};

struct Report : Found {
  bool closed = true;
  std::optional<double> volume = {};
  End end = End::boundary;
  Vec3 middle = {1, 2, 3};
  Box3 box = {};
  std::vector<std::size_t> by_degree = {4, 5};
  std::vector<std::optional<double>> angles = {0.5, std::nullopt};
  ReportCounts classes = {{"ground", 7}};
  Part whole = {6};
  std::optional<Part> hole = {};
  std::vector<Part> parts = {{1}, {2}};

  static const ReportSchema& schema() {
    static constexpr ReportRow rows[] = {
        reported<&Report::closed>({.text = "Closed"}),
        reported<&Report::volume>({.text = "Volume"}),
        reported<&Report::end>({.text = "End", .choices = kEnds}),
        reported<&Report::middle>({.text = "Middle"}),
        reported<&Report::box>({.text = "Box"}),
        reported<&Report::by_degree>({.text = "By degree"}),
        reported<&Report::angles>({.text = "Angles"}),
        reported<&Report::classes>({.text = "Classes"}),
        reported<[](const Report& r) { return 2 * r.points; }>({.name = "twice", .text = "Twice the points"}),
        reported<&Report::whole>({.text = "Whole"}),
        reported<&Report::hole>({.text = "Hole"}),
        reported<&Report::parts>({.text = "Parts"}),
        reported_inline<&Report::whole>()};
    static constexpr ReportSchema schema{rows};
    return schema;
  }
};

const ReportRow& row(const std::string& name) {
  for (const ReportRow& r : Report::schema().rows)
    if (r.name == name) return r;
  throw std::out_of_range(name);
}

std::vector<double> areas(const ReportRow& row, const Report& report) {
  std::vector<double> found;
  row.each(&report,
           [&](const void* part) { found.push_back(std::get<double>(report_value(row.part().rows[0], part))); });
  return found;
}

TEST(ReportRow, ValuesHaveTheKindOfTheirFields) {
  const Report report;
  EXPECT_EQ(row("closed").kind, ReportKind::flag);
  EXPECT_EQ(report_value(row("closed"), &report), ReportValue(true));
  EXPECT_EQ(report_value(row("middle"), &report), ReportValue(std::vector<double>{1, 2, 3}));
  EXPECT_EQ(report_value(row("by_degree"), &report), ReportValue(std::vector<std::int64_t>{4, 5}));
  EXPECT_EQ(report_value(row("classes"), &report), ReportValue(ReportCounts{{"ground", 7}}));
  EXPECT_EQ(report_value(row("twice"), &report), ReportValue(std::int64_t{6}));
  EXPECT_EQ(row("whole").kind, ReportKind::report);
  EXPECT_EQ(row("parts").kind, ReportKind::reports);
}

TEST(ReportRow, NothingIsToldOfWhatThereIsNot) {
  Report report;
  EXPECT_TRUE(row("volume").optional);
  EXPECT_FALSE(row("closed").optional);
  EXPECT_EQ(report_value(row("volume"), &report), ReportValue());
  EXPECT_EQ(report_value(row("box"), &report), ReportValue()) << "an empty box has no corners";
  const auto angles = std::get<std::vector<double>>(report_value(row("angles"), &report));
  EXPECT_EQ(angles[0], 0.5);
  EXPECT_TRUE(std::isnan(angles[1]));
  report.volume = 2.5;
  report.box.extend({1, 1, 1}), report.box.extend({2, 3, 4});
  EXPECT_EQ(report_value(row("volume"), &report), ReportValue(2.5));
  EXPECT_EQ(report_value(row("box"), &report), ReportValue(std::vector<std::vector<double>>{{1, 1, 1}, {2, 3, 4}}));
}

TEST(ReportRow, ChoicesAreWords) {
  const Report report;
  EXPECT_EQ(row("end").kind, ReportKind::choice);
  EXPECT_EQ(report_value(row("end"), &report), ReportValue("boundary"));
}

TEST(ReportRow, PartsAreVisitedOneAfterTheOther) {
  Report report;
  EXPECT_EQ(areas(row("whole"), report), (std::vector<double>{6}));
  EXPECT_EQ(areas(row("parts"), report), (std::vector<double>{1, 2}));
  EXPECT_TRUE(areas(row("hole"), report).empty());
  report.hole = Part{9};
  EXPECT_EQ(areas(row("hole"), report), (std::vector<double>{9}));
  const ReportRow& beside = Report::schema().rows.back();
  EXPECT_TRUE(beside.inlined);
  EXPECT_EQ(areas(beside, report), (std::vector<double>{6}));
}

}  // namespace
}  // namespace sansmesh::test
