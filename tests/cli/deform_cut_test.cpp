// Deformations with cuts, from the command line.
#include <filesystem>
#include <string>
#include <vector>

#include "ball_volume.h"
#include "run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "support/mesh_shapes.h"

namespace sansmesh::test {
namespace {

const std::string kSlot = "half-plane(-0.1,0,0.01; 0,0,1; 1,0,0)";

class DeformCutTool : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write_mesh(path("ball.ply"), octasphere(3));
    std::string handles;
    for (const char* x : {"-1", "1"})
      for (const char* y : {"-1", "1"})
        for (const char* z : {"-1", "1"}) {
          const std::string p = std::string("[") + x + "," + y + "," + z + "]";
          const std::string q = std::string("[") + x + "," + y + "," + (x[0] == '1' ? z + std::string(".4") : z) + "]";
          handles += (handles.empty() ? "" : ", ") + std::string("{\"p\": ") + p + ", \"q\": " + q + "}";
        }
    write("open.json", "{\"handles\": [" + handles + "]}");
  }
};

TEST_F(DeformCutTool, MeshesPartAndAreClosedAgain) {
  const auto json = json_of({"deform", "ball.ply", "--handles", "open.json", "--cut", kSlot, "-o", "cut.ply"});
  EXPECT_EQ(json["deformation"]["cuts"], 1);
  EXPECT_GT(json["output"]["cut"]["edges"], 10);
  EXPECT_GT(json["output"]["cut"]["faces"], 10);
  EXPECT_EQ(json["output"]["cut"]["unopened"], 0);
  EXPECT_TRUE(measure_topology(read_mesh(path("cut.ply"))).closed());

  const auto open = json_of({"deform", "ball.ply", "--handles", "open.json", "--cut", kSlot, "--cut-open",
                             "--cut-damping", "5", "-o", "o.ply"});
  EXPECT_EQ(open["output"]["cut"]["faces"], 0);
  EXPECT_EQ(open["deformation"]["damping"], 5);
  EXPECT_EQ(measure_topology(read_mesh(path("o.ply"))).boundary_loops, 1u);

  // Two cuts: a mesh, and one that does not intersect the input.
  TriangleMesh sheet;
  sheet.vertices = {{-0.1f, -2, 0.01f}, {2, -2, 0.01f}, {2, 2, 0.01f}, {-0.1f, 2, 0.01f}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  write_mesh(path("sheet.obj"), sheet);
  const Outcome two = run({"deform", "ball.ply", "--handles", "open.json", "--cut", "sheet.obj", "--cut",
                           "polygon(3,0,0; 4,0,0; 4,1,0 | 3.5,0.1,0; 3.6,0.1,0; 3.6,0.2,0)", "-o", "two.ply"});
  EXPECT_EQ(two.code, 0) << two.err;
  EXPECT_NE(two.out.find("2 cuts"), std::string::npos);
  EXPECT_NE(two.err.find("stays open"), std::string::npos);
  EXPECT_EQ(measure_topology(read_mesh(path("two.ply"))).boundary_loops, 1u);
}

TEST_F(DeformCutTool, SolidsCloudsAndVolumes) {
  const auto solid = json_of(
      {"deform", "sphere(0.9)", "--handles", "open.json", "--cut", kSlot, "-o", "solid.ply", "--resolution", "24"});
  EXPECT_TRUE(solid["output"]["closed"]);
  const auto whole =
      json_of({"deform", "sphere(0.9)", "--handles", "open.json", "-o", "whole.ply", "--resolution", "24"});
  EXPECT_GT(solid["output"]["area"], 1.1 * whole["output"]["area"].get<double>());  // two additional faces

  write("cloud.xyz", "0.8 0 0.05\n0.8 0 -0.05\n-0.8 0 0.05\n");
  ASSERT_EQ(run({"deform", "cloud.xyz", "--handles", "open.json", "--cut", kSlot, "-o", "moved.xyz"}).code, 0);
  const PointSet moved = read_points(path("moved.xyz"));
  EXPECT_GT(moved.origin.z + static_cast<double>(moved.positions[0].z), 0.12);
  EXPECT_LT(moved.origin.z + static_cast<double>(moved.positions[1].z), -0.12);

  write(kBallFile, ball_bytes());
  ASSERT_EQ(run({"deform", kBallFile, "--handles", "open.json", "--cut", kSlot, "-o", "ball.png", "--width", "40",
                 "--height", "40", "--map-nodes", "16"})
                .code,
            0);
  EXPECT_TRUE(std::filesystem::exists(path("ball.png")));
}

TEST_F(DeformCutTool, BadCutsAreNamed) {
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"half-plane(0,0,0; 0,0,1)", "a half-plane is a point of its edge"},
      {"half-plane(0,0,0; 0,0,1; 0,0,2)", "neither along the normal"},
      {"half-plane(0,0,0; 0,0,one; 1,0,2)", "'0,0,one' is not x,y,z"},
      {"polygon(0,0,0; 1,0,0)", "at least three are needed"},
      {"polygon(0,0; 1,0,0)", "is not x,y,z"},
      {"polygon(0,0,0; 1,0,0; 0,1,0", "')' is missing at its end"},
      {"plane(0,0,1)", "neither half-plane"},
      {"nothing.ply", "nothing.ply"},
  };
  for (const auto& [cut, cause] : bad) {
    const Outcome o = run({"deform", "ball.ply", "--handles", "open.json", "--cut", cut, "-o", "x.ply"});
    EXPECT_NE(o.code, 0) << cut;
    EXPECT_EQ(o.lines_of_error(), 1) << o.err;
    EXPECT_NE(o.err.find(cause), std::string::npos) << o.err;
  }
  EXPECT_NE(run({"deform", "ball.ply", "--handles", "open.json", "--cut-open", "-o", "x.ply"}).code, 0);
  EXPECT_NE(
      run({"deform", "ball.ply", "--handles", "open.json", "--cut", kSlot, "--cut-damping", "0.5", "-o", "x.ply"}).code,
      0);
}

}  // namespace
}  // namespace sansmesh::test
