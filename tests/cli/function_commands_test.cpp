// Tests of commands on function files: fit, mesh, probe and render.
#include <cmath>
#include <nlohmann/json.hpp>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

class FunctionCommands : public ToolTest {
 protected:
  void fit_sphere(const std::string& name = "ball.smf", std::size_t n = 2000) const {
    write_points(path("ball.ply"), sphere(n));
    const Outcome outcome = run({"fit", "ball.ply", "-o", name, "--quiet"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::filesystem::remove(path("ball.ply"));
  }
};

TEST_F(FunctionCommands, FitMeshEvalRenderTheBundledScan) {
  const Json fit = json_of({"fit", kOwl, "-o", "owl.smf"});
  EXPECT_EQ(fit["input"]["points"], 12442);
  EXPECT_GT(fit["fits"].get<int>(), 500);
  EXPECT_EQ(fit["output"]["samples"], 12442);
  EXPECT_EQ(listing(), std::vector<std::string>{"owl.smf"});
  EXPECT_EQ(slurp(path("owl.smf")).substr(0, 4), "\x89SMF");

  const Json mesh = json_of({"mesh", "owl.smf", "-o", "owl.ply", "--preview", "owl.png"});
  EXPECT_TRUE(mesh["output"]["closed"]);
  EXPECT_EQ(mesh["output"]["components"], 1);
  const TriangleMesh made = read_mesh(path("owl.ply"));
  EXPECT_EQ(made.triangles.size(), mesh["output"]["triangles"].get<std::size_t>());
  EXPECT_EQ(measure_topology(made).genus(), 0);
  EXPECT_EQ(slurp(path("owl.png")).substr(1, 3), "PNG");

  // The mesh is byte-identical to that of `reconstruct`. (Other tests reconstruct this scan with sanitizers.)
  if (!kAddressSanitizer) {
    ASSERT_EQ(run({"reconstruct", kOwl, "-o", "direct.ply"}).code, 0);
    EXPECT_TRUE(slurp(path("direct.ply")) == slurp(path("owl.ply")));
  }

  // The samples are on the surface fitted to them.
  const Json probed = json_of({"probe", "owl.smf", "--points", kOwl, "-o", "values.csv"});
  EXPECT_EQ(probed["points"], 12442);
  EXPECT_LT(probed["absolute_value"]["mean"].get<double>(), 2 * fit["spacing"].get<double>());
  EXPECT_LT(probed["largest_gradient"].get<double>(), 50);
  const std::string csv = slurp(path("values.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 12443);
  for (const char* column : {"value", "gradient_x", "gradient_y", "gradient_z", "k1", "k2"})
    EXPECT_NE(csv.substr(0, csv.find('\n')).find(column), std::string::npos) << column;

  const Outcome render = run({"render", "owl.smf", "-o", "picture.png", "--width", "160", "--height", "120"});
  ASSERT_EQ(render.code, 0) << render.err;
  EXPECT_EQ(slurp(path("picture.png")).substr(1, 3), "PNG");
}

TEST_F(FunctionCommands, EvalTellsDistanceGradientAndCurvature) {
  fit_sphere("ball.smf", 8000);
  const Json json = json_of({"probe", "ball.smf", "--at", "0,0,1.02"});
  ASSERT_EQ(json["values"].size(), 1u);
  const Json& p = json["values"][0];
  EXPECT_NEAR(p["value"].get<double>(), 0.02, 2e-3);
  EXPECT_NEAR(p["gradient"][2].get<double>(), 1, 0.05);
  EXPECT_NEAR(p["gradient"][0].get<double>(), 0, 0.05);
  EXPECT_NEAR(p["k1"].get<double>(), 0.98, 0.1);
  EXPECT_NEAR(p["k2"].get<double>(), 0.98, 0.1);
  EXPECT_EQ(json["inside"], 0);
  EXPECT_EQ(json_of({"probe", "ball.smf", "--at", "0,0,0.5"})["inside"], 1);
  const Outcome words = run({"probe", "ball.smf", "--at", "0,0,1"});
  EXPECT_NE(words.out.find("gradient ("), std::string::npos) << words.out;
  // Also far away.
  const Json far = json_of({"probe", "ball.smf", "--at", "1e30,0,0"});
  EXPECT_TRUE(far["values"][0]["value"].is_number());
  EXPECT_EQ(far["inside"], 0);
}

TEST_F(FunctionCommands, UnitsAreThoseOfTheInput) {
  PointSet cloud = sphere(4000);
  for (Vec3f& p : cloud.positions) p *= 250.0f;
  cloud.origin = {500000, 5800000, 100};
  write_points(path("far.ply"), cloud);
  ASSERT_EQ(run({"fit", "far.ply", "-o", "far.smf"}).code, 0);
  const Json p = json_of({"probe", "far.smf", "--at", "500255,5800000,100"})["values"][0];
  EXPECT_NEAR(p["value"].get<double>(), 5, 0.5);
  EXPECT_NEAR(p["k1"].get<double>() * 255, 1, 0.15);
  ASSERT_EQ(run({"mesh", "far.smf", "-o", "far-mesh.ply"}).code, 0);
  const TriangleMesh mesh = read_mesh(path("far-mesh.ply"));
  for (const Vec3f& v : mesh.vertices) ASSERT_NEAR(norm(mesh.origin + Vec3(v) - cloud.origin), 250, 2);
}

TEST_F(FunctionCommands, WithoutSamplesAndGzipped) {
  write_points(path("ball.ply"), sphere(2000));
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "all.smf"}).code, 0);
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "lean.smf", "--without-samples"}).code, 0);
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "packed.smf.gz"}).code, 0);
  EXPECT_LT(std::filesystem::file_size(path("lean.smf")) + 2000 * 24, std::filesystem::file_size(path("all.smf")));
  EXPECT_LT(std::filesystem::file_size(path("packed.smf.gz")), std::filesystem::file_size(path("all.smf")));
  for (const char* name : {"all.smf", "lean.smf", "packed.smf.gz"}) {
    ASSERT_EQ(run({"mesh", name, "-o", std::string(name) + ".ply"}).code, 0) << name;
    EXPECT_TRUE(slurp(path(std::string(name) + ".ply")) == slurp(path("all.smf.ply"))) << name;
  }
  const Outcome trimmed = run({"mesh", "lean.smf", "-o", "trimmed.ply", "--trim", "0"});
  EXPECT_EQ(trimmed.code, 1);
  EXPECT_NE(trimmed.err.find("lean.smf: cannot be trimmed: its samples were not kept"), std::string::npos)
      << trimmed.err;
}

TEST_F(FunctionCommands, SameFileWhateverTheThreads) {
  SANSMESH_NOT_SANITIZED("the same commands several times");
  std::string one;
  for (const char* threads : {"1", "2", "8"}) {
    ASSERT_EQ(run({"fit", kOwl, "-o", "owl.smf", "--threads", threads}).code, 0);
    if (one.empty()) one = slurp(path("owl.smf"));
    EXPECT_TRUE(slurp(path("owl.smf")) == one) << threads;
  }
}

TEST_F(FunctionCommands, ErrorsAreOneLineAndLeaveNothing) {
  fit_sphere("good.smf", 500);
  write_points(path("scan.ply"), sphere(500));
  const std::string good = slurp(path("good.smf"));
  write("short.smf", good.substr(0, good.size() / 2));
  std::string changed = good;
  changed[good.size() / 2] = static_cast<char>(changed[good.size() / 2] ^ 1);
  write("damaged.smf", changed);
  std::string newer = good;
  newer[8] = 9;
  write("newer.smf", newer);
  write("empty.smf", "");
  write("text.smf", "solid part\n");
  write("line.xyz", [] {
    std::string text;
    for (int i = 0; i < 400; ++i) text += std::to_string(i) + " 3 5\n";
    return text;
  }());
  expect_failures({
      {{"fit", "absent.ply", "-o", "x.smf"}, 1, {"absent.ply: no such file"}},
      {{"fit", "line.xyz", "-o", "x.smf"}, 1, {"line.xyz: "}},
      {{"fit", "scan.ply", "-o", "x.ply"}, 1, {"x.ply: functions are written to files with the ending .smf"}},
      {{"fit", "scan.ply", "-o", "absent/x.smf"}, 1, {"absent/x.smf: "}},
      {{"fit", "scan.ply"}, 2, {"--output"}},
      {{"fit", "scan.ply", "-o", "x.smf", "--degree", "7"}, 2, {"degree"}},
      {{"fit", "good.smf", "-o", "x.smf"}, 1, {"good.smf: is a function"}},
      {{"mesh", "absent.smf", "-o", "x.ply"}, 1, {"absent.smf: no such file"}},
      {{"mesh", "scan.ply", "-o", "x.ply"}, 1, {"scan.ply: is not a function file"}},
      {{"mesh", "text.smf", "-o", "x.ply"}, 1, {"text.smf: is not a function file"}},
      {{"mesh", "empty.smf", "-o", "x.ply"}, 1, {"empty.smf: is empty"}},
      {{"mesh", "short.smf", "-o", "x.ply"}, 1, {"short.smf: truncated: "}},
      {{"mesh", "damaged.smf", "-o", "x.ply"}, 1, {"damaged.smf: damaged: the checksum of section "}},
      {{"mesh", "newer.smf", "-o", "x.ply"}, 1, {"newer.smf: was written by a newer version"}},
      {{"mesh", "good.smf", "-o", "x.smf"}, 1, {"x.smf: "}},
      {{"mesh", "good.smf", "-o", "x.docx"}, 1, {"x.docx: "}},
      {{"mesh", "good.smf", "-o", "x.ply", "--preview", "x.ply2"}, 1, {"x.ply2: "}},
      {{"mesh", "good.smf", "-o", "x.ply", "--triangles", "2"}, 2, {"triangles"}},
      {{"probe", "good.smf"}, 2, {"either --points FILE or --at x,y,z"}},
      {{"probe", "good.smf", "--at", "1,2"}, 2, {"--at"}},
      {{"probe", "good.smf", "--at", "nan,0,0"}, 2, {"--at"}},
      {{"probe", "good.smf", "--at", "1,2,3", "--points", "scan.ply"}, 2, {"either"}},
      {{"probe", "good.smf", "--points", "absent.ply"}, 1, {"absent.ply: no such file"}},
      {{"probe", "scan.ply", "--at", "0,0,0"}, 1, {"scan.ply: is not a function file"}},
      {{"probe", "good.smf", "--at", "0,0,0", "-o", "x.png"}, 1, {"x.png: "}},
      {{"reconstruct", "good.smf", "-o", "x.ply"}, 1, {"good.smf: is a function, not points or a mesh"}},
      {{"render", "short.smf", "-o", "x.png"}, 1, {"short.smf: truncated"}},
      {{"info", "absent.smf"}, 1, {"absent.smf: no such file"}},
  });
}

// All commands that read the same samples report the same spacing and noise.
TEST_F(FunctionCommands, SpacingAndNoiseAreThoseOfTheFile) {
  const Json info = json_of({"info", kOwl});
  for (const Json& other : {json_of({"reconstruct", kOwl, "-o", "owl.ply", "--depth", "4"}),
                            json_of({"fit", kOwl, "-o", "owl.smf", "--depth", "4"})}) {
    for (const char* name : {"spacing", "noise", "noise_known", "most_noise"})
      EXPECT_EQ(other[name], info[name]) << name;
    EXPECT_GT(other["deviation"], 0);
  }
  EXPECT_GT(json_of({"info", "owl.smf"})["deviation"], 0);
}

}  // namespace
}  // namespace sansmesh::test
