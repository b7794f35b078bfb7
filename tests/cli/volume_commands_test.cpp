// Tests of volume commands on a ball in a small raw file and on points.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "ball_volume.h"
#include "run_tool.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

class VolumeTool : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write(kBallFile, ball_bytes());
    ball_ = path(kBallFile);
  }
  std::string ball_;
};

TEST_F(VolumeTool, InfoTellsGridAndArrays) {
  const auto json = json_of({"info", ball_});
  EXPECT_EQ(json["samples"], kBallSize * kBallSize * kBallSize);
  EXPECT_EQ(json["grid"], "uniform");
  EXPECT_EQ(json["spacing"]["median"], 1);
  EXPECT_EQ(json["arrays"][0]["upper"][0], 7);
}

TEST_F(VolumeTool, InfoDescribesGridsWithoutValues) {
  std::ofstream(path("bare.p3d")) << "2 2 2\n0 1 0 1 0 1 0 1\n0 0 1 1 0 0 1 1\n0 0 0 0 2 2 2 2\n";
  const auto json = json_of({"info", path("bare.p3d")});
  EXPECT_EQ(json["samples"], 8);
  EXPECT_EQ(json["cells"], 1);
  EXPECT_EQ(json["spacing"]["most"], 2);
  EXPECT_TRUE(json["arrays"].empty());
  EXPECT_EQ(json["notes"].size(), 1u);
}

/// The content decides if the ending is also one of points.
TEST_F(VolumeTool, InfoKnowsGridsThatAreNamedAsPoints) {
  const std::string text = "2 2 2\n0 1 0 1 0 1 0 1\n0 0 1 1 0 0 1 1\n0 0 0 0 2 2 2 2\n";
  write("bare.xyz", text);
  EXPECT_EQ(json_of({"info", "bare.xyz"})["cells"], 1);
  std::string bytes(3 * 4 + 24 * 4, '\0');
  const std::int32_t dims[] = {2, 2, 2};
  const float points[] = {0, 1, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 2, 2, 2, 2};
  std::memcpy(bytes.data(), dims, sizeof(dims)), std::memcpy(bytes.data() + sizeof(dims), points, sizeof(points));
  write("binary.xyz", bytes);
  const auto json = json_of({"info", "binary.xyz"});
  EXPECT_EQ(json["cells"], 1);
  EXPECT_NE(json["format"].get<std::string>().find("PLOT3D"), std::string::npos);
  EXPECT_NE(run({"convert", "binary.xyz", "-o", "x.ply"}).err.find("holds a volume (PLOT3D)"), std::string::npos);
  // Points that begin with whole numbers are still points.
  write("points.xyz", "1 2 3\n4 5 6\n7 8 10\n1 0 0\n");
  EXPECT_EQ(json_of({"info", "points.xyz"})["points"], 4);
}

TEST_F(VolumeTool, AdviseNamesAReconstructionAndWhy) {
  const auto json = json_of({"advise", ball_});
  EXPECT_FALSE(json["method"].get<std::string>().empty());
  EXPECT_FALSE(json["why"].get<std::string>().empty());
}

/// Splits a command like a shell, without "sansmesh".
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words(1);
  bool quoted = false;
  for (const char c : command)
    if (c == '\'')
      quoted = !quoted;
    else if (c == ' ' && !quoted)
      words.emplace_back();
    else
      words.back() += c;
  words.erase(words.begin());
  return words;
}

TEST_F(VolumeTool, AdviseHasNothingToSayOfBareLattices) {
  write("bare.p3d", "2 2 2\n0 1 0 1 0 1 0 1\n0 0 1 1 0 0 1 1\n0 0 0 0 2 2 2 2\n");
  const Outcome outcome = run({"advise", "data", "bare.p3d"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("sansmesh: bare.p3d: has no arrays"), std::string::npos) << outcome.err;
}

TEST_F(VolumeTool, EveryCommandThatAdviseNamesRuns) {
  SANSMESH_NOT_SANITIZED("draws pictures and moves bodies; the tests of each command do so sanitized");
  // Other inputs of the commands.
  write("where.csv", "x,y,z\n8,8,4\n");
  write("handles.json", R"({"handles": [{"p": [1, 1, 1], "q": [1, 1, 1]}, {"p": [12, 1, 1], "q": [12, 2, 1]},
      {"p": [1, 12, 1], "q": [1, 12, 1]}, {"p": [1, 1, 12], "q": [1, 1, 12]}]})");
  std::string flow =
      "# vtk DataFile Version 3.0\nturn\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 5 5 5\n"
      "ORIGIN -1 -1 -1\nSPACING 0.5 0.5 0.5\nPOINT_DATA 125\nVECTORS v float\n";
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) flow += std::to_string(1 - 0.5 * j) + " " + std::to_string(0.5 * i - 1) + " 0.3\n";
  write("turn.vtk", flow);
  write("body.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
  write("body.ele", "1 4 0\n1 1 2 3 4\n");
  const std::vector<std::pair<std::string, std::vector<std::string>>> aims{
      {ball_, {"surface", "picture", "values", "grid", "deformation"}},
      {path("turn.vtk"),
       {"flow picture", "flow surface", "lines", "surface", "picture", "values", "grid", "deformation"}},
      {path("body.node"), {"forces"}}};
  for (const auto& [file, expected] : aims) {
    const auto json = json_of({"advise", file});
    std::vector<std::string> found;
    for (const auto& r : json["commands"]) {
      if (r["aim"] != "border") found.push_back(r["aim"]);
      EXPECT_GT(r["why"].get<std::string>().size(), 10u);
      std::vector<std::string> words = words_of(r["command"]);
      // Small pictures and few frames suffice to test that they are made.
      if (words.back().ends_with(".png") && words[0] != "simulate" && words[1] != "lines")
        words.insert(words.end(), {"--width", "64", "--height", "48"});
      if (words[0] == "simulate") words.insert(words.end(), {"--frames", "2", "--duration", "0.1"});
      const Outcome outcome = run(words);
      EXPECT_EQ(outcome.code, 0) << r["command"] << "\n" << outcome.err;
    }
    EXPECT_EQ(found, expected) << file;
  }
}

TEST_F(VolumeTool, ProbeAnswersEveryRowInOrder) {
  std::ofstream(path("where.csv")) << "x,y,z\n8,8,4\n100,0,0\n4.5,8,8\nnan,1,1\n";
  const Outcome outcome =
      run({"volume", "probe", ball_, "--points", path("where.csv"), "-o", path("out.csv"), "--method", "linear"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream rows(slurp(path("out.csv")));
  std::string line;
  std::getline(rows, line);
  EXPECT_EQ(line, "x,y,z,value,value_dx,value_dy,value_dz,inside");
  std::vector<std::vector<double>> table;
  while (std::getline(rows, line)) {
    std::istringstream fields(line);
    std::string field;
    table.emplace_back();
    while (std::getline(fields, field, ',')) table.back().push_back(std::stod(field));
    ASSERT_EQ(table.back().size(), 8u) << line;
  }
  ASSERT_EQ(table.size(), 4u);
  EXPECT_NEAR(table[0][3], 3, 1e-6);
  EXPECT_NEAR(table[2][3], 3.5, 1e-6);
  EXPECT_NEAR(table[2][4], 1, 1e-5);
  EXPECT_EQ(table[0][7], 1);
  EXPECT_EQ(table[1][7], 0);
  EXPECT_EQ(table[3][7], 0);
}

TEST_F(VolumeTool, IsosurfacesAreMeshesSolidsAndSections) {
  const double volume = 4.0 / 3 * std::numbers::pi * 125;
  const auto json = json_of({"volume", "isosurface", ball_, "--value", "2", "-o", path("ball.ply")});
  EXPECT_EQ(json["output"]["closed"], true);
  EXPECT_NEAR(json["volume"].get<double>(), volume, 0.02 * volume);
  const auto cut = json_of({"section", ball_ + "[value=2]", "--plane", "z=8"});
  EXPECT_NEAR(cut["planes"][0]["area"].get<double>(), std::numbers::pi * 25, 1);
  const auto half =
      json_of({"csg", "'" + ball_ + "[value=2]' & plane(z, offset=8)", "-o", path("half.ply"), "--cell", "0.7"});
  EXPECT_NEAR(half["volume"].get<double>(), volume / 2, 0.02 * volume);
}

/// Values of two balls at ±d from the centre: 4 minus the distance from the nearer centre, for every sample.
std::string two_balls(double d) {
  std::vector<float> values;
  for (int k = 0; k < 17; ++k)
    for (int j = 0; j < 17; ++j)
      for (int i = 0; i < 17; ++i)
        values.push_back(static_cast<float>(
            4 - std::min(std::hypot(i - 8 - d, j - 8.1, k - 7.9), std::hypot(i - 8 + d, j - 8.1, k - 7.9))));
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

TEST_F(VolumeTool, SeriesInTimeBecomeMeshesAtAnyMoment) {
  std::vector<std::string> series{"volume", "isosurface"};
  const std::vector<double> points{4, 3, 2, 1, 0};  // they touch at 2.5, their radius
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string name = "s" + std::to_string(i) + "_17x17x17_float32.raw";
    write(name, two_balls(points[i]));
    series.push_back(path(name));
  }
  for (const std::string word : {"--unsteady", "--value", "1.5", "--method", "linear", "-o"}) series.push_back(word);
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), series.begin(), series.end());
    return more;
  };
  const auto json = json_of(with({path("b.ply"), "--frames", "9", "--times", "10,2"}));
  ASSERT_EQ(json["frames"].size(), 9u);
  const double ball = 4.0 / 3 * std::numbers::pi * std::pow(2.5, 3);
  for (std::size_t k = 0; k < 9; ++k) {
    SCOPED_TRACE(k);
    const auto& frame = json["frames"][k];
    EXPECT_EQ(frame["file"].get<std::string>(), path("b_000" + std::to_string(k) + ".ply"));
    EXPECT_NEAR(frame["time"].get<double>(), 10 + static_cast<double>(k), 1e-12);
    EXPECT_EQ(frame["closed"], true);
    if (k != 3) {
      EXPECT_EQ(frame["components"], k < 3 ? 2 : 1);
    }
    const auto read = json_of({"info", frame["file"].get<std::string>()});
    EXPECT_EQ(read["triangles"], frame["triangles"]);
    if (k == 0 || k == 2 || k == 8) {
      const double both = k == 8 ? ball : 2 * ball;
      // Linear interpolation of distances on this coarse grid makes balls smaller.
      EXPECT_NEAR(frame["volume"].get<double>(), 0.92 * both, 0.05 * both);
    }
  }
  // Finer in time and space, and simplified.
  const auto fine = json_of(with({path("f.ply"), "--frames", "2", "--cell", "0.5", "--time-cell", "0.25"}));
  EXPECT_NEAR(fine["cell"].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(fine["time_cell"].get<double>(), 0.25, 1e-12);
  EXPECT_NEAR(fine["frames"][0]["volume"].get<double>(), 0.92 * 2 * ball, 0.05 * 2 * ball);
  const auto all = json_of(with({path("g.ply"), "--frames", "2", "--mesh-error", "1e-9"}));
  EXPECT_GT(all["frames"][0]["triangles"].get<int>(), 2 * json["frames"][0]["triangles"].get<int>());

  const std::string out = path("never.ply");
  const std::vector<Failing> cases = {
      {with({out, "--carry", "none"}), 2, {"--carry", "--unsteady"}},
      {with({out, "--closed"}), 2, {"--closed", "--unsteady"}},
      {with({out, "--frames", "1"}), 2, {"--frames"}},
      {with({out, "--times", "0,1,2"}), 2, {"--times has 3 numbers for 5 files"}},
      {with({out, "--time-cell", "0"}), 2, {"--time-cell"}},
      {with({out, "--time-cell", "1e-9"}), 2, {"--time-cell"}},
      {with({out, "--preview", path("never.png")}), 2, {"--preview"}},
      {{"volume", "isosurface", ball_, "-o", out, "--frames", "3"}, 2, {"--frames", "--unsteady"}},
      {{"volume", "isosurface", ball_, "-o", out, "--unsteady"}, 1, {kBallFile, "one step in time"}},
      {{"volume", "isosurface", ball_, path("missing.mhd"), "-o", out, "--unsteady"}, 1, {"missing.mhd"}},
      {{"volume", "isosurface", ball_, ball_, "-o", out, "--unsteady", "--value", "70"}, 1, {"70", "between"}}};
  expect_failures(cases);
}

TEST_F(VolumeTool, ResamplesOntoOtherGridsAndReadsThemBack) {
  for (const char* ending : {"mha", "nrrd"}) {
    const std::string file = path(std::string("coarse.") + ending);
    const auto json = json_of({"volume", "resample", ball_, "--size", "9", "--method", "linear", "-o", file});
    EXPECT_EQ(json["output"]["inside"], 1);
    const auto back = json_of({"volume", "probe", file, "--at", "8,8,4", "--method", "linear"});
    EXPECT_NEAR(back["values"][0]["value"].get<double>(), 3, 1e-6) << ending;
  }
}

TEST_F(VolumeTool, PointsAreSamplesOfAVolumeWhereThatIsSaid) {
  std::ofstream csv(path("samples.csv"));
  csv << "x,y,z,t\n";
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i)
        csv << i + 0.01 * ((7 * j + 3 * k) % 5) << ',' << j + 0.01 * ((5 * i + k) % 7) << ',' << k << ',' << 2 * i - k
            << '\n';
  csv.close();
  EXPECT_EQ(json_of({"info", "data", path("samples.csv")})["samples"], 125);
  const auto json =
      json_of({"volume", "probe", path("samples.csv"), "--array", "t", "--at", "2,2,2", "--method", "linear"});
  EXPECT_NEAR(json["values"][0]["value"].get<double>(), 2, 0.1);
}

TEST_F(VolumeTool, SaysInOneLineWhatIsWrong) {
  std::ofstream(path("short_17x17x17_float32.raw")) << "too short";
  std::ofstream(path("empty.csv")) << "";
  std::ofstream(path("bare.p3d")) << "2 2 2\n0 1 0 1 0 1 0 1\n0 0 1 1 0 0 1 1\n0 0 0 0 2 2 2 2\n";
  std::ofstream(path("few.csv")) << "x,y,z,t\n0,0,0,1\n1,0,0,1\n0,1,0,1\n0,0,1,1\n";
  const std::string out = path("never.csv"), bare = path("bare.p3d");
  const std::vector<Failing> cases = {
      {{"volume", "probe", ball_, "--at", "1,2,3", "--array", "nothing"}, 2, {"--array", "nothing", "value"}},
      {{"volume", "probe", ball_}, 2, {"--points", "--at"}},
      {{"volume", "probe", path("missing.mhd"), "--at", "0,0,0"}, 1, {"missing.mhd"}},
      {{"volume", "probe", path("short_17x17x17_float32.raw"), "--at", "0,0,0"}, 1, {"short_17x17x17_float32.raw"}},
      {{"volume", "probe", ball_, "--points", path("empty.csv"), "-o", out}, 1, {"empty.csv"}},
      {{"volume", "probe", ball_, "--at", "0,0,0", "--method", "best"}, 2, {"--method", "mls-detail"}},
      {{"volume", "probe", bare, "--at", "0,0,0"}, 1, {"bare.p3d", "no arrays"}},
      {{"volume", "probe", bare, "--at", "0,0,0", "--array", "f"}, 1, {"bare.p3d", "no arrays"}},
      {{"volume", "isosurface", bare, "--value", "1", "-o", path("never.ply")}, 1, {"bare.p3d", "no arrays"}},
      {{"volume", "render", bare, "-o", path("never.png")}, 1, {"bare.p3d", "no arrays"}},
      {{"volume", "fit", bare, "-o", path("never.smv")}, 1, {"bare.p3d", "no arrays"}},
      {{"info", ball_, "--time-step", "1"}, 2, {"--time-step", "only one step"}},
      {{"info", bare, "--time-step", "7"}, 2, {"--time-step", "only one step"}},
      {{"volume", "probe", path("few.csv"), "--time-step", "1", "--at", "0,0,0"}, 2, {"--time-step"}},
      {{"volume", "isosurface", ball_, "--value", "70", "-o", path("never.ply")}, 1, {"70", "between"}},
      {{"volume", "resample", ball_, "-o", path("never.xyz")}, 1, {".vti"}},
      {{"volume", "resample", ball_, "-o", path("never.vti"), "--size", "1"}, 2, {"--size"}},
      {{"volume", "render", ball_, "-o", path("never.png"), "--preset", "pretty"}, 2, {"pretty", "ct-bone"}},
      {{"volume", "--quiet"}, 2, {"volume needs one of its commands"}},
      {{"section", ball_ + "[value=x]"}, 2, {"FILE[ARRAY=VALUE]"}},
  };
  expect_failures(cases);
}

}  // namespace
}  // namespace sansmesh::test
