// Tests of `volume fit`, and of its file as input.
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "run_tool.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/io/grids/write_volume.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

class VolumeFit : public ToolTest {
 protected:
  /// Scattered samples of two quantities, and a lattice of one.
  void SetUp() override {
    ToolTest::SetUp();
    std::mt19937 random(3);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    std::string rows = "x,y,z,heat,flow\n";
    for (int i = 0; i < 600; ++i) {
      const double x = uniform(), y = uniform(), z = uniform();
      rows += std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(z) + "," +
              std::to_string(std::sin(3 * x) + y * z) + "," + std::to_string(x + 2 * y) + "\n";
    }
    write("data.csv", rows);
    write("where.csv", "x,y,z\n0.5,0.5,0.5\n0.25,0.3,0.7\n0.6,0.2,0.4\n3,3,3\n");
    GridBlock block;
    block.kind = GridKind::lattice;
    std::vector<float> values;
    for (auto& axis : block.axes)
      for (int i = 0; i < 12; ++i) axis.push_back(i);
    for (int z = 0; z < 12; ++z)
      for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 12; ++x)
          values.push_back(static_cast<float>(std::sin(0.4 * x) * std::cos(0.3 * z) + 0.1 * y));
    block.point_arrays.set("value", std::move(values));
    write_volume(path("cube.mha"), block);
  }
  std::string probed(const std::vector<std::string>& input) const {
    std::vector<std::string> arguments{"volume", "probe"};
    arguments.insert(arguments.end(), input.begin(), input.end());
    arguments.insert(arguments.end(), {"--points", "where.csv", "-o", "probed.csv", "--quiet"});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const std::string rows = slurp(path("probed.csv"));
    std::filesystem::remove(path("probed.csv"));
    return rows;
  }
};

TEST_F(VolumeFit, ItsFileAnswersLikeTheData) {
  for (const char* method : {"mls-detail", "amls", "linear"}) {
    SCOPED_TRACE(method);
    const Json fit = json_of({"volume", "fit", "data.csv", "--array", "heat", "--method", method, "-o", "heat.smv"});
    EXPECT_EQ(fit["input"]["method"], method);
    EXPECT_EQ(fit["output"]["arrays"], Json({"heat"}));
    const std::string rows = probed({"data.csv", "--array", "heat", "--method", method});
    EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 5);
    EXPECT_EQ(probed({"heat.smv"}), rows);
    EXPECT_EQ(probed({"heat.smv", "--array", "heat", "--method", method}), rows);

    const Json info = json_of({"info", "heat.smv"});
    EXPECT_EQ(info["reconstruction"]["method"], method);
    EXPECT_EQ(info["reconstruction"]["array"], "heat");
    std::size_t polynomials = 0;
    for (const auto& count : info["reconstruction"]["by_degree"]) polynomials += count.get<std::size_t>();
    EXPECT_EQ(polynomials, method == std::string("linear") ? 0u : info["samples"].get<std::size_t>());
  }
  ASSERT_EQ(
      run({"volume", "fit", "data.csv", "--array", "heat", "--method", "amls", "--spherical", "-o", "balls.smv"}).code,
      0);
  const std::string rows = probed({"data.csv", "--array", "heat", "--method", "amls", "--spherical"});
  EXPECT_EQ(probed({"balls.smv"}), rows);
  EXPECT_EQ(probed({"balls.smv", "--array", "heat", "--method", "amls", "--spherical"}), rows);
  EXPECT_NE(probed({"data.csv", "--array", "heat", "--method", "amls"}), rows);
  EXPECT_NE(run({"info", "balls.smv"}).out.find(", spherical)"), std::string::npos);
  const Outcome info = run({"info", "heat.smv"});
  EXPECT_NE(info.out.find("heat by linear"), std::string::npos) << info.out;
  const Outcome fit = run({"volume", "fit", "data.csv", "--array", "heat", "-o", "heat.smv"});
  EXPECT_EQ(fit.out.find(" 0 MB"), std::string::npos) << fit.out;
}

TEST_F(VolumeFit, EveryCommandTakesItsFile) {
  ASSERT_EQ(run({"volume", "fit", "cube.mha", "-o", "cube.smv"}).code, 0);
  for (const char* data : {"cube.mha", "cube.smv"}) {
    const std::string name = std::string(data) + ".";
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
             {"volume", "resample", data, "--size", "9", "-o", name + "nrrd"},
             {"volume", "isosurface", data, "--value", "0.4", "-o", name + "ply"},
             {"volume", "render", data, "-o", name + "png", "--width", "80", "--height", "60"},
             {"advise", data},
             {"measure", std::string(data) + "[value=0.4]"}}) {
      const Outcome outcome = run(command);
      EXPECT_EQ(outcome.code, 0) << command[0] << " " << command[1] << " " << outcome.err;
    }
  }
  for (const char* ending : {".nrrd", ".ply", ".png"})
    EXPECT_TRUE(slurp(path(std::string("cube.mha") + ending)) == slurp(path(std::string("cube.smv") + ending)))
        << ending;
}

TEST_F(VolumeFit, OtherArraysAndMethodsAreThereIfTheyWereKept) {
  ASSERT_EQ(run({"volume", "fit", "data.csv", "--array", "heat", "--all-arrays", "-o", "all.smv"}).code, 0);
  EXPECT_EQ(probed({"all.smv", "--array", "flow", "--method", "shepard"}),
            probed({"data.csv", "--array", "flow", "--method", "shepard"}));
  ASSERT_EQ(run({"volume", "fit", "all.smv", "--method", "mls", "--degree", "1", "-o", "mls.smv"}).code, 0);
  EXPECT_EQ(probed({"mls.smv"}), probed({"data.csv", "--array", "heat", "--method", "mls", "--degree", "1"}));
}

TEST_F(VolumeFit, ErrorsAreOneLineAndLeaveNothing) {
  ASSERT_EQ(run({"volume", "fit", "data.csv", "--array", "heat", "-o", "heat.smv"}).code, 0);
  write("cut.smv", slurp(path("heat.smv")).substr(0, 5000));
  write("text.smv", "hello, this is no volume\n");
  std::string garbled = slurp(path("heat.smv"));
  garbled[garbled.size() / 2] = static_cast<char>(garbled[garbled.size() / 2] ^ 1);
  write("garbled.smv", garbled);
  expect_failures({{{"volume", "fit", "data.csv", "-o", "data.vti"}, 1, {"data.vti", ".smv"}},
                   {{"volume", "fit", "data.csv", "-o", "missing/data.smv"}, 1, {"folder does not exist"}},
                   {{"volume", "fit", "missing.csv", "-o", "data.smv"}, 1, {"missing.csv"}},
                   {{"volume", "probe", "heat.smv", "--array", "flow", "--at", "0,0,0"}, 2, {"--array", "holds heat"}},
                   {{"volume", "probe", "heat.smv", "cube.mha", "--at", "0,0,0"}, 1, {"must be the only file"}},
                   {{"volume", "probe", "heat.smv", "--time-step", "2", "--at", "0,0,0"}, 2, {"--time-step"}},
                   {{"volume", "probe", "heat.smv", "--method", "cubic", "--at", "0,0,0"}, 2, {"cubic"}},
                   {{"volume", "probe", "cut.smv", "--at", "0,0,0"}, 1, {"cut.smv", "truncated"}},
                   {{"volume", "probe", "text.smv", "--at", "0,0,0"}, 1, {"text.smv", "is not a fitted volume"}},
                   {{"info", "garbled.smv"}, 1, {"garbled.smv", "damaged"}}});
}

}  // namespace
}  // namespace sansmesh::test
