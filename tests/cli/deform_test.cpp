#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "ball_volume.h"
#include "run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/io/grids/read_volume.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

constexpr double kPi = std::numbers::pi;

/// Eight corners of a cube about the origin that rotate about the z axis and move as one body.
std::string body_handles(double half, double degrees, double along) {
  Json list = Json::array();
  const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
  for (int i = 0; i < 8; ++i) {
    const double x = i & 1 ? half : -half, y = i & 2 ? half : -half, z = i & 4 ? half : -half;
    list.push_back({{"p", {x, y, z}}, {"q", {c * x - s * y + along, s * x + c * y, z}}, {"group", "body"}});
  }
  return Json{{"handles", list}}.dump();
}

/// The upper four corners rotate against the lower ones.
std::string twist_handles() {
  Json list = Json::array();
  for (int i = 0; i < 8; ++i) {
    const double x = i & 1 ? 1 : -1, y = i & 2 ? 1 : -1, z = i & 4 ? 1 : -1;
    Json h{{"p", {x, y, z}}};
    if (z > 0) h["q"] = {-y, x, z};
    list.push_back(h);
  }
  return Json{{"handles", list}}.dump();
}

class DeformTool : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write("body.json", body_handles(1, 90, 3));
    write("twist.json", twist_handles());
    write("points.csv", "x,y,z,weight\n0.5,0,0,7\n0,0.25,0,8\n0,0,-1,9\n");
  }
};

TEST_F(DeformTool, MovesCloudsWithTheirAttributes) {
  const Json json = json_of({"deform", "points.csv", "--handles", "body.json", "-o", "moved.ply"});
  EXPECT_EQ(json["deformation"]["kind"], "rigid");
  EXPECT_EQ(json["deformation"]["handles"], 8);
  const PointSet moved = read_points(path("moved.ply"));
  ASSERT_EQ(moved.size(), 3u);
  const Vec3 expected[] = {{3, 0.5, 0}, {2.75, 0, 0}, {3, 0, -1}};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(norm(moved.origin + Vec3(moved.positions[i]) - expected[i]), 1e-6);
  const Attribute* const weight = moved.attributes.find("weight");
  ASSERT_NE(weight, nullptr);
  EXPECT_EQ(weight->number(2), 9);
}

TEST_F(DeformTool, CutsFunctionsOutAfterTheyAreDeformed) {
  const Json json =
      json_of({"deform", "box(2) - cylinder(r=0.5)", "--handles", "twist.json", "-o", "t.ply", "--resolution", "40"});
  EXPECT_TRUE(json["output"]["closed"]);
  EXPECT_NEAR(json["output"]["volume"].get<double>(), 8, 0.8);
  EXPECT_EQ(json["output"]["folded"], 0);
  // A rigid motion preserves areas.
  const Json section = json_of({"deform", "sphere(1)", "--handles", "body.json", "-o", "s.svg", "--plane", "z=0"});
  EXPECT_NEAR(section["output"]["sections"][0]["area"].get<double>(), kPi, 1e-3);
  EXPECT_NE(slurp(path("s.svg")).find("<svg"), std::string::npos);
  const Json table = json_of({"deform", "sphere(1)", "--handles", "body.json", "-o", "s.csv", "--plane", "x=3"});
  EXPECT_NEAR(table["output"]["sections"][0]["area"].get<double>(), kPi, 1e-3);
}

TEST_F(DeformTool, RefinesMeshesWhereTheyBend) {
  ASSERT_EQ(run({"csg", "box(2)", "-o", "box.ply", "--resolution", "8"}).code, 0);
  const std::size_t before = read_mesh(path("box.ply")).triangles.size();
  const Json same = json_of({"deform", "box.ply", "--handles", "twist.json", "-o", "a.ply"});
  EXPECT_EQ(same["output"]["triangles"], before);
  const Json finer = json_of({"deform", "box.ply", "--handles", "twist.json", "-o", "b.ply", "--refine", "0.01"});
  EXPECT_GT(finer["output"]["triangles"].get<std::size_t>(), before);
  EXPECT_EQ(finer["output"]["added"].get<std::size_t>() + before, finer["output"]["triangles"].get<std::size_t>());
}

TEST_F(DeformTool, PosesGoFromBeforeToAfter) {
  const Outcome o = run({"deform", "points.csv", "--handles", "body.json", "-o", "f.ply", "--frames", "3"});
  ASSERT_EQ(o.code, 0) << o.err;
  const PointSet first = read_points(path("f_000.ply")), half = read_points(path("f_001.ply")),
                 last = read_points(path("f_002.ply"));
  EXPECT_LT(norm(first.origin + Vec3(first.positions[0]) - Vec3{0.5, 0, 0}), 1e-6);
  EXPECT_LT(norm(last.origin + Vec3(last.positions[0]) - Vec3{3, 0.5, 0}), 1e-6);
  // A quarter rotation about an axis through (1.5, 1.5): half of it is on the arc, not on the straight line.
  const double r = std::hypot(1.5 - 0.5, 1.5);
  EXPECT_NEAR(norm(half.origin + Vec3(half.positions[0]) - Vec3{1.5, 1.5, 0}), r, 1e-5);
}

TEST_F(DeformTool, PairsOfMeshesSayWhereVerticesWent) {
  ASSERT_EQ(run({"deform", "points.csv", "--handles", "body.json", "-o", "after.ply"}).code, 0);
  const Outcome o =
      run({"deform", "points.csv", "--handles-from", "points.csv,after.ply", "--vertices", "0,1,2", "-o", "again.ply"});
  ASSERT_EQ(o.code, 0) << o.err;
  const PointSet a = read_points(path("after.ply")), b = read_points(path("again.ply"));
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LT(norm(a.origin + Vec3(a.positions[i]) - b.origin - Vec3(b.positions[i])), 1e-5);
}

TEST_F(DeformTool, ResamplesAndDrawsVolumes) {
  write(kBallFile, ball_bytes());
  std::string handles = "px,py,pz,qx,qy,qz\n";
  for (int i = 0; i < 8; ++i) {
    const int x = i & 1 ? 16 : 0, y = i & 2 ? 16 : 0, z = i & 4 ? 16 : 0;
    handles += std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(z) + "," + std::to_string(2 * x) +
               "," + std::to_string(y) + "," + std::to_string(z) + "\n";
  }
  write("wide.csv", handles);
  const Json json = json_of({"deform", kBallFile, "--handles", "wide.csv", "--kind", "affine", "--box",
                             "0,0,0,32,16,16", "--size", "33", "17", "17", "-o", "wide.nrrd"});
  EXPECT_EQ(json["output"]["size"], (std::vector<int>{33, 17, 17}));
  EXPECT_NEAR(json["output"]["inside"].get<double>(), 1, 1e-9);
  const GridData data = read_volume(path("wide.nrrd"));
  const Attribute& values = data.blocks[0].point_arrays[0];
  // 7 in the centre; at twice the distance along x, the decrease is the same as before.
  EXPECT_NEAR(values.number(16 + 33 * (8 + 17 * 8)), 7, 0.1);
  EXPECT_NEAR(values.number(24 + 33 * (8 + 17 * 8)), 3, 0.1);
  EXPECT_NEAR(values.number(16 + 33 * (12 + 17 * 8)), 3, 0.1);
  const Outcome picture =
      run({"deform",   kBallFile, "--handles",        "wide.csv", "--kind",         "affine",       "-o",      "b.png",
           "--iso",    "2",       "--opacity-factor", "0",        "--draw-handles", "--draw-folds", "--width", "64",
           "--height", "48",      "--map-nodes",      "16"});
  ASSERT_EQ(picture.code, 0) << picture.err;
  EXPECT_EQ(slurp(path("b.png")).substr(1, 3), "PNG");
}

TEST_F(DeformTool, FoldsAreToldWithTheRemedy) {
  // Two neighbours exchange positions.
  write("cross.csv",
        "0,0,0,1,0,0\n1,0,0,0,0,0\n0,1,0,0,1,0\n1,1,0,1,1,0\n0,0,1,0,0,1\n1,0,1,1,0,1\n0,1,1,0,1,1\n1,1,1,1,1,1\n");
  const Outcome o = run({"deform", "box(from=(0,0,0), to=(1,1,1))", "--handles", "cross.csv", "-o", "c.ply",
                         "--resolution", "16", "--json"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_NE(o.err.find("space folds in"), std::string::npos) << o.err;
  EXPECT_NE(o.err.find("--alpha"), std::string::npos);
  const Json json = Json::parse(o.out);
  EXPECT_GT(json["output"]["folded"].get<double>(), 0.001);
  EXPECT_GE(json["output"]["folds"].size(), 1u);
}

TEST_F(DeformTool, SaysWhatIsWrongInALine) {
  write("two.json", R"({"handles": [{"p": [0,0,0], "q": [1,0,0]}, {"p": [1,0,0], "q": [2,0,0]}]})");
  write("bad.json", R"({"handles": [{"p": [0,0,0], "wieght": 2}]})");
  const auto with = [](std::vector<std::string> more) {
    std::vector<std::string> all{"deform", "points.csv"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  expect_failures({
      {with({"-o", "a.ply"}), 2, {"--handles", "--map"}},
      {with({"--handles", "body.json", "--map", "m.vti", "-o", "a.ply"}), 2, {"one of"}},
      {with({"--handles", "none.json", "-o", "a.ply"}), 1, {"none.json", "no such file"}},
      {with({"--handles", "bad.json", "-o", "a.ply"}), 1, {"bad.json", "handle 1", "'wieght'"}},
      {with({"--handles", "two.json", "--kind", "affine", "-o", "a.ply"}), 1, {"two.json", "4"}},
      {with({"--handles", "body.json", "--degree", "3", "-o", "a.ply"}), 2, {"--degree", "nonlinear"}},
      {with({"--handles", "body.json", "--alpha", "0", "-o", "a.ply"}), 2, {"--alpha"}},
      {with({"--handles", "body.json", "--frames", "1", "-o", "a.ply"}), 2, {"--frames"}},
      {with({"--handles", "body.json", "-o", "a.vti"}), 1, {"a.vti"}},
      {with({"--handles", "body.json", "--refine", "0.1", "-o", "a.ply"}), 2, {"--refine"}},
      {with({"--handles", "body.json", "--draw-handles", "-o", "a.ply"}), 2, {"--draw-handles"}},
      {with({"--handles", "body.json", "--displacement-map", "16", "-o", "a.ply"}), 2, {"--displacement-map", ".vti"}},
      {with({"--handles-from", "points.csv,points.csv", "--vertices", "3", "-o", "a.ply"}), 2, {"vertex 3"}},
      {with({"--handles-from", "points.csv", "-o", "a.ply"}), 2, {"--handles-from"}},
      {{"deform", "none.ply", "--handles", "body.json", "-o", "a.ply"}, 1, {"none.ply", "does not exist"}},
      {{"deform", "sphere(1", "--handles", "body.json", "-o", "a.ply"}, 2, {"expression at"}},
      {{"deform", "plane(z)", "--handles", "body.json", "-o", "a.ply"}, 2, {"--box"}},
  });
}

}  // namespace
}  // namespace sansmesh::test
