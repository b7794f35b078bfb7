// Tests of commands on meshes: align, fill, simplify, smooth.
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/io/transform_file.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/mesh_measures.h"
#include "support/mesh_shapes.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

class RepairCommands : public ToolTest {};

TEST_F(RepairCommands, Fill) {
  TriangleMesh mesh = octasphere(4);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.vertices[t[0]].z > 0.98f; });
  write_mesh(path("open.ply"), mesh);
  const Json list = json_of({"fill", "open.ply", "--list"});
  ASSERT_EQ(list["holes"].size(), 1u);
  EXPECT_GT(list["holes"][0]["at"][2].get<double>(), 0.9);
  const Json filled = json_of({"fill", "open.ply", "-o", "closed.ply"});
  EXPECT_EQ(filled["filled"], 1);
  EXPECT_EQ(filled["output"]["closed"], true);
  EXPECT_TRUE(measure_topology(read_mesh(path("closed.ply"))).closed());
  EXPECT_EQ(json_of({"fill", "open.ply", "-o", "same.ply", "--largest", "0.01"})["left_open"], 1);
  // Both ends of a tube are left open, with the option that closes them.
  TriangleMesh tube;
  for (std::uint32_t v = 0; v < 16 * 41; ++v) {
    const double a = 2 * std::numbers::pi * (v % 16) / 16;
    const std::uint32_t ring = v / 16;
    tube.vertices.push_back(Vec3f(Vec3{std::cos(a), std::sin(a), 0.5 * ring}));
    const std::uint32_t next = v - v % 16 + (v + 1) % 16;
    if (v >= 16 * 40) continue;
    tube.triangles.push_back({v, next, next + 16});
    tube.triangles.push_back({v, next + 16, v + 16});
  }
  write_mesh(path("tube.ply"), tube);
  const Json ends = json_of({"fill", "tube.ply", "-o", "tube_too.ply"});
  EXPECT_EQ(ends["ends"], 2);
  ASSERT_EQ(ends["warnings"].size(), 1u);
  EXPECT_NE(ends["warnings"][0].get<std::string>().find("--largest 2.8"), std::string::npos) << ends["warnings"];
  expect_failure({"fill", "open.ply"}, 2, "--output");
  expect_failure({"fill", "open.ply", "-o", "x.ply", "--largest", "-1"}, 2, "--largest");
  expect_failure({"fill", "open.ply", "-o", "x.ply", "--all", "--largest", "1"}, 2, "--all");
  expect_failure({"fill", "open.ply", "-o", "x.ply", "--list"}, 2, "--list");
}

TEST_F(RepairCommands, Simplify) {
  TriangleMesh mesh = octasphere(5);
  mesh.colors.assign(mesh.vertices.size(), {10, 200, 30});
  write_mesh(path("fine.ply"), mesh);
  const Json coarse = json_of({"simplify", "fine.ply", "-o", "coarse.ply", "--triangles", "500"});
  EXPECT_LE(coarse["output"]["triangles"], 500);
  EXPECT_GT(coarse["output"]["triangles"], 450);
  EXPECT_EQ(coarse["output"]["closed"], true);
  EXPECT_GT(coarse["to_original"]["rms"], 0.0005);
  EXPECT_LT(coarse["to_original"]["max"], 0.03);
  EXPECT_LT(coarse["from_original"]["max"], 0.03);
  const TriangleMesh read = read_mesh(path("coarse.ply"));
  EXPECT_EQ(read.colors.at(7), (std::array<std::uint8_t, 3>{10, 200, 30}));
  EXPECT_EQ(json_of({"simplify", "fine.ply", "-o", "half.ply"})["output"]["triangles"], 4096);
  EXPECT_TRUE(coarse["warnings"].empty());
  const Json coarsest = json_of({"simplify", "fine.ply", "-o", "coarsest.ply", "--triangles", "20"});
  ASSERT_EQ(coarsest["warnings"].size(), 1u);
  EXPECT_NE(coarsest["warnings"][0].get<std::string>().find("% of the diagonal"), std::string::npos);
  // Three sheets at an edge: no border, closed, but not manifold.
  TriangleMesh walls = octasphere(3);
  const auto half = static_cast<std::uint32_t>(walls.vertices.size());
  walls.vertices.push_back({0, 0, 0});
  const Triangle first = walls.triangles[0];
  for (std::size_t k = 0; k < 3; ++k) {
    walls.triangles.push_back({first[k], first[(k + 1) % 3], half});
    walls.triangles.push_back({first[(k + 1) % 3], first[k], half});
  }
  write_mesh(path("walls.ply"), walls);
  const Outcome said = run({"simplify", "walls.ply", "-o", "w.ply", "--ratio", "0.5"});
  EXPECT_NE(said.out.find("closed, but 6 edges of three triangles or more"), std::string::npos) << said.out;
  const Json close = json_of({"simplify", "fine.ply", "-o", "close.ply", "--error", "0.002"});
  EXPECT_LT(close["to_original"]["rms"], 0.002);
  EXPECT_LT(close["output"]["triangles"], 4000);
  expect_failure({"simplify", "fine.ply", "-o", "x.ply", "--ratio", "2"}, 2, "--ratio");
  expect_failure({"simplify", "fine.ply", "-o", "x.ply", "--ratio", "0.2", "--error", "1"}, 2, "--error");
}

TEST_F(RepairCommands, SimplifyChoosesWhatIsNearer) {
  // A long thin wedge: triangles with good angles would be far too many.
  TriangleMesh wedge;
  constexpr std::uint32_t kRow = 3, kRows = 400;
  for (std::uint32_t k = 0; k < kRows; ++k) {
    const float x = 0.05f * float(k), lift = 0.4f * std::sin(0.35f * x);
    wedge.vertices.insert(wedge.vertices.end(), {{x, 0, lift}, {x, 0.01f, lift + 0.3f}, {x, -0.01f, lift + 0.3f}});
    if (k == 0) continue;
    for (std::uint32_t j = 0; j < kRow; ++j) {
      const std::uint32_t a = (k - 1) * kRow + j, b = (k - 1) * kRow + (j + 1) % kRow;
      wedge.triangles.push_back({a, a + kRow, b + kRow});
      wedge.triangles.push_back({a, b + kRow, b});
    }
  }
  write_mesh(path("wedge.ply"), wedge);
  const auto farthest = [](const Json& json) {
    return std::max(json["to_original"]["max"].get<double>(), json["from_original"]["max"].get<double>());
  };
  const Json chosen = json_of({"simplify", "wedge.ply", "-o", "chosen.ply", "--triangles", "300"});
  const Json any = json_of({"simplify", "wedge.ply", "-o", "any.ply", "--triangles", "300", "--triangle-shape", "0"});
  EXPECT_LE(farthest(chosen), 1.5 * farthest(any));
  const Json good =
      json_of({"simplify", "wedge.ply", "-o", "good.ply", "--triangles", "300", "--triangle-shape", "0.3"});
  for (const Json& warning : good["warnings"]) {
    const auto words = warning.get<std::string>();
    EXPECT_TRUE(words.find("too few") == std::string::npos || words.find("--triangle-shape 0") != std::string::npos)
        << words;
  }
}

TEST_F(RepairCommands, Smooth) {
  TriangleMesh mesh = octasphere(4);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) mesh.vertices[v] *= v % 2 ? 1.01f : 0.99f;
  write_mesh(path("rough.ply"), mesh);
  const Json smooth = json_of({"smooth", "rough.ply", "-o", "smooth.ply"});
  EXPECT_GT(smooth["moved"]["rms"], 0.003);
  EXPECT_NEAR(smooth["volume"]["after"].get<double>() / smooth["volume"]["before"].get<double>(), 1, 0.01);
  EXPECT_EQ(read_mesh(path("smooth.ply")).triangles.size(), mesh.triangles.size());
  TriangleMesh spiky = octasphere(1);
  for (std::size_t v = 0; v < 6; ++v) spiky.vertices[v] *= 2;
  write_mesh(path("spiky.ply"), spiky);
  const Json flattened = json_of({"smooth", "spiky.ply", "-o", "flattened.ply"});
  ASSERT_EQ(flattened["warnings"].size(), 1u);
  EXPECT_NE(flattened["warnings"][0].get<std::string>().find("% of the diagonal"), std::string::npos);
  EXPECT_GT(json_of({"smooth", "rough.ply", "-o", "sharp.ply", "--creases"})["crease_angle_deg"], 1);
  expect_failure({"smooth", "rough.ply", "-o", "x.ply", "--strength", "3"}, 2, "--strength");
  expect_failure({"smooth", "rough.ply", "-o", "x.ply", "--shorter-than", "1", "--iterations", "3"}, 2, "--iterations");
}

TEST_F(RepairCommands, WhatIsSaidOfTheOutputIsTheSame) {
  TriangleMesh mesh = octasphere(4);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.vertices[t[0]].z > 0.5f; });
  write_mesh(path("cup.ply"), mesh);
  for (const char* command : {"fill", "simplify", "smooth"}) {
    const Json output = json_of({command, "cup.ply", "-o", "out.ply"})["output"];
    const TriangleMesh written = read_mesh(path("out.ply"));
    const MeshTopology t = measure_topology(written);
    EXPECT_EQ(output, (Json{{"file", "out.ply"},
                            {"vertices", written.vertices.size()},
                            {"triangles", written.triangles.size()},
                            {"closed", t.closed()},
                            {"components", t.components},
                            {"boundary_edges", t.boundary_edges}}))
        << command;
  }
}

TEST_F(RepairCommands, Align) {
  SANSMESH_NOT_SANITIZED("tests/mesh aligns, too");
  TriangleMesh mesh = octasphere(4);
  for (Vec3f& v : mesh.vertices) {
    v *= 1 + 0.2f * std::sin(3 * v.x + 1) + 0.15f * std::sin(4 * v.y + 2 * v.z);
    mesh.colors.push_back({1, 2, 3});
  }
  write_mesh(path("there.ply"), mesh);
  TriangleMesh moved = mesh;
  transform(moved, AffineMap::translation({0.1, 0, -0.05}).after(AffineMap::rotation({1, 1, 0}, 10)));
  write_mesh(path("here.ply"), moved);
  const Json json =
      json_of({"align", "here.ply", "there.ply", "-o", "aligned.ply", "--transform-output", "motion.txt"});
  EXPECT_NEAR(json["alignment"]["angle_deg"].get<double>(), 10, 0.01);
  EXPECT_GT(json["alignment"]["overlap"], 0.99);
  EXPECT_LT(json["alignment"]["rms"], 1e-4);
  const TriangleMesh aligned = read_mesh(path("aligned.ply"));
  const AffineMap motion = read_transform(path("motion.txt"));
  ASSERT_EQ(aligned.colors.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); v += 50) {
    EXPECT_LT(norm(aligned.origin + Vec3(aligned.vertices[v]) - Vec3(mesh.vertices[v])), 1e-3);
    EXPECT_LT(norm(motion(moved.origin + Vec3(moved.vertices[v])) - Vec3(mesh.vertices[v])), 1e-3);
  }
  // A second run from the result has nothing left to do.
  const Json again = json_of({"align", "here.ply", "there.ply", "--start-transform", "motion.txt", "--from", "here"});
  EXPECT_LT(again["alignment"]["moved_rms"], 1e-3);
  EXPECT_NEAR(again["matrix"][0][3].get<double>(), json["matrix"][0][3].get<double>(), 1e-3);

  const Json before = json_of({"compare", "here.ply", "there.ply"});
  const Json after = json_of({"compare", "here.ply", "there.ply", "--align"});
  EXPECT_GT(before["distance"]["rms"], 0.02);
  EXPECT_LT(after["distance"]["rms"], 1e-3);
  EXPECT_NEAR(after["alignment"]["angle_deg"].get<double>(), 10, 0.01);
  expect_failure({"compare", "here.ply", "there.ply", "--from", "here"}, 2, "--align");

  // A picture of both surfaces, and a warning of parts that the format cannot hold.
  EXPECT_TRUE(json["warnings"].empty());
  EXPECT_EQ(json["output"]["vertices"], mesh.vertices.size());
  EXPECT_EQ(json["output"]["triangles"], mesh.triangles.size());
  const Json bare = json_of({"align", "here.ply", "there.ply", "-o", "aligned.stl", "--preview", "both.png", "--width",
                             "64", "--height", "48"});
  ASSERT_EQ(bare["warnings"].size(), 1u);
  EXPECT_NE(bare["warnings"][0].get<std::string>().find("aligned.stl cannot hold colours"), std::string::npos)
      << bare["warnings"];
  EXPECT_EQ(bare["preview"]["file"], "both.png");
  EXPECT_EQ(slurp(path("both.png")).substr(1, 3), "PNG");
  expect_failure({"align", "here.ply", "there.ply", "--z-up"}, 2, "--preview");

  TriangleMesh far = mesh;
  transform(far, AffineMap::scaling({5, 5, 5}));
  write_mesh(path("far.ply"), far);
  expect_failure({"align", "far.ply", "there.ply", "-o", "x.ply", "--from", "here"}, 1, "there.ply");
  expect_failure({"align", "far.ply", "there.ply", "-o", "x.ply", "--from", "here"}, 1, "--find-scale");
  EXPECT_FALSE(std::filesystem::exists(path("x.ply")));
  expect_failure({"align", "here.ply", "there.ply", "--from", "nowhere"}, 2, "--from");
  expect_failure({"align", "here.ply", "there.ply", "--start-transform", "there.ply"}, 1, "there.ply");
}

}  // namespace
}  // namespace sansmesh::test
