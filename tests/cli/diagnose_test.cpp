#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "run_tool.h"
#include "sansmesh/io/io.h"
#include "support/clouds.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

class DiagnoseCommand : public ToolTest {
 protected:
  /// A sphere with a small cluster of strays beside it.
  void fit_scan() const {
    write_points(path("scan.ply"), joined(sphere(5000), sphere(60), 0.09f, {1.5f, 0.2f, 0}));
    ASSERT_EQ(run({"fit", "scan.ply", "-o", "scan.smf"}).code, 0);
  }
};

TEST_F(DiagnoseCommand, FindsStraysAndItsScriptMendsThem) {
  fit_scan();
  const Outcome found = run({"diagnose", "scan.smf", "--script", "edits.json", "--preview", "places.png", "--json",
                             "--width", "200", "--height", "150"});
  ASSERT_EQ(found.code, 0) << found.err;
  const Json json = Json::parse(found.out);
  Json extra = Json::array();
  for (const Json& place : json["places"])
    if (place["kind"] == "extra sheet") extra.push_back(place);
  ASSERT_EQ(extra.size(), 1u) << found.out;
  EXPECT_NEAR(extra[0]["at"][0].get<double>(), 1.5, 0.05);
  EXPECT_EQ(json["script"]["edits"], json["places"].size());
  EXPECT_EQ(slurp(path("places.png")).substr(1, 3), "PNG");

  const Outcome edited = run({"edit", "scan.smf", "--script", "edits.json", "-o", "mended.smf"});
  ASSERT_EQ(edited.code, 0) << edited.err;
  const Outcome after = run({"diagnose", "mended.smf"});
  ASSERT_EQ(after.code, 0) << after.err;
  EXPECT_NE(after.out.find("extra sheet     nowhere"), std::string::npos) << after.out;
  const Outcome info = run({"info", "mended.smf"});
  ASSERT_EQ(info.code, 0) << info.err;
  EXPECT_NE(info.out.find("removed"), std::string::npos) << "info tells what was done to the function";
  EXPECT_EQ(Json::parse(run({"info", "mended.smf", "--json"}).out)["samples"], 5060);
}

TEST_F(DiagnoseCommand, BadInputIsOneLine) {
  fit_scan();
  expect_failures({
      {{"diagnose", "missing.smf"}, 1, {"missing.smf"}},
      {{"diagnose", "scan.ply"}, 1, {"not a function file"}},
      {{"diagnose", "scan.smf", "--gradient", "0.5"}, 2, {"gradient"}},
      {{"diagnose", "scan.smf", "--coverage", "3"}, 2, {"coverage"}},
      {{"diagnose", "scan.smf", "--script", "nowhere/e.json"}, 1, {"folder"}},
  });
}

}  // namespace
}  // namespace sansmesh::test
