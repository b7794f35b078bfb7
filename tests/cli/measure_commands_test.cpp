// Tests of commands that measure: section, compare, measure.
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "support/clouds.h"
#include "support/mesh_shapes.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;
using std::numbers::pi;

class MeasureCommands : public ToolTest {
 protected:
  void write_sphere(const std::string& name, float radius, int levels = 4) const {
    TriangleMesh mesh = octasphere(levels);
    for (Vec3f& v : mesh.vertices) v *= radius;
    write_mesh(path(name), mesh);
  }
};

TEST_F(MeasureCommands, SectionOfAMesh) {
  write_sphere("ball.ply", 2);
  const Json middle = json_of({"section", "ball.ply"});
  ASSERT_EQ(middle["planes"].size(), 3u);
  for (const Json& plane : middle["planes"]) {
    EXPECT_NEAR(plane["area"].get<double>(), 4 * pi, 0.1);
    EXPECT_NEAR(plane["length"].get<double>(), 4 * pi, 0.1);
    EXPECT_EQ(plane["curves"], 1);
    EXPECT_EQ(plane["open_curves"], 0);
  }
  const Json slices = json_of({"section", "ball.ply", "--axis", "z", "--count", "10", "-o", "slices.svg"});
  EXPECT_EQ(slices["planes"].size(), 10u);
  EXPECT_NE(slurp(path("slices.svg")).find("<g id=\"plane9\""), std::string::npos);
  const Json steps = json_of({"section", "ball.ply", "--axis", "y", "--interval", "0.5"});
  EXPECT_EQ(steps["planes"].size(), 8u);
  const Json cuts = json_of({"section", "ball.ply", "--plane", "z=0.5", "--plane", "3,0,4,5", "-o", "cuts.csv"});
  ASSERT_EQ(cuts["planes"].size(), 2u);
  EXPECT_NEAR(cuts["planes"][1]["area"].get<double>(), 3 * pi, 0.1);
  EXPECT_EQ(cuts["planes"][1]["equation"], "0.6 x + 0.8 z = 1");
  EXPECT_EQ(slurp(path("cuts.csv")).substr(0, 36), "plane,curve,closed,vertex,x,y,z,u,v\n");
  const Outcome words = run({"section", "ball.ply", "--plane", "z=9"});
  EXPECT_NE(words.out.find("nothing there"), std::string::npos);
}

TEST_F(MeasureCommands, SectionComplaints) {
  write_sphere("ball.ply", 1);
  PointSet cloud = sphere(200);
  write_points(path("cloud.ply"), cloud);
  expect_failure({"section", "ball.ply", "--plane", "w=1"}, 2, "w=1");
  expect_failure({"section", "ball.ply", "--count", "3"}, 2, "--axis");
  expect_failure({"section", "ball.ply", "--axis", "z", "--interval", "0"}, 2, "--interval");
  for (const char* bad : {"nan", "inf", "-inf"}) {
    expect_failure({"section", "ball.ply", "--axis", "z", "--interval", bad}, 2, "--interval must be finite");
    expect_failure({"section", "ball.ply", "--axis", "z", "--interval", "0.1", "--first", bad}, 2,
                   "--first must be finite");
    expect_failure({"section", "ball.ply", "--axis", "z", "--first", bad}, 2, "--first must be finite");
  }
  expect_failure({"section", "ball.ply", "--axis", "z", "--first", "9", "--count", "3"}, 2, "--interval");
  expect_failure({"section", "ball.ply", "--axis", "z", "--interval", "1e-320"}, 2, "planes");
  expect_failure({"section", "ball.ply", "--axis", "z", "--interval", "1e-6"}, 2, "--interval 1e-06 makes more than");
  EXPECT_EQ(json_of({"section", "ball.ply", "--axis", "z", "--interval", "1e308"})["planes"].size(), 1u);
  expect_failure({"section", "ball.ply", "--axis", "q"}, 2, "--axis");
  expect_failure({"section", "ball.ply", "-o", "x.png"}, 1, "x.png");
  expect_failure({"section", "ball.ply", "-o", "none/x.svg"}, 1, "none/x.svg");
  expect_failure({"section", "ball.ply", "-o", "x.csv", "--unit", "mm"}, 2, "--unit");
  expect_failure({"section", "ball.ply", "--resolution", "100"}, 2, "--resolution");
  const Outcome coarse = run({"section", "ball.ply", "--resolution", "1"});
  EXPECT_EQ(coarse.code, 2);
  EXPECT_NE(coarse.err.find("--resolution must lie in 2..4096, not 1"), std::string::npos) << coarse.err;
  EXPECT_EQ(coarse.err.find("::"), std::string::npos) << coarse.err;
  expect_failure({"section", "cloud.ply"}, 1, "no faces");
  expect_failure({"section", "none.ply"}, 1, "none.ply");
  EXPECT_EQ(listing(), (std::vector<std::string>{"ball.ply", "cloud.ply"}));
}

TEST_F(MeasureCommands, Measure) {
  write_sphere("ball.ply", 2, 5);
  const Json ball = json_of({"measure", "ball.ply"});
  EXPECT_NEAR(ball["whole"]["volume"].get<double>(), 32 * pi / 3, 0.1);
  EXPECT_NEAR(ball["whole"]["area"].get<double>(), 16 * pi, 0.1);
  EXPECT_TRUE(ball["whole"]["closed"].get<bool>());
  EXPECT_EQ(ball["component_count"], 1);
  EXPECT_NEAR(ball["smallest_box"]["sizes"][0].get<double>(), 4, 0.01);
  TriangleMesh two = joined(octasphere(2), octasphere(3), {5, 0, 0});
  two.triangles.pop_back();
  write_mesh(path("two.off"), two);
  const Json open = json_of({"measure", "two.off"});
  EXPECT_TRUE(open["whole"]["volume"].is_null());
  EXPECT_EQ(open["components"].size(), 2u);
  EXPECT_FALSE(open["components"][0]["closed"].get<bool>());
  EXPECT_GT(open["components"][1]["volume"].get<double>(), 3);
  const Outcome words = run({"measure", "two.off"});
  EXPECT_EQ(words.code, 0);
  EXPECT_NE(words.err.find("not closed"), std::string::npos);
  EXPECT_NE(words.out.find("component"), std::string::npos);
  TriangleMesh sheet = octasphere(2);
  const std::vector<Triangle> front = sheet.triangles;
  for (const Triangle& t : front) sheet.triangles.push_back({t[0], t[2], t[1]});
  write_mesh(path("sheet.ply"), sheet);
  EXPECT_NE(run({"measure", "sheet.ply"}).err.find("cancel out"), std::string::npos);
  write_points(path("cloud.ply"), sphere(200));
  expect_failure({"measure", "cloud.ply"}, 1, "no faces");
}

TEST_F(MeasureCommands, CommandsAgreeOnWhatTheyCount) {
  SANSMESH_NOT_SANITIZED("compares results; others run these commands");
  // Separate vertices for each triangle; edges with four and three triangles; holes; reversed faces.
  TriangleMesh soup;
  for (const Triangle& t : octasphere(2).triangles) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(octasphere(2).vertices[v]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  TriangleMesh four = joined(octasphere(1), octasphere(1), {3, 0, 0});
  const Triangle one = four.triangles[0], other = four.triangles[four.triangles.size() / 2];
  for (Triangle& t : four.triangles)
    for (std::uint32_t& v : t) v = v == other[0] ? one[1] : v == other[1] ? one[0] : v;
  TriangleMesh three = octasphere(2);
  three.vertices.push_back({3, 3, 3});
  three.triangles.push_back({three.triangles[0][0], three.triangles[0][1], 66});
  TriangleMesh holes = octasphere(3);
  holes.triangles.resize(holes.triangles.size() - 10);
  TriangleMesh turned = octasphere(2);
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  // As text, so that writing joins no vertices.
  const std::pair<const char*, TriangleMesh> meshes[] = {
      {"soup.off", soup}, {"four.off", four}, {"three.off", three}, {"holes.off", holes}, {"turned.off", turned}};
  for (const auto& [name, mesh] : meshes) {
    SCOPED_TRACE(name);
    write_mesh(path(name), mesh);
    const Json measured = json_of({"measure", name}), evaluated = json_of({"assess", name}),
               known = json_of({"info", name});
    EXPECT_EQ(measured["topology"], evaluated["topology"]);
    EXPECT_EQ(measured["topology"], known["mesh"]);
    EXPECT_EQ(measured["whole"]["closed"], evaluated["topology"]["closed"]);
    EXPECT_EQ(measured["whole"]["open_edges"], evaluated["topology"]["open_edges"]);
    EXPECT_EQ(measured["whole"]["boundary_edges"], evaluated["topology"]["boundary_edges"]);
    EXPECT_EQ(measured["whole"]["triangles"], evaluated["topology"]["triangles"]);
    EXPECT_EQ(measured["component_count"], evaluated["topology"]["components"]);
    EXPECT_EQ(measured["whole"]["area"], evaluated["quality"]["area"]);
    if (measured["whole"]["closed"]) {
      EXPECT_EQ(measured["whole"]["volume"], evaluated["quality"]["volume"]);
    }
    std::size_t open = 0;
    for (const Json& part : measured["components"]) open += part["open_edges"].get<std::size_t>();
    EXPECT_EQ(open, measured["whole"]["open_edges"]);
    // The text output is the same, too.
    const std::string words = run({"measure", name}).out, said = run({"assess", name}).out;
    const auto topology_of = [](const std::string& text) {
      const std::size_t at = text.find("closed", text.find("topology"));
      return text.substr(at, text.find('\n', at) - at);
    };
    EXPECT_EQ(topology_of(words), topology_of(said));
  }
  EXPECT_TRUE(json_of({"info", "soup.off"})["mesh"]["closed"]);
  EXPECT_EQ(json_of({"assess", "three.off"})["topology"]["open_edges"], 3);
  // The report of a command on the mesh that it wrote.
  const Json made = json_of({"csg", "box(2) - sphere(1.2)", "-o", "made.ply", "--resolution", "40"});
  const Json measured = json_of({"measure", "made.ply"});
  EXPECT_EQ(made["output"]["components"], measured["component_count"]);
  EXPECT_EQ(made["output"]["closed"], measured["whole"]["closed"]);
  EXPECT_NEAR(made["volume"].get<double>(), measured["whole"]["volume"].get<double>(), 1e-5);
  EXPECT_NEAR(made["area"].get<double>(), measured["whole"]["area"].get<double>(), 1e-4);
}

TEST_F(MeasureCommands, Compare) {
  write_sphere("small.ply", 1);
  write_sphere("large.ply", 1.01f, 6);
  const Json json = json_of({"compare", "small.ply", "large.ply", "-o", "map.ply", "--preview", "map.png", "--within",
                             "0.02", "--view", "front"});
  EXPECT_NEAR(json["distance"]["mean"].get<double>(), -0.01, 2e-4);
  EXPECT_EQ(json["distance"]["within_tolerance"], 1.0);
  EXPECT_EQ(json["measured"], json["vertices"]);
  EXPECT_EQ(json["histogram"]["shares"].size(), 41u);
  EXPECT_EQ(slurp(path("map.png")).substr(1, 3), "PNG");
  const PointSet map = read_points(path("map.ply"));
  ASSERT_EQ(map.colors.size(), map.size());
  EXPECT_GT(map.colors[0][2], map.colors[0][0] + 60);
  EXPECT_NE(slurp(path("map.ply")).find("property float quality"), std::string::npos);

  // The map on the reference; the sign stays that of the part.
  const Json reversed = json_of({"compare", "small.ply", "large.ply", "--on", "reference"});
  EXPECT_NEAR(reversed["distance"]["mean"].get<double>(), -0.012, 2e-3);
  const Outcome words = run({"compare", "large.ply", "small.ply", "--histogram", "--within", "0.001"});
  EXPECT_EQ(words.code, 0) << words.err;
  EXPECT_NE(words.out.find("within ±0.001"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("####"), std::string::npos);

  // Points with and without normals.
  PointSet cloud = sphere(3000);
  write_points(path("cloud.ply"), cloud);
  const Json points = json_of({"compare", "cloud.ply", "large.ply", "-o", "points.csv"});
  EXPECT_NEAR(points["distance"]["mean"].get<double>(), -0.01, 5e-4);
  EXPECT_NE(slurp(path("points.csv")).find("distance"), std::string::npos);
  const Json onto = json_of({"compare", "large.ply", "cloud.ply"});
  EXPECT_NEAR(onto["distance"]["mean"].get<double>(), 0.01, 2e-3);
  EXPECT_GT(onto["reference"]["sampling"]["spacing"].get<double>(), 0.01);
  EXPECT_LT(onto["reference"]["sampling"]["own_rms"].get<double>(), 0.01);
  EXPECT_TRUE(points["part"]["sampling"]["noise_known"].get<bool>());
  EXPECT_TRUE(reversed["part"]["sampling"].is_null());
}

TEST_F(MeasureCommands, CompareComplaints) {
  write_sphere("ball.ply", 1);
  write("empty.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n");
  expect_failure({"compare", "ball.ply"}, 2, "reference");
  expect_failure({"compare", "ball.ply", "empty.ply"}, 1, "empty.ply");
  expect_failure({"compare", "ball.ply", "ball.ply", "--color-range", "-1"}, 2, "range");
  expect_failure({"compare", "ball.ply", "ball.ply", "--within", "-1"}, 2, "within");
  expect_failure({"compare", "ball.ply", "ball.ply", "--refine", "0"}, 2, "--refine");
  expect_failure({"compare", "ball.ply", "ball.ply", "-o", "map.txt"}, 1, "map.txt");
  expect_failure({"compare", "ball.ply", "ball.ply", "--preview", "map.jpg"}, 1, "map.jpg");
  expect_failure({"compare", "ball.ply", "ball.ply", "--view", "within"}, 2, "within");
  expect_failure({"compare", "ball.ply", "ball.ply", "--preview", "map.png", "--width", "10"}, 2, "--width 10");
  for (const char* option : {"--max-distance", "--color-range", "--within", "--refine"}) {
    const Outcome bad = run({"compare", "ball.ply", "ball.ply", option, "nan"});
    EXPECT_EQ(bad.code, 2);
    EXPECT_EQ(bad.err.find("::"), std::string::npos) << bad.err;
  }
  EXPECT_EQ(listing(), (std::vector<std::string>{"ball.ply", "empty.ply"}));
}

TEST_F(MeasureCommands, CompareWithItselfHasARange) {
  write_sphere("ball.ply", 1);
  const Outcome outcome = run({"compare", "ball.ply", "ball.ply", "-o", "map.ply"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("a millionth of the diagonal"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("±0\n"), std::string::npos) << outcome.out;
}

TEST_F(MeasureCommands, NoisyFunctionsAreMeasuredWhole) {
  PointSet cloud = sphere(3000);
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 0.03);
  for (Vec3f& p : cloud.positions) p = Vec3f(Vec3(p) * (1 + noise(random)));
  write_points(path("cloud.ply"), cloud);
  ASSERT_EQ(run({"fit", "cloud.ply", "-o", "ball.smf"}).code, 0);
  for (const char* part : {"cloud.ply", "ball.smf"}) {
    const Json json = json_of({"compare", part, "ball.smf"});
    EXPECT_EQ(json["measured"], json["vertices"]) << part;
    EXPECT_EQ(json["beyond"], 0) << part;
    EXPECT_EQ(json["not_found"], 0) << part;
  }
  // Points too far away are distinguished from points without a foot.
  for (Vec3f& p : cloud.positions) p *= 5;
  write_points(path("far.ply"), cloud);
  const Json far = json_of({"compare", "far.ply", "ball.smf"});
  EXPECT_EQ(far["beyond"], far["vertices"]);
  EXPECT_EQ(far["not_found"], 0);
}

TEST_F(MeasureCommands, Functions) {
  write_points(path("cloud.ply"), sphere(4000));
  ASSERT_EQ(run({"fit", "cloud.ply", "-o", "ball.smf"}).code, 0);
  write_sphere("mesh.ply", 1.02f, 5);
  const Json cut = json_of({"section", "ball.smf", "--plane", "z=0.6", "-o", "cut.svg"});
  EXPECT_NEAR(cut["planes"][0]["area"].get<double>(), 0.64 * pi, 2e-3);
  EXPECT_EQ(cut["planes"][0]["open_curves"], 0);
  EXPECT_EQ(cut["input"]["kind"], "function");
  const Json coarse = json_of({"section", "ball.smf", "--plane", "z=0.6", "--resolution", "32"});
  EXPECT_LT(coarse["planes"][0]["vertices"], cut["planes"][0]["vertices"]);
  EXPECT_NEAR(json_of({"compare", "mesh.ply", "ball.smf"})["distance"]["mean"].get<double>(), 0.02, 1e-3);
  EXPECT_NEAR(json_of({"compare", "ball.smf", "mesh.ply"})["distance"]["mean"].get<double>(), -0.02, 4e-3);
  EXPECT_NEAR(json_of({"measure", "ball.smf"})["whole"]["volume"].get<double>(), 4 * pi / 3, 0.02);
}

TEST_F(MeasureCommands, OpenMeshesHaveNoVolumeAndSoupsNoOrientation) {
  TriangleMesh mesh = octasphere(3);
  write_mesh(path("closed.ply"), mesh);
  mesh.triangles.pop_back();
  write_mesh(path("open.ply"), mesh);
  for (const char* file : {"closed.ply", "open.ply"}) {
    const Json measured = json_of({"measure", file})["whole"]["volume"];
    const Json evaluated = json_of({"assess", file})["quality"]["volume"];
    ASSERT_EQ(measured.is_null(), evaluated.is_null()) << file;
    if (!measured.is_null()) EXPECT_NEAR(measured.get<double>(), evaluated.get<double>(), 1e-6);
  }
  EXPECT_TRUE(json_of({"assess", "open.ply"})["quality"]["volume"].is_null());
  EXPECT_EQ(json_of({"assess", "open.ply"})["topology"]["oriented"], true);
  // Faces that do not touch.
  TriangleMesh soup;
  for (std::uint32_t k = 0; k < 5; ++k) {
    const float x = 3 * static_cast<float>(k);
    for (const Vec3f& v : {Vec3f{x, 0, 0}, Vec3f{x + 1, 0, 0}, Vec3f{x, 1, 1}}) soup.vertices.push_back(v);
    soup.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  write_mesh(path("soup.ply"), soup);
  EXPECT_TRUE(json_of({"assess", "soup.ply"})["topology"]["oriented"].is_null());
}

}  // namespace
}  // namespace sansmesh::test
