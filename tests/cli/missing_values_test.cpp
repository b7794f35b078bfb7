// Tests of fill values, arrays of NaN, and values far from 1: right results or one clear line, never "nan" or "inf".
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "run_tool.h"
#include "sansmesh/io/grids/read_volume.h"

namespace sansmesh::test {
namespace {

using Words = std::vector<std::string>;

class MissingValues : public ToolTest {
 protected:
  static std::string crash(const std::string& name) { return source_file("tests/data/crashes/" + name); }

  /// Every command that reads a volume, with `file` for DATA.
  static std::vector<Words> commands(const std::string& file) {
    return {{"info", "data", file},
            {"volume", "probe", file, "--at", "0.5,0.5,0.5"},
            {"volume", "isosurface", file, "-o", "surface.ply"},
            {"volume", "surface", file, "-o", "layer.ply"},
            {"volume", "resample", file, "-o", "grid.vti", "--size", "6"},
            {"volume", "render", file, "-o", "x.png", "--width", "32", "--height", "24"},
            {"volume", "fit", file, "-o", "fitted.smv"}};
  }

  static std::size_t lines_with(const std::string& text, const std::string& part) {
    std::istringstream lines(text);
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line);) count += line.find(part) != std::string::npos;
    return count;
  }

  /// Value and gradient at a point.
  std::vector<double> probe(Words arguments) const {
    const auto json = json_of(std::move(arguments));
    const auto& v = json["values"][0];
    return {v["value"], v["gradient"][0], v["gradient"][1], v["gradient"][2]};
  }
};

TEST_F(MissingValues, FillValuesAreTheSameInEveryCommand) {
  const auto expect_warning = [&](const Words& command, const std::string& value) {
    SCOPED_TRACE(command[0] + " " + command[1]);
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(lines_with(outcome.err, value + " is a usual fill value and counts as missing: 1 of "), 1u)
        << outcome.err;
    EXPECT_NE(outcome.err.find("(--fill-value none keeps it)"), std::string::npos) << outcome.err;
  };
  for (const Words& command : commands(crash("netcdf_fill.csv"))) expect_warning(command, "9.96921e+36");
  for (const std::string name : {"largest_float.mha", "largest_float.vtu"})
    if (name.ends_with(".mha") || has_vtk_readers())
      expect_warning({"volume", "render", crash(name), "-o", "x.png", "--width", "32", "--height", "24"}, "3.4e+38");
  const auto json = json_of({"info", "data", crash("netcdf_fill.csv")});
  EXPECT_LT(json["arrays"][0]["upper"][0].get<double>(), 10);
  EXPECT_EQ(json["arrays"][0]["not_finite"], 1);
  EXPECT_EQ(json["warnings"].size(), 1u);
  // The error at the other samples is the same as without the fill value.
  EXPECT_NEAR(probe({"volume", "probe", crash("largest_float.mha"), "--at", "1.5,2,1"})[0], 1.45, 0.1);
  // The fitted volume keeps the warning.
  EXPECT_EQ(lines_with(run({"volume", "probe", "fitted.smv", "--at", "0.5,0.5,0.5"}).err, "usual fill value"), 1u);
}

TEST_F(MissingValues, UsersSayWhatAFillValueIs) {
  const std::string file = crash("netcdf_fill.csv");
  auto json = json_of({"info", "data", file, "--fill-value", "none"});
  EXPECT_EQ(json["arrays"][0]["not_finite"], 0);
  EXPECT_TRUE(json["warnings"].empty());
  // With the fill value the other values are lost in float: an error, or right in double.
  const Outcome lost = run({"volume", "render", file, "-o", "x.png", "--fill-value", "none", "--method", "mls-detail"});
  EXPECT_EQ(lost.code, 1);
  EXPECT_EQ(lines_with(lost.err, "(--fill-value), or choose the method linear"), 1u) << lost.err;
  EXPECT_LT(probe({"volume", "probe", file, "--fill-value", "none", "--method", "nearest", "--at", "0,0,0"})[0], 10);

  write("depth.csv", "x,y,z,d\n0,0,0,1\n1,0,0,-5\n0,1,0,2\n0,0,1,3\n1,1,1,4\n");
  json = json_of({"info", "data", "depth.csv", "--fill-value", "-5", "--fill-value", "7"});
  EXPECT_EQ(json["arrays"][0]["lower"][0], 1);
  ASSERT_EQ(json["warnings"].size(), 2u);
  EXPECT_NE(json["warnings"][0].get<std::string>().find("-5 counts as missing: 1 of 5 values of d"), std::string::npos);
  EXPECT_NE(json["warnings"][1].get<std::string>().find("--fill-value: no array has the value 7"), std::string::npos);
  expect_failure({"info", "data", "depth.csv", "--fill-value", "some"}, 2, "--fill-value");
}

TEST_F(MissingValues, HugeAndTinyValuesHaveRightAnswers) {
  const std::vector<std::pair<std::string, double>> files{{"huge_values.csv", 1e300}, {"tiny_values.csv", 1e-40}};
  for (const auto& [name, factor] : files)
    for (const std::string method : {"linear", "mls-detail"}) {
      SCOPED_TRACE(name + " by " + method);
      const std::vector<double> found =
          probe({"volume", "probe", crash(name), "--at", "0.4,0.3,0.6", "--method", method});
      const std::vector<double> expected{1.4, 1, 2, -1};
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found[k] / factor, expected[k], 0.05) << k;
    }
  for (const Words& command : commands(crash("huge_values.csv"))) {
    SCOPED_TRACE(command[0] + " " + command[1]);
    const Outcome outcome = run(command);
    EXPECT_EQ(lines_with(outcome.out + outcome.err, "nan") + lines_with(outcome.out + outcome.err, " inf"), 0u)
        << outcome.out << outcome.err;
    const bool floats = command[1] == "resample";
    EXPECT_EQ(outcome.code, floats ? 1 : 0) << outcome.err;
    EXPECT_EQ(lines_with(outcome.err, "do not fit into the floats of the result"), floats ? 1u : 0u) << outcome.err;
  }
  // A plane, at any offset of its values.
  for (const auto& [name, value] :
       {std::pair<std::string, std::string>{"huge_values.csv", "2e300"}, {"tiny_values.csv", "2e-40"}})
    EXPECT_NEAR(
        json_of({"volume", "isosurface", crash(name), "--value", value, "-o", "plane.ply"})["area"].get<double>(),
        std::sqrt(6.0) / 2, 0.02);
  // A fitted volume stores the scale of its coefficients.
  ASSERT_EQ(run({"volume", "fit", crash("huge_values.csv"), "--method", "amls", "-o", "huge.smv"}).code, 0);
  EXPECT_EQ(probe({"volume", "probe", "huge.smv", "--at", "0.4,0.3,0.6"}),
            probe({"volume", "probe", crash("huge_values.csv"), "--method", "amls", "--at", "0.4,0.3,0.6"}));
}

TEST_F(MissingValues, FlowsOfVectorsThatNoFloatHoldsAreRefused) {
  std::string table = "x,y,z,v_0,v_1,v_2\n";
  for (int i = 0; i < 27; ++i)
    table += std::to_string(i % 3) + "," + std::to_string(i / 3 % 3) + "," + std::to_string(i / 9) + ",1e300,2e299,0\n";
  write("fast.csv", table);
  const Outcome outcome = run({"flow", "lines", "fast.csv", "--array", "v", "-o", "lines.vtp"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(lines_with(outcome.err, "fast.csv: v: vectors of up to 1e+300 are too large to trace"), 1u) << outcome.err;
}

TEST_F(MissingValues, AnArrayWithoutAFiniteValueIsBlamedItself) {
  std::vector<Words> all = commands(crash("all_missing.mha"));
  const Outcome described = run(all.front());
  EXPECT_EQ(described.code, 0) << described.err;
  all.erase(all.begin());
  all.push_back({"volume", "isosurface", crash("all_missing.mha"), "--value", "1", "-o", "surface.ply"});
  all.push_back({"volume", "surface", crash("all_missing.mha"), "--value", "1", "-o", "surface.ply"});
  for (const Words& command : all) {
    SCOPED_TRACE(command[1]);
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.lines_of_error(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("all_missing.mha: array 'value' has no finite value"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace sansmesh::test
