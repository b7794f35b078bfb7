#include <gtest/gtest.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

class DiagnoseCommand : public ToolTest {
 protected:
  /// A sphere with a small cluster of stray samples beside it.
  void fit_scan() const {
    write_points(path("scan.ply"), joined(sphere(5000), sphere(40), 0.09f, {1.5f, 0.2f, 0}));
    ASSERT_EQ(run({"fit", "scan.ply", "-o", "scan.smf"}).code, 0);
  }
};

TEST_F(DiagnoseCommand, FindsStraysAndItsScriptMendsThem) {
  fit_scan();
  const Outcome found = run({"diagnose", "scan.smf", "--script-output", "edits.json", "--preview", "places.png",
                             "--json", "--width", "200", "--height", "150"});
  ASSERT_EQ(found.code, 0) << found.err;
  const Json json = Json::parse(found.out);
  Json extra = Json::array();
  for (const Json& place : json["places"])
    if (place["kind"] == "extra sheet") extra.push_back(place);
  ASSERT_EQ(extra.size(), 1u) << found.out;
  EXPECT_NEAR(extra[0]["at"][0].get<double>(), 1.5, 0.05);
  EXPECT_EQ(json["edits"], json["places"].size());
  EXPECT_EQ(slurp(path("places.png")).substr(1, 3), "PNG");

  const Outcome edited = run({"edit", "scan.smf", "--script", "edits.json", "-o", "repaired.smf"});
  ASSERT_EQ(edited.code, 0) << edited.err;
  const Outcome after = run({"diagnose", "repaired.smf"});
  ASSERT_EQ(after.code, 0) << after.err;
  EXPECT_NE(after.out.find("extra sheet     nowhere"), std::string::npos) << after.out;
  const Outcome info = run({"info", "repaired.smf"});
  ASSERT_EQ(info.code, 0) << info.err;
  EXPECT_NE(info.out.find("removed"), std::string::npos) << "info tells what was done to the function";
  EXPECT_EQ(Json::parse(run({"info", "repaired.smf", "--json"}).out)["samples"], 5040);
}

TEST_F(DiagnoseCommand, ListsEveryPlaceOrSaysHowManyMore) {
  SANSMESH_NOT_SANITIZED("others diagnose, too");
  PointSet cloud = sphere(5000);
  for (int k = 0; k < 7; ++k) {
    const auto a = static_cast<float>(k);
    cloud = joined(cloud, sphere(40), 0.09f, {1.6f * std::cos(a), 1.6f * std::sin(a), 0});
  }
  write_points(path("scan.ply"), cloud);
  ASSERT_EQ(run({"fit", "scan.ply", "-o", "scan.smf"}).code, 0);
  const auto lines_at = [](const std::string& text) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find(" at (", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  const Outcome all = run({"diagnose", "scan.smf"});
  const Json json = json_of({"diagnose", "scan.smf"});
  EXPECT_EQ(json["found"]["extra sheet"], 7);
  EXPECT_EQ(lines_at(all.out), json["places"].size()) << all.out;
  for (std::size_t i = 0; i < json["places"].size(); ++i) EXPECT_EQ(json["places"][i]["number"], i + 1);
  const Outcome some = run({"diagnose", "scan.smf", "--places", "5", "--script-output", "edits.json"});
  EXPECT_NE(some.out.find("and 2 more: --places 7 lists all"), std::string::npos) << some.out;
  EXPECT_NE(some.out.find("; step 1\n"), std::string::npos) << some.out;
  const Outcome seven = run({"diagnose", "scan.smf", "--places", "7"});
  EXPECT_EQ(lines_at(seven.out), lines_at(all.out)) << "the remedy of the shorter list";

  // Pictures of the regions: a sheet, or one file each.
  const auto size_of = [&](const std::string& name) {
    const std::string png = slurp(path(name));
    EXPECT_EQ(png.substr(1, 3), "PNG") << name;
    const auto number = [&](std::size_t at) {
      return static_cast<unsigned char>(png[at]) * 256 + static_cast<unsigned char>(png[at + 1]);
    };
    return std::pair(number(18), number(22));
  };
  const Json sheet = json_of({"diagnose", "scan.smf", "--places", "4", "--pictures", "sheet.png"});
  const int count = static_cast<int>(sheet["places"].size()), rows = (count + 2) / 3;
  ASSERT_TRUE(count >= 4 && count <= 9) << count;
  EXPECT_EQ(sheet["pictures"], Json({"sheet.png"}));
  EXPECT_EQ(size_of("sheet.png"), std::pair(3 * 360 + 12, rows * 270 + (rows - 1) * 6));
  const Json each = json_of({"diagnose", "scan.smf", "--places", "2", "--pictures", "each.png", "--separate", "--width",
                             "160", "--height", "120"});
  ASSERT_EQ(each["pictures"].size(), each["places"].size());
  EXPECT_EQ(each["pictures"][1], "each_002.png");
  EXPECT_EQ(size_of("each_002.png"), std::pair(160, 120));
  EXPECT_NE(slurp(path("each_001.png")), slurp(path("each_002.png")));
}

TEST_F(DiagnoseCommand, WithoutPlacesThereIsNothingToLookAt) {
  write_points(path("ball.ply"), sphere(3000));
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "ball.smf"}).code, 0);
  const Outcome outcome = run({"diagnose", "ball.smf", "--pictures", "places.png"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("there are no doubtful regions"), std::string::npos) << outcome.out;
  EXPECT_EQ(listing(), (std::vector<std::string>{"ball.ply", "ball.smf"}));
}

TEST_F(DiagnoseCommand, BadInputIsOneLine) {
  fit_scan();
  expect_failures({
      {{"diagnose", "missing.smf"}, 1, {"missing.smf"}},
      {{"diagnose", "scan.ply"}, 1, {"not a function file"}},
      {{"diagnose", "scan.smf", "--gradient-above", "0.5"}, 2, {"gradient"}},
      {{"diagnose", "scan.smf", "--coverage-below", "3"}, 2, {"coverage"}},
      {{"diagnose", "scan.smf", "--script-output", "nowhere/e.json"}, 1, {"folder"}},
      {{"diagnose", "scan.smf", "--pictures", "places.jpg"}, 1, {"places.jpg"}},
      {{"diagnose", "scan.smf", "--separate"}, 2, {"--pictures"}},
  });
}

}  // namespace
}  // namespace sansmesh::test
