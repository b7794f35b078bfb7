// Tests of `simulate`.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "run_tool.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/io.h"
#include "sansmesh/io/grids/read_volume.h"
#include "support/png_file.h"
#include "support/tet_shapes.h"

namespace sansmesh::test {
namespace {

class SimulateTool : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    // A bar of 4 × 1 × 1; Medit numbers vertices from 1.
    const TetMesh mesh = test::box_of_tets({0, 0, 0}, {4, 1, 1}, 4, 1, 1);
    std::string text = fmt::format("MeshVersionFormatted 1\nDimension 3\nVertices {}\n", mesh.vertices.size());
    for (const Vec3& p : mesh.vertices) text += fmt::format("{} {} {} 0\n", p.x, p.y, p.z);
    text += fmt::format("Tetrahedra {}\n", mesh.tets.size());
    for (const Tet& t : mesh.tets) text += fmt::format("{} {} {} {} 0\n", t[0] + 1, t[1] + 1, t[2] + 1, t[3] + 1);
    write("bar.mesh", text + "End\n");
    write("bar.bou", "1, 6, 11,\n16\n");
    write("turn.json",
          R"({"fixed": "bar.bou", "gravity": 0,
              "handles": {"on": {"side": "+x"}, "turn": {"axis": [1, 0, 0], "degrees": 90}, "until": 0.4}})");
  }
};

TEST_F(SimulateTool, HangsOnItsFixedVertices) {
  const auto json = json_of({"simulate", "bar.mesh", "--fixed", "bar.bou", "--young", "2e5", "-o", "bar.ply", "-o",
                             "bar.vtu", "--energies", "e.csv", "--duration", "0.4", "--fps", "10"});
  EXPECT_EQ(json["scene"]["fixed"], 4);
  EXPECT_EQ(json["scene"]["floors"], 0);
  EXPECT_EQ(json["model"], "corotational");
  EXPECT_EQ(json["steps"], 40);
  EXPECT_EQ(json["output"]["frames"], 5);
  const TriangleMesh first = read_mesh(path("bar_0000.ply")), last = read_mesh(path("bar_0004.ply"));
  ASSERT_EQ(last.vertices.size(), first.vertices.size());
  double lowest = 0;
  for (std::size_t v = 0; v < first.vertices.size(); ++v) {
    const Vec3 a = first.origin + Vec3(first.vertices[v]), b = last.origin + Vec3(last.vertices[v]);
    if (a.x == 0) EXPECT_NEAR(norm(b - a), 0, 1e-6);
    lowest = std::min(lowest, b.y - a.y);
  }
  EXPECT_LT(lowest, -0.05);
  std::string header;
  const auto rows = number_rows(path("e.csv"), &header);
  EXPECT_EQ(header, "time,kinetic,elastic,gravity,total,iterations,step,contacts");
  ASSERT_EQ(rows.size(), 41u);
  EXPECT_NEAR(rows[40][0], 0.4, 1e-9);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    EXPECT_NEAR(rows[k][4], rows[k][1] + rows[k][2] + rows[k][3], 1e-6 * std::abs(rows[k][3]));
    EXPECT_LE(rows[k][4], rows[k - 1][4] + 1e-3 * std::abs(rows[0][3])) << "energy came from nowhere";
  }
  EXPECT_NE(slurp(path("bar.pvd")).find("timestep=\"0.2\" part=\"0\" file=\"bar_0002.vtu\""), std::string::npos);
  if (has_vtk_readers()) EXPECT_EQ(read_volume(path("bar_0004.vtu")).blocks[0].cells.size(), 24u);
}

TEST_F(SimulateTool, HandlesTurnTheFarEnd) {
  // A surface inside the bar moves with it; vertex numbers in scenes are those of the file.
  write("square.obj", "v 4 0 0\nv 4 1 0\nv 4 1 1\nv 4 0 1\nf 1 2 3\nf 1 3 4\n");
  const Outcome o =
      run({"simulate", "bar.mesh", "--forces", "turn.json", "--embedded-mesh", "square.obj", "-o", "s.obj", "--frames",
           "3", "--duration", "0.4", "--integrator", "velocity-verlet", "--longest-step", "0.002"});
  ASSERT_EQ(o.code, 0) << o.err;
  const TriangleMesh m = read_mesh(path("s_0002.obj"));
  const Vec3 corner = m.origin + Vec3(m.vertices[1]);
  // (1, 0) rotated about the centre (0.5, 0.5) by a quarter turn from y to z.
  EXPECT_NEAR(norm(corner - Vec3{4, 1, 1}), 0, 1e-4);
  EXPECT_EQ(listing(), (std::vector<std::string>{"bar.bou", "bar.mesh", "s_0000.obj", "s_0001.obj", "s_0002.obj",
                                                 "square.obj", "turn.json"}));
}

TEST_F(SimulateTool, DrawsFramesAndAnAnimationOfBodiesAndVolumes) {
  write("v.csv", "x,y,z,f\n0,0,0,0\n4,0,0,1\n0,1,0,0\n4,1,0,1\n0,0,1,0.2\n4,0,1,1.2\n0,1,1,0.2\n4,1,1,1.2\n");
  ASSERT_EQ(run({"volume", "resample", "v.csv", "--size", "12", "--method", "linear", "-o", "v.vti"}).code, 0);
  const std::vector<std::vector<std::string>> looks{{}, {"--embedded-volume", "v.vti", "--iso", "0.5"}};
  for (const auto& look : looks) {
    if (!look.empty() && !has_vtk_readers()) continue;
    std::vector<std::string> all{"simulate", "bar.mesh",   "-o",  "b.png",   "--animation", "a.png",    "--frames",
                                 "3",        "--duration", "0.6", "--width", "64",          "--height", "48"};
    all.insert(all.end(), look.begin(), look.end());
    const auto json = json_of(all);
    EXPECT_EQ(json["scene"]["floors"], 1) << "it falls on something";
    EXPECT_EQ(json["output"]["files"].size(), 4u);
    EXPECT_NE(slurp(path("b_0000.png")), slurp(path("b_0001.png")));
    EXPECT_NE(slurp(path("a.png")).find("acTL"), std::string::npos);
    EXPECT_GT(std::filesystem::file_size(path("b_0002.png")), 800u);
  }
}

TEST_F(SimulateTool, VolumesGoWhereTheirTetrahedraGo) {
  if (!has_vtk_readers()) GTEST_SKIP();
  // The bar is pulled to the right by its own length, so the visible sheet of its volume moves as well.
  write("v.csv", "x,y,z,f\n0,0,0,0\n4,0,0,1\n0,1,0,0\n4,1,0,1\n0,0,1,0\n4,0,1,1\n0,1,1,0\n4,1,1,1\n");
  ASSERT_EQ(run({"volume", "resample", "v.csv", "--size", "12", "--method", "linear", "-o", "v.vti"}).code, 0);
  write("pull.json", R"({"gravity": 0, "handles": {"on": {"box": {"lower": [-1, -1, -1], "upper": [9, 9, 9]}},
                         "move": [4, 0, 0], "until": 0.2}})");
  const Outcome o = run({"simulate",          "bar.mesh", "--forces",   "pull.json",
                         "--embedded-volume", "v.vti",    "--iso",      "0.5:#ff0000:1",
                         "--opacity-factor",  "0",        "--view",     "front",
                         "--background",      "white",    "-o",         "b.png",
                         "--frames",          "2",        "--duration", "0.2",
                         "--width",           "160",      "--height",   "80"});
  ASSERT_EQ(o.code, 0) << o.err;
  const auto red_column = [&](const char* file) {
    const PngPicture image = read_png(path(file));
    double sum = 0, count = 0;
    for (std::size_t y = 0; y < image.height; ++y)
      for (std::size_t x = 0; x < image.width; ++x)
        if (const auto c = image.at(x, y); c[0] > c[1] + 50) sum += static_cast<double>(x), ++count;
    EXPECT_GT(count, 3) << file;
    return sum / std::max(count, 1.0);
  };
  // The camera shows 8 units in somewhat less than 160 pixels.
  const double moved = red_column("b_0001.png") - red_column("b_0000.png");
  EXPECT_GT(moved, 45);
  EXPECT_LT(moved, 90);
}

TEST_F(SimulateTool, FloorsOfScenesStandAcrossTheirUp) {
  write("floor.json", R"({"floor": {"height": -0.5}})");
  const auto json = json_of(
      {"simulate", "bar.mesh", "--forces", "floor.json", "--z-up", "--duration", "1", "-o", "a.ply", "--fps", "5"});
  EXPECT_GT(json["most_contacts"], 4);
  const TriangleMesh last = read_mesh(path("a_0005.ply"));
  for (const Vec3f& p : last.vertices) EXPECT_GT(last.origin.z + static_cast<double>(p.z), -0.6);
}

TEST_F(SimulateTool, WarnsOfBodiesThatBeginWithinObstacles) {
  write("in.json", R"({"spheres": {"center": [0, 0, 0], "radius": 0.5}, "gravity": 0})");
  const Outcome o = run(
      {"simulate", "bar.mesh", "--forces", "in.json", "--energies", "e.csv", "--frames", "2", "--duration", "0.02"});
  EXPECT_EQ(o.code, 0);
  EXPECT_NE(o.err.find("1 vertex starts within an obstacle"), std::string::npos) << o.err;
}

TEST_F(SimulateTool, NothingIsWrittenWhereAnInputOfPicturesIsWrong) {
  write("volume.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n0,0,1\n");
  const auto before = listing();
  expect_failures({
      {{"simulate", "bar.mesh", "-o", "a.vtu", "-o", "a.png", "--embedded-volume", "none.vti"}, 1, {"none.vti: "}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "-o", "a.png", "--embedded-volume", "volume.csv"}, 1, {"volume.csv: "}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--animation", "b.png", "--fps", "2000", "--duration", "0.01"},
       2,
       {"--fps"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--longest-step", "1e-300"},
       2,
       {"--longest-step", "more than 1e+08 steps"}},
      {{"simulate", "bar.mesh", "-o", "bar.mesh"}, 1, {"no writer for frames"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--unit", "1e300"}, 2, {"--unit"}},
  });
  EXPECT_EQ(listing(), before);
  // Generated names of frames.
  ASSERT_EQ(run({"simulate", "bar.mesh", "-o", "a.ply", "--frames", "2", "--duration", "0.02"}).code, 0);
  expect_failures({{{"simulate", "bar.mesh", "--embedded-mesh", "a_0000.ply", "-o", "a.ply", "--frames", "2"},
                    1,
                    {"a_0000.ply: is an input"}}});
}

TEST_F(SimulateTool, MaterialsOfTheFileAreTakenAsTheyAre) {
  const auto vega = [&](const std::string& materials) {
    return "*VERTICES\n4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n*ELEMENTS\nTET\n1 4 0\n1 1 2 3 4\n" + materials;
  };
  write("cork.veg", vega("*MATERIAL cork\nENU, 200, 1e5, 0\n*REGION\nallElements, cork\n"));
  const auto json = json_of({"simulate", "cork.veg", "--energies", "e.csv", "--frames", "2", "--duration", "0.02"});
  EXPECT_EQ(json["poisson"], 0);
  EXPECT_EQ(json["young"], 1e5);
  EXPECT_EQ(json["density"], 200);
  write("rubber.veg", vega("*MATERIAL rubber\nENU, 200, 1e5, 0.495\n*REGION\nallElements, rubber\n"));
  expect_failures({{{"simulate", "rubber.veg", "--energies", "e.csv"}, 1, {"rubber.veg: ", "Poisson's ratio 0.495"}}});
}

TEST_F(SimulateTool, SaysInALineWhatIsWrong) {
  write("flat.mesh",
        "MeshVersionFormatted 1\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n1 1 0 0\nTetrahedra 1\n1 2 3 4 "
        "0\nEnd\n");
  write("far.bou", "1 99\n");
  write("unknown.json", R"({"fixed": [1], "gravty": 2})");
  write("nowhere.json", R"({"fixed": {"ball": {"center": [9, 9, 9], "radius": 1}}})");
  write("broken.json", R"({"fixed": [1)");
  write("twice.json", R"({"fixed": [1, 2], "handles": {"on": [2, 3], "move": [1, 0, 0]}})");
  write("cut.mesh", slurp(path("bar.mesh")).substr(0, 300));
  expect_failures({
      {{"simulate", "bar.mesh"}, 2, {"nothing to write"}},
      {{"simulate", "none.mesh", "-o", "a.ply"}, 1, {"none.mesh: no such file"}},
      {{"simulate", "flat.mesh", "-o", "a.ply"}, 1, {"flat.mesh: cell 0 (counted from 0) has no volume"}},
      {{"simulate", "cut.mesh", "-o", "a.ply"}, 1, {"cut.mesh: ", "truncated"}},
      {{"simulate", "bar.bou", "-o", "a.ply"}, 1, {"bar.bou: "}},
      {{"simulate", "bar.mesh", "-o", "a.gif"}, 1, {"a.gif: no writer for frames"}},
      {{"simulate", "bar.mesh", "-o", "none/a.vtu"}, 1, {"none/a_0000.vtu: cannot be written"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--fixed", "far.bou"},
       1,
       {"far.bou: there is no vertex 99", "from 1 to 20"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--forces", "unknown.json"}, 1, {"unknown.json: unknown key 'gravty'"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--forces", "nowhere.json"},
       1,
       {"nowhere.json: fixed: no vertex is there"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--forces", "broken.json"}, 1, {"broken.json: is not JSON"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--forces", "twice.json"},
       1,
       {"twice.json: handles.on: the vertex at", "is fixed or pulled already"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--poisson", "0.7"}, 2, {"--poisson"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--integrator", "explicit-euler", "--damping", "0"},
       2,
       {"explicit-euler is unstable"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--frames", "3", "--fps", "2", "--duration", "1"}, 2, {"only two of"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--embedded-volume", "v.vti"}, 2, {"--embedded-volume needs pictures"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--duration", "0.001"}, 2, {"--duration", "shorter than a frame"}},
      // An explicit step far beyond the stability limit: the body explodes.
      {{"simulate", "bar.mesh", "-o", "a.ply", "--fixed", "bar.bou", "--integrator", "explicit-euler", "--longest-step",
        "0.04", "--young", "1e8"},
       1,
       {"bar.mesh: ", "step"}},
  });
}

}  // namespace
}  // namespace sansmesh::test
