// Tests of `edit`, and of `mesh` in a box or with a coarser depth.
#include <cmath>
#include <nlohmann/json.hpp>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "support/clouds.h"
#include "support/mesh_shapes.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

class EditCommands : public ToolTest {
 protected:
  void fit(const std::string& input, const std::string& name) const {
    const Outcome outcome = run({"fit", input, "-o", name, "--quiet"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  void fit_sphere(const std::string& name = "ball.smf") const {
    write_points(path("ball.ply"), sphere(2000));
    fit("ball.ply", name);
    std::filesystem::remove(path("ball.ply"));
  }
  void script(const std::string& steps, const std::string& name = "edits.json") const {
    write(name, R"({"version": 1, "steps": [)" + steps + "]}");
  }
};

TEST_F(EditCommands, TheBundledScanAndItsMesh) {
  fit(kOwl, "owl.smf");
  ASSERT_EQ(run({"mesh", "owl.smf", "-o", "owl.ply"}).code, 0);
  const TriangleMesh before = read_mesh(path("owl.ply"));
  Vec3 top = before.origin + Vec3(before.vertices[0]);
  for (const Vec3f& v : before.vertices)
    if (before.origin.y + static_cast<double>(v.y) > top.y) top = before.origin + Vec3(v);
  const std::string center =
      "[" + std::to_string(top.x) + "," + std::to_string(top.y) + "," + std::to_string(top.z) + "]";
  const std::string ball = R"({"ball": {"center": )" + center + R"(, "radius": 4}})";
  script(R"({"select": )" + ball + R"(, "degree": 1, "note": "flat"},
            {"select": )" +
         ball + R"(, "constant": "outside"},
            {"undo": 1},
            {"select": {"ball": {"center": [1e6, 0, 0], "radius": 1}}, "remove": true},
            {"select": )" +
         ball + R"(, "refit": {"support": 2, "sharp": false}})");
  const Json json = json_of(
      {"edit", "owl.smf", "--script", "edits.json", "-o", "new.smf", "--mesh", "owl.ply", "--mesh-output", "new.ply"});
  EXPECT_EQ(listing(), (std::vector<std::string>{"edits.json", "new.ply", "new.smf", "owl.ply", "owl.smf"}));
  EXPECT_EQ(json["input"]["file"], "owl.smf");
  ASSERT_EQ(json["steps"].size(), 5u);
  EXPECT_GT(json["steps"][0]["selected"].get<int>(), 2);
  EXPECT_EQ(json["steps"][0]["selected"], json["steps"][0]["supports"]);
  EXPECT_EQ(json["steps"][1]["selected"], json["steps"][0]["selected"]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Json& changed = json["steps"][0]["changed"];
    EXPECT_LT(changed[0][k].get<double>(), top[k]);
    EXPECT_GT(changed[1][k].get<double>(), top[k]);
  }
  EXPECT_NE(json["steps"][2]["what"].get<std::string>().find("took back 1 edit"), std::string::npos);
  EXPECT_EQ(json["steps"][3]["selected"], 0);
  EXPECT_TRUE(json["steps"][3]["changed"].is_null());
  EXPECT_EQ(json["output"]["file"], "new.smf");
  EXPECT_TRUE(json["update"]["local"]);
  EXPECT_TRUE(json["update"]["why"].is_null());
  EXPECT_GT(json["update"]["regions"].get<int>(), 0);
  const TriangleMesh after = read_mesh(path("new.ply"));
  EXPECT_TRUE(measure_topology(after).closed());
  EXPECT_EQ(after.triangles.size(), json["mesh"]["triangles"].get<std::size_t>());

  // The written file is the edited function: meshing it from scratch gives the same extent, and it keeps its history.
  const Outcome words = run({"edit", "new.smf", "--script", "edits.json", "--mesh-output", "again.ply"});
  ASSERT_EQ(words.code, 0) << words.err;
  EXPECT_NE(words.out.find("step 1: degree 1 in"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("step 4: nothing is selected"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("again.ply: "), std::string::npos) << words.out;
  EXPECT_TRUE(measure_topology(read_mesh(path("again.ply"))).closed());

  // A mesh of another function is rejected.
  write_mesh(path("other.ply"), read_mesh(path("new.ply")));
  ASSERT_EQ(run({"mesh", "owl.smf", "-o", "other.ply", "--block-depth", "4"}).code, 0);
  const Json anew =
      json_of({"edit", "owl.smf", "--script", "edits.json", "--mesh", "other.ply", "--mesh-output", "x.ply"});
  EXPECT_FALSE(anew["update"]["local"]);
  EXPECT_NE(anew["update"]["why"].get<std::string>().find("without options"), std::string::npos)
      << anew["update"]["why"];
  const Outcome said =
      run({"edit", "owl.smf", "--script", "edits.json", "--mesh", "other.ply", "--mesh-output", "x.ply"});
  EXPECT_NE(said.out.find("all new: of the triangles"), std::string::npos) << said.out;
  EXPECT_TRUE(measure_topology(read_mesh(path("x.ply"))).closed());
}

TEST_F(EditCommands, AnEmptyScriptCopies) {
  fit_sphere();
  script("");
  const Json json = json_of({"edit", "ball.smf", "--script", "edits.json", "-o", "copy.smf"});
  EXPECT_TRUE(json["steps"].empty());
  EXPECT_EQ(slurp(path("copy.smf")), slurp(path("ball.smf")));
}

TEST_F(EditCommands, EditsInPlace) {
  fit_sphere();
  script(R"({"select": {}, "degree": 1})");
  const std::string before = slurp(path("ball.smf"));
  ASSERT_EQ(run({"edit", "ball.smf", "--script", "edits.json", "-o", "ball.smf"}).code, 0);
  EXPECT_NE(slurp(path("ball.smf")), before);
  ASSERT_EQ(run({"mesh", "ball.smf", "-o", "ball.ply"}).code, 0);
  EXPECT_EQ(listing(), (std::vector<std::string>{"ball.ply", "ball.smf", "edits.json"}));
}

TEST_F(EditCommands, ErrorsAreOneLineAndWriteNothing) {
  fit_sphere();
  write_points(path("cloud.ply"), sphere(2000));
  ASSERT_EQ(run({"fit", "cloud.ply", "-o", "lean.smf", "--without-samples"}).code, 0);
  script(R"({"select": {}, "degree": 1})", "good.json");
  TriangleMesh other = octasphere(3);
  for (Vec3f& v : other.vertices) v *= 1.5f;
  write_mesh(path("other.ply"), other);
  write("text.json", "degree = 1");
  write("empty.json", "");
  script(R"({"select": {}, "degree": 1}, {"select": {"ball": {"center": [0,0,0], "radius": -1}}, "degree": 1})",
         "ball.json");
  script(R"({"select": {}, "degre": 1})", "field.json");
  script(R"({"undo": 1})", "undo.json");
  script(R"({"select": {}, "remove": true})", "all.json");
  script(R"({"select": {}, "constant": "outside"})", "outside.json");
  expect_failures({
      {{"edit", "ball.smf", "--script", "missing.json", "-o", "new.smf"}, 1, {"missing.json", "no such file"}},
      {{"edit", "ball.smf", "--script", "text.json", "-o", "new.smf"}, 1, {"text.json: is not JSON"}},
      {{"edit", "ball.smf", "--script", "empty.json", "-o", "new.smf"}, 1, {"empty.json: is not JSON"}},
      {{"edit", "ball.smf", "--script", "ball.json", "-o", "new.smf"}, 1, {"ball.json: step 2.select", "radius"}},
      {{"edit", "ball.smf", "--script", "field.json", "-o", "new.smf"}, 1, {"field.json: step 1", "'degre'"}},
      {{"edit", "ball.smf", "--script", "undo.json", "-o", "new.smf"}, 1, {"undo.json: step 1", "undo"}},
      {{"edit", "ball.smf", "--script", "all.json", "-o", "new.smf"}, 1, {"ball.smf: step 1", "no supports"}},
      {{"edit", "lean.smf", "--script", "good.json", "-o", "new.smf"},
       1,
       {"lean.smf: step 1", "samples were not kept"}},
      {{"edit", "ball.smf", "--script", "outside.json", "-o", "new.smf", "--mesh-output", "new.ply"},
       1,
       {"no surface"}},
      {{"edit", "missing.smf", "--script", "good.json", "-o", "new.smf"}, 1, {"missing.smf"}},
      {{"edit", "cloud.ply", "--script", "good.json", "-o", "new.smf"}, 1, {"cloud.ply"}},
      {{"edit", "ball.smf", "--script", "good.json", "-o", "new.ply"}, 1, {"new.ply"}},
      {{"edit", "ball.smf", "--script", "good.json", "-o", "no/folder/new.smf"}, 1, {"no/folder/new.smf"}},
      {{"edit", "ball.smf", "--script", "good.json", "--mesh-output", "new.smf"}, 1, {"new.smf"}},
      {{"edit", "ball.smf", "--script", "good.json", "--mesh-output", "x.ply", "--mesh", "missing.ply"},
       1,
       {"missing.ply"}},
      {{"edit", "ball.smf", "--script", "good.json", "--mesh-output", "x.ply", "--mesh", "cloud.ply"},
       1,
       {"cloud.ply", "no triangles"}},
      {{"edit", "ball.smf", "--script", "good.json", "--mesh-output", "x.ply", "--mesh", "other.ply"},
       1,
       {"other.ply: is not a mesh of ball.smf", ": 0 of "}},
      {{"edit", "ball.smf", "--script", "good.json"}, 2, {"nothing to write"}},
      {{"edit", "ball.smf", "--script", "good.json", "-o", "x.smf", "--mesh", "cloud.ply"}, 2, {"--mesh-output"}},
      {{"edit", "ball.smf", "-o", "x.smf"}, 2, {"--script"}},
      {{"edit", "--quiet"}, 2, {"edit needs input FILE and --script FILE"}},
      {{"mesh", "ball.smf", "-o", "x.ply", "--box", "0,0,0,1"}, 2, {"--box"}},
      {{"mesh", "ball.smf", "-o", "x.ply", "--box", "0,0,0,1,1,-1"}, 2, {"box"}},
      {{"mesh", "ball.smf", "-o", "x.ply", "--box", "0,0,0,1,1,nan"}, 2, {"box"}},
      {{"mesh", "ball.smf", "-o", "x.ply", "--box", "7,7,7,8,8,8"}, 1, {"ball.smf", "no surface in the box"}},
      {{"mesh", "ball.smf", "-o", "x.ply", "--block-depth", "1"}, 2, {"depth"}},
      {{"mesh", "ball.smf", "-o", "x.ply", "--block-depth", "15"}, 2, {"depth", "2..14"}},
      {{"mesh", "ball.smf", "-o", "x.ply", "--block-depth", "deep"}, 2, {"--block-depth"}},
  });
}

TEST_F(EditCommands, MeshInABox) {
  fit_sphere();
  const Json json = json_of({"mesh", "ball.smf", "-o", "part.ply", "--box", "0,-0.5,-2,2,0.5,2"});
  EXPECT_FALSE(json["output"]["closed"]);
  EXPECT_EQ(json["output"]["components"], 1);
  const TriangleMesh mesh = read_mesh(path("part.ply"));
  bool on_face = false;
  for (const Vec3f& v : mesh.vertices) {
    const Vec3 p = mesh.origin + Vec3(v);
    EXPECT_GE(p.x, -1e-6);
    EXPECT_LE(std::abs(p.y), 0.5 + 1e-6);
    EXPECT_NEAR(norm(p), 1, 0.01);
    on_face |= std::abs(p.x) < 1e-6;
  }
  EXPECT_TRUE(on_face);
  const Outcome words = run({"mesh", "ball.smf", "-o", "part.ply", "--box", "0,-0.5,-2,2,0.5,2"});
  EXPECT_NE(words.out.find("with borders"), std::string::npos) << words.out;
}

TEST_F(EditCommands, MeshAtADepth) {
  fit(kOwl, "owl.smf");
  const int full = json_of({"mesh", "owl.smf", "-o", "a.ply"})["output"]["triangles"];
  const Json coarse = json_of({"mesh", "owl.smf", "-o", "b.ply", "--block-depth", "4"});
  EXPECT_LT(coarse["output"]["triangles"].get<int>(), full / 2);
  EXPECT_TRUE(coarse["output"]["closed"]);
  EXPECT_LE(coarse["block_depth"].get<int>(), 4);
}

}  // namespace
}  // namespace sansmesh::test
