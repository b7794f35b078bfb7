// Tests of flow lines and surfaces: of formulas, volumes, and series in time.
#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "run_tool.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/vec.h"
#include "support/png_file.h"

namespace sansmesh::test {
namespace {

/// A MetaImage of vectors on a lattice of 9³ samples in [-1, 1]³.
std::string vector_image(Vec3 (*v)(const Vec3&), const std::string& raw, std::string& bytes) {
  std::vector<float> values;
  for (int k = 0; k < 9; ++k)
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 9; ++i) {
        const Vec3 x = v({i / 4.0 - 1, j / 4.0 - 1, k / 4.0 - 1});
        for (std::size_t c = 0; c < 3; ++c) values.push_back(static_cast<float>(x[c]));
      }
  bytes.assign(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return "ObjectType = Image\nNDims = 3\nDimSize = 9 9 9\nElementSpacing = 0.25 0.25 0.25\nOffset = -1 -1 -1\n"
         "ElementType = MET_FLOAT\nElementNumberOfChannels = 3\nElementByteOrderMSB = False\nElementDataFile = " +
         raw + "\n";
}

class FlowLinesTool : public ToolTest {
 protected:
  void image(const std::string& name, Vec3 (*v)(const Vec3&)) {
    std::string bytes;
    const std::string header = vector_image(v, name + ".raw", bytes);
    write(name + ".mhd", header);
    write(name + ".raw", bytes);
  }
  Outcome lines(const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"flow", "lines"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run(all);
  }
  /// Rows of a table of numbers, without its header.
  std::vector<std::vector<double>> rows_of(const std::string& file) { return number_rows(file, &header_); }
  std::string header_;
};

TEST_F(FlowLinesTool, ParticlesOfAVolumeGoRound) {
  image("turn", [](const Vec3& x) { return Vec3{-x.y, x.x, 0}; });
  const Outcome outcome = lines({path("turn.mhd"), "--seeds", "line(0.2,0,0, 0.8,0,0, 4)", "--duration", "1.5", "-o",
                                 path("turn.csv"), "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["output"]["lines"], 4);
  EXPECT_EQ(json["ends"]["time"], 4);
  const auto rows = rows_of(path("turn.csv"));
  EXPECT_EQ(header_.rfind("line,time,x,y,z,speed", 0), 0u) << header_;
  ASSERT_GT(rows.size(), 20u);
  for (const std::vector<double>& row : rows) {
    const double radius = 0.2 + 0.2 * row[0];
    EXPECT_NEAR(row[2], radius * std::cos(row[1]), 1e-3);
    EXPECT_NEAR(row[3], radius * std::sin(row[1]), 1e-3);
    EXPECT_NEAR(row[5], radius, 1e-3);  // speed
  }
  EXPECT_NEAR(rows.back()[1], 1.5, 1e-9);
}

TEST_F(FlowLinesTool, ComponentsInSeparateArraysAreVectors) {
  if (!has_vtk_readers()) GTEST_SKIP() << "without the module";
  std::string grid =
      "# vtk DataFile Version 3.0\nflow\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 9 9 9\nORIGIN -1 -1 -1\n"
      "SPACING 0.25 0.25 0.25\nPOINT_DATA 729\n";
  std::string x, y, z, vectors;
  for (int k = 0; k < 9; ++k)
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 9; ++i) {
        const std::string a = std::to_string(1 - j / 4.0), b = std::to_string(i / 4.0 - 1),
                          c = std::to_string(0.125 * k);
        x += a + "\n", y += b + "\n", z += c + "\n", vectors += a + " " + b + " " + c + "\n";
      }
  const auto scalars = [](const std::string& name, const std::string& rows) {
    return "SCALARS " + name + " float 1\nLOOKUP_TABLE default\n" + rows;
  };
  write("whole.vtk", grid + "VECTORS velocity float\n" + vectors);
  write("parts.vtk", grid + scalars("rho", z) + scalars("vel_y", y) + scalars("vel_z", z) + scalars("vel_x", x) +
                         scalars("mom_x", z) + scalars("mom_y", z) + scalars("mom_z", z));
  const std::vector<std::string> traced = {"--seeds", "line(0.2,0,0, 0.8,0,0, 4)", "--duration", "1.5", "-o"};
  const auto traced_to = [&](std::vector<std::string> arguments, const std::string& file) {
    arguments.insert(arguments.end(), traced.begin(), traced.end());
    arguments.push_back(path(file));
    const Outcome outcome = lines(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.err;
  };
  traced_to({path("whole.vtk")}, "whole.csv");
  // Velocities are found by their names; other arrays can be listed.
  EXPECT_NE(traced_to({path("parts.vtk")}, "found.csv").find("vel_x,vel_y,vel_z"), std::string::npos);
  EXPECT_EQ(slurp(path("found.csv")), slurp(path("whole.csv")));
  traced_to({path("parts.vtk"), "--array", "vel_x,vel_y,rho"}, "listed.csv");
  EXPECT_EQ(slurp(path("listed.csv")), slurp(path("whole.csv")));
  traced_to({path("parts.vtk"), path("parts.vtk"), "--unsteady", "--times", "0,3"}, "steps.csv");
  EXPECT_EQ(slurp(path("steps.csv")).substr(0, 40), slurp(path("whole.csv")).substr(0, 40));
  const Outcome speed = run({"volume", "probe", path("parts.vtk"), "--array", "vel_x,vel_y,vel_z:magnitude", "--method",
                             "linear", "--at", "0.5,0,0", "--json"});
  ASSERT_EQ(speed.code, 0) << speed.err;
  const auto wrong = lines({path("parts.vtk"), "--array", "vel_x,vel_y,vel_w", "-o", path("no.csv")});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.err.find("no array named 'vel_x,vel_y,vel_w'"), std::string::npos) << wrong.err;
}

TEST_F(FlowLinesTool, BothDirectionsMakeOneLine) {
  const Outcome outcome =
      lines({"saddle", "--seeds", "point(1,1,0)", "--direction", "both", "-o", path("l.csv"), "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto rows = rows_of(path("l.csv"));
  EXPECT_NEAR(rows.front()[3], 4, 1e-4);
  EXPECT_NEAR(rows.back()[2], 4, 1e-4);
  for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_GT(rows[i][1], rows[i - 1][1]);
  for (const std::vector<double>& row : rows) EXPECT_NEAR(row[2] * row[3], 1, 1e-3);  // x y is constant
}

/// Two steps, at rest and moving: a particle moves as far as half of the final speed.
TEST_F(FlowLinesTool, FilesAreStepsInTime) {
  image("a", [](const Vec3&) { return Vec3{1e-9, 0, 0}; });
  image("b", [](const Vec3&) { return Vec3{0.5, 0, 0}; });
  const auto end_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{path("a.mhd"), path("b.mhd"),     "--unsteady", "--times",    "0,2",
                                       "--seeds",     "point(-0.5,0,0)", "-o",         path("p.csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = lines(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return rows_of(path("p.csv")).back()[2];
  };
  EXPECT_NEAR(end_of({}), 0, 1e-3);
  EXPECT_NEAR(end_of({"--time-interpolation", "constant"}), -0.5, 1e-3);
}

TEST_F(FlowLinesTool, StreaksAndTimeLinesAreWhatTheySay) {
  Outcome outcome = lines({"rotation", "--kind", "time", "--seeds", "line(0.5,0,0, 1,0,0, 3)", "--duration", "1",
                           "--interval", "0.5", "-o", path("t.csv")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  auto rows = rows_of(path("t.csv"));
  ASSERT_EQ(rows.size(), 9u);
  for (const std::vector<double>& row : rows) EXPECT_NEAR(std::atan2(row[3], row[2]), 0.5 * row[0], 1e-3);
  outcome = lines({"rotation", "--kind", "streak", "--seeds", "point(1,0,0)", "--duration", "1", "--interval", "0.25",
                   "-o", path("s.csv")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  rows = rows_of(path("s.csv"));
  ASSERT_EQ(rows.size(), 5u);
  for (const std::vector<double>& row : rows) EXPECT_NEAR(std::atan2(row[3], row[2]), 1 - row[1], 1e-3);
}

TEST_F(FlowLinesTool, LinesAreWrittenInEveryFormat) {
  for (const std::string file : {"l.vtp", "l.ply"})
    for (const bool ascii : {false, true}) {
      std::vector<std::string> arguments{"abc", "--seeds", "box(8)", "--length", "5", "-o", path(file)};
      if (ascii) arguments.emplace_back("--ascii");
      const Outcome outcome = lines(arguments);
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      const std::string text = slurp(path(file));
      EXPECT_NE(text.find(file == "l.vtp" ? "NumberOfLines=\"8\"" : "element edge"), std::string::npos);
      EXPECT_NE(text.find("vorticity"), std::string::npos);
    }
}

/// Number of pixels that differ much from the first one, and of the coloured ones among them.
std::pair<std::size_t, std::size_t> drawn_and_coloured(const PngPicture& p, std::size_t columns) {
  std::size_t drawn = 0, coloured = 0;
  const auto paper = p.at(0, 0);
  for (std::size_t y = 0; y < p.height; ++y)
    for (std::size_t x = 0; x < columns; ++x) {
      const auto c = p.at(x, y);
      drawn += std::abs(c[0] - paper[0]) + std::abs(c[1] - paper[1]) + std::abs(c[2] - paper[2]) > 60;
      coloured += std::abs(c[0] - c[1]) + std::abs(c[1] - c[2]) > 40;
    }
  return {drawn, coloured};
}

TEST_F(FlowLinesTool, PreviewsShowTheLinesAsTubes) {
  const auto preview = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = more;
    arguments.insert(arguments.end(), {"-o", path("l.vtp"), "--preview", path("l.png"), "--json"});
    const Outcome outcome = lines(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(path("l.vtp")));
    return nlohmann::json::parse(outcome.out)["preview"];
  };
  // The view of a layer is perpendicular to it, so a circle is as wide as high; the width includes the bar.
  image("turn", [](const Vec3& x) { return Vec3{-x.y, x.x, 0}; });
  auto json = preview({path("turn.mhd"), "--seeds", "circle(0,0,0, 0,0,1, 0.8, 3); circle(0,0,0, 0,0,1, 0.4, 3)",
                       "--duration", "6", "--width", "400", "--height", "300", "--tube-radius", "0.02"});
  EXPECT_EQ(json["color_by"], "speed");
  EXPECT_NEAR(json["radius"].get<double>(), 0.02, 1e-12);
  EXPECT_NEAR(json["lower"].get<double>(), 0.4, 0.02);
  EXPECT_NEAR(json["upper"].get<double>(), 0.8, 0.02);
  PngPicture p = read_png(path("l.png"));
  ASSERT_EQ(p.width, 400u);
  ASSERT_EQ(p.height, 300u);
  std::size_t left = 400, right = 0, top = 300, bottom = 0;
  for (std::size_t y = 0; y < 300; ++y)
    for (std::size_t x = 0; x < 300; ++x)
      if (std::abs(p.at(x, y)[0] - p.at(0, 0)[0]) + std::abs(p.at(x, y)[2] - p.at(0, 0)[2]) > 60)
        left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
  EXPECT_GT(right - left, 150u);
  EXPECT_NEAR(static_cast<double>(right - left), static_cast<double>(bottom - top), 8);  // one side is lit
  const auto [drawn, coloured] = drawn_and_coloured(p, 300);
  EXPECT_GT(drawn, 1000u);
  EXPECT_LT(drawn, 30000u);
  EXPECT_GT(coloured, 500u);
  // Wider tubes, other colours, streaks.
  json = preview({path("turn.mhd"), "--seeds", "circle(0,0,0, 0,0,1, 0.8, 3); circle(0,0,0, 0,0,1, 0.4, 3)",
                  "--duration", "6", "--width", "400", "--height", "300", "--tube-radius", "0.06", "--color-by",
                  "vorticity", "--unit", "1/s"});
  EXPECT_EQ(json["color_by"], "vorticity");
  EXPECT_GT(drawn_and_coloured(read_png(path("l.png")), 300).first, 2 * drawn);
  json =
      preview({"abc", "--kind", "streak", "--seeds", "box(4)", "--duration", "5", "--width", "300", "--height", "200"});
  EXPECT_EQ(json["color_by"], "time");
  EXPECT_GT(drawn_and_coloured(read_png(path("l.png")), 200).first, 200u);
}

TEST_F(FlowLinesTool, SurfacesAreMeshesOfTheSeedCurve) {
  const auto surface = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"flow", "surface"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.insert(arguments.end(), {"-o", path("s.ply"), "--json"});
    return run(arguments);
  };
  // A quarter of a ring.
  Outcome outcome = surface({"rotation", "--seeds", "line(0.5,0,0, 1,0,0, 40)", "--duration", "1.5707963"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  auto json = nlohmann::json::parse(outcome.out);
  EXPECT_NEAR(json["area"].get<double>(), 0.25 * 3.14159265 * 0.75, 2e-3);
  EXPECT_EQ(json["surface"]["tears"], 0);
  const std::string text = slurp(path("s.ply"));
  for (const std::string name : {"nx", "s", "time", "speed", "front"})
    EXPECT_NE(text.find(" " + name + "\n"), std::string::npos) << name;
  // A tube, and a sheet.
  outcome = surface({"helix", "--seeds", "circle(0,0,0, 0,0,1, 0.5, 60)", "--duration", "1"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NEAR(nlohmann::json::parse(outcome.out)["area"].get<double>(), 3.14159265, 0.02);
  outcome = surface(
      {"helix", "--kind", "time", "--sweep", "0,0,0.5", "--seeds", "line(0.5,0,0, 1,0,0, 20)", "--duration", "1"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NEAR(nlohmann::json::parse(outcome.out)["area"].get<double>(), 0.25, 1e-3);

  for (const auto& [arguments, why] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"rotation"}, "--seeds is required"},
           {{"rotation", "--seeds", "box(20)"}, "must be a curve"},
           {{"rotation", "--seeds", "line(5,0,0, 6,0,0, 9)"}, "is between"},
           {{"rotation", "--seeds", "line(0,0,0, 1,0,0, 9)", "--alpha", "0.5"}, "--alpha"}}) {
    const Outcome refused = surface(arguments);
    EXPECT_NE(refused.code, 0);
    EXPECT_NE(refused.err.find(why), std::string::npos) << refused.err;
  }
}

TEST_F(FlowLinesTool, SeedsThatAreNoneAreTold) {
  write("gap.csv", "x,y,z\n0.5,0,0\nnan,0,0\n0.9,0,0\n0.9,0,0\n1,0,0\n");
  write("nan.csv", "x,y,z\nnan,0,0\n0,nan,0\n");
  write("equal.csv", "x,y,z\n0.5,0,0\n0.5,0,0\n");
  write("one.csv", "x,y,z\n0.5,0,0\n");
  write("far.csv", "x,y,z\n8,0,0\n9,0,0\n");
  std::string mesh =
      "ply\nformat ascii 1.0\nelement vertex 5000\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < 5000; ++i) mesh += std::to_string(0.0002 * (i + 1)) + " 0 0\n";
  write("many.ply", mesh + "3 0 1 2\n");
  const auto told = [&](std::vector<std::string> arguments, const std::string& warning) {
    arguments.insert(arguments.begin(), "flow");
    arguments.insert(arguments.end(), {"--duration", "0.5", "-o", path("o.ply"), "--json"});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err.empty(), warning.empty()) << outcome.err;
    EXPECT_NE(outcome.err.find(warning), std::string::npos) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  };
  EXPECT_EQ(told({"lines", "rotation", "--seeds", "points(gap.csv)"},
                 "gap.csv: 1 of 5 seeds dropped: not finite")["seeds"]["count"],
            4);
  told({"lines", "rotation", "--seeds", "line(0.5,0,0, 5,0,0, 10)"}, "6 of 10 seeds outside");
  EXPECT_EQ(told({"lines", "rotation", "--seeds", "mesh(many.ply)"}, "")["output"]["lines"], 5000);
  // Repeated points of the curve are allowed; points on the boundary of the flow count as inside.
  const auto ring = told({"surface", "rotation", "--seeds", "curve(gap.csv)", "--particles", "50"}, "1 of 5 seeds");
  EXPECT_NEAR(ring["area"].get<double>(), 0.25 * (1 - 0.25), 1e-3);
  EXPECT_EQ(told({"surface", "rotation", "--seeds", "line(0,0,2, 1,0,2, 20)"}, "")["surface"]["tears"], 0);
  told({"surface", "rotation", "--seeds", "line(0.5,0,0, 5,0,0, 10)"}, "6 of 10 particles started outside");

  const auto surface = [&](const std::string& seeds) {
    return std::vector<std::string>{"flow", "surface", "rotation", "--seeds", seeds, "--duration", "1", "-o", "x.ply"};
  };
  const auto some_lines = [&](const std::string& seeds, const std::string& time = "1") {
    return std::vector<std::string>{"flow", "lines", "rotation", "--seeds", seeds, "--duration", time, "-o", "x.ply"};
  };
  expect_failures({
      {some_lines("points(nan.csv)"), 1, {"nan.csv: holds no finite points"}},
      {some_lines("points(far.csv)"), 1, {"rotation: no seed is in the flow"}},
      {some_lines("point(0.5,0,0)", "nan"), 2, {"--duration must be finite, not nan"}},
      {surface("curve(nan.csv)"), 1, {"nan.csv: holds no finite points"}},
      {surface("curve(far.csv)"), 1, {"rotation: no part of the seed curve is in the flow"}},
      {surface("curve(equal.csv)"), 1, {"equal.csv: the points of the seed curve coincide"}},
      {surface("curve(one.csv)"), 1, {"one.csv: a seed curve has at least two points"}},
      {surface("loop(equal.csv)"), 1, {"equal.csv: a closed seed curve has at least three points"}},
      {surface("line(1,0,0, 1,0,0, 9)"), 2, {"--seeds: the points of the seed curve coincide"}},
      {surface("mesh(many.ply)"), 2, {"--seeds must be a curve"}},
  });
}

TEST_F(FlowLinesTool, SaysWhatIsWrongInOneLine) {
  image("still", [](const Vec3&) { return Vec3{}; });
  write("points.csv", "x,y,z,v\n0,0,0,1\n1,0,0,2\n0,1,0,3\n0,0,1,4\n1,1,1,5\n");
  const auto refused = [&](const std::vector<std::string>& more, const std::string& why) {
    std::vector<std::string> arguments = more;
    arguments.insert(arguments.end(), {"-o", path("x.vtp")});
    const Outcome outcome = lines(arguments);
    EXPECT_NE(outcome.code, 0);
    EXPECT_NE(outcome.err.find(why), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(path("x.vtp")));
  };
  refused({path("still.mhd")}, "zero at all seeds");
  refused({path("points.csv")}, "has no vectors");
  refused({"rotation", "--seeds", "point(9,0,0)"}, "no seed is in the flow");
  refused({"rotation", "--seeds", "line(1,2)"}, "line(ax,ay,az");
  refused({"nowhere"}, "no flow by formula");
  refused({path("still.mhd"), "--unsteady"}, "one step in time");
  refused({"rotation", "--kind", "streak", "--direction", "both"}, "have one direction");
  refused({"rotation", "--color-by", "speed"}, "need --preview");
  refused({"rotation", "--preview", path("p.png"), "--color-by", "heat"}, "time, speed, velocity, vorticity");
  refused({"rotation", "--preview", path("p.png"), "--tube-radius", "0"}, "--tube-radius");
  refused({"rotation", "--preview", path("p.png"), "--width", "50"}, "--width 50");
  refused({"rotation", "--preview", path("p.jpg")}, "p.jpg");
  refused({"rotation", "--seeds", "points(" + path("no.csv") + ")"}, "no.csv");
}

}  // namespace
}  // namespace sansmesh::test
