// Tetrahedra that move, from the command line.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "run_tool.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/io/io.h"
#include "sansmesh/io/read_volume.h"

namespace sansmesh::test {
namespace {

class SimulateTool : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    // A bar of 4 × 1 × 1, whose vertices Medit counts from 1.
    const TetMesh mesh = box_of_tets({0, 0, 0}, {4, 1, 1}, 4, 1, 1);
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
                             "bar.vtu", "--energies", "e.csv", "--time", "0.4", "--fps", "10"});
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
  // A surface that lies in the bar moves with it; vertices of scenes are those of the file.
  write("square.obj", "v 4 0 0\nv 4 1 0\nv 4 1 1\nv 4 0 1\nf 1 2 3\nf 1 3 4\n");
  const Outcome o = run({"simulate", "bar.mesh", "--forces", "turn.json", "--surface", "square.obj", "-o", "s.obj",
                         "--frames", "3", "--time", "0.4", "--integrator", "velocity-verlet", "--step", "0.002"});
  ASSERT_EQ(o.code, 0) << o.err;
  const TriangleMesh m = read_mesh(path("s_0002.obj"));
  const Vec3 corner = m.origin + Vec3(m.vertices[1]);
  // (1, 0) about the middle (0.5, 0.5), a quarter turn from y to z.
  EXPECT_NEAR(norm(corner - Vec3{4, 1, 1}), 0, 1e-4);
  EXPECT_EQ(listing(), (std::vector<std::string>{"bar.bou", "bar.mesh", "s_0000.obj", "s_0001.obj", "s_0002.obj",
                                                 "square.obj", "turn.json"}));
}

TEST_F(SimulateTool, DrawsFramesAndAnAnimationOfBodiesAndVolumes) {
  write("v.csv", "x,y,z,f\n0,0,0,0\n4,0,0,1\n0,1,0,0\n4,1,0,1\n0,0,1,0.2\n4,0,1,1.2\n0,1,1,0.2\n4,1,1,1.2\n");
  ASSERT_EQ(run({"volume", "resample", "v.csv", "--size", "12", "--method", "linear", "-o", "v.vti"}).code, 0);
  const std::vector<std::vector<std::string>> looks{{}, {"--volume", "v.vti", "--iso", "0.5"}};
  for (const auto& look : looks) {
    if (!look.empty() && !has_vtk_readers()) continue;
    std::vector<std::string> all{"simulate", "bar.mesh", "-o",  "b.png",   "--animation", "a.png",    "--frames",
                                 "3",        "--time",   "0.6", "--width", "64",          "--height", "48"};
    all.insert(all.end(), look.begin(), look.end());
    const auto json = json_of(all);
    EXPECT_EQ(json["scene"]["floors"], 1) << "it falls on something";
    EXPECT_EQ(json["output"]["files"].size(), 4u);
    EXPECT_NE(slurp(path("b_0000.png")), slurp(path("b_0001.png")));
    EXPECT_NE(slurp(path("a.png")).find("acTL"), std::string::npos);
    EXPECT_GT(std::filesystem::file_size(path("b_0002.png")), 800u);
  }
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
      {{"simulate", "bar.mesh"}, 2, {"nothing would be written"}},
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
       {"nowhere.json: fixed: no vertex lies there"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--forces", "broken.json"}, 1, {"broken.json: is no JSON"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--forces", "twice.json"},
       1,
       {"twice.json: handles.on: the vertex at", "is fixed or pulled already"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--poisson", "0.7"}, 2, {"--poisson"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--frames", "3", "--fps", "2", "--time", "1"},
       2,
       {"only two can be given"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--volume", "v.vti"}, 2, {"--volume needs pictures"}},
      {{"simulate", "bar.mesh", "-o", "a.ply", "--time", "0.001"}, 2, {"--time", "shorter than a frame"}},
      // Explicit and much too long: it explodes.
      {{"simulate", "bar.mesh", "-o", "a.ply", "--fixed", "bar.bou", "--integrator", "explicit-euler", "--step", "0.04",
        "--young", "1e8"},
       1,
       {"bar.mesh: ", "step"}},
  });
}

}  // namespace
}  // namespace sansmesh::test
