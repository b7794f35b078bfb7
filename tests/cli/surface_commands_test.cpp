// Tests of commands without meshes: project, curvature, render --surface; and of reconstruct --surface.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "support/clouds.h"
#include "support/mesh_shapes.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

double off_sphere(const PointSet& cloud, double radius = 1) {
  double sum = 0;
  for (const Vec3f& p : cloud.positions) sum += std::abs(norm(cloud.origin + Vec3(p)) - radius);
  return sum / static_cast<double>(cloud.size());
}

class SurfaceCommands : public ToolTest {
 protected:
  void write_sphere(const std::string& name, std::size_t n, double noise = 0, float radius = 1) const {
    PointSet cloud = sphere(n, noise);
    for (Vec3f& p : cloud.positions) p *= radius;
    write_points(path(name), cloud);
  }
  Json json_of(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? Json::parse(outcome.out) : Json();
  }
  void expect_picture(const std::string& name) const {
    const std::string bytes = slurp(path(name));
    EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n") << name;
    EXPECT_GT(bytes.size(), 500u) << name;
  }
};

// --------------------------------------------------------------------------------------------------- project

TEST_F(SurfaceCommands, ProjectTakesNoiseAway) {
  write_sphere("noisy.ply", 4000, 0.02);
  const double before = off_sphere(read_points(path("noisy.ply")));
  for (const char* method : {"curvature", "apss", "levin"}) {
    const Json json = json_of({"project", "noisy.ply", "-o", "smooth.ply", "--method", method});
    const PointSet smooth = read_points(path("smooth.ply"));
    EXPECT_EQ(smooth.size(), json["output"]["points"].get<std::size_t>());
    EXPECT_GT(smooth.size(), 3900u);
    EXPECT_EQ(smooth.normals.size(), smooth.size());
    EXPECT_LT(off_sphere(smooth), 0.45 * before) << method;
    EXPECT_EQ(json["method"], method);
    EXPECT_NEAR(json["moved"]["mean"].get<double>(), 0.016, 0.006);
    EXPECT_EQ(json["input"]["points"], 4000);
  }
  const Outcome words = run({"project", "noisy.ply", "-o", "smooth.csv"});
  EXPECT_EQ(words.code, 0) << words.err;
  EXPECT_NE(words.out.find("4,000 points"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("with normals"), std::string::npos) << words.out;
}

TEST_F(SurfaceCommands, ProjectOntoAnotherScan) {
  write_sphere("scan.ply", 4000);
  PointSet probes = sphere(500, 0.02, 4);
  probes.normals.clear();
  for (std::size_t i = 0; i < probes.size(); ++i) probes.colors.push_back({10, 20, 30});
  for (std::size_t i = 0; i < 50; ++i) probes.positions[10 * i] *= 4.0f;
  write_points(path("probes.ply"), probes);
  const Json json = json_of({"project", "probes.ply", "--onto", "scan.ply", "-o", "feet.ply"});
  EXPECT_EQ(json["left_out"], 50);
  const PointSet feet = read_points(path("feet.ply"));
  EXPECT_EQ(feet.size(), 450u);
  EXPECT_EQ(feet.colors.size(), 450u);
  EXPECT_LT(off_sphere(feet), 1e-3);
  const Outcome words = run({"project", "probes.ply", "--onto", "scan.ply", "-o", "feet.ply"});
  EXPECT_NE(words.out.find("50 too far"), std::string::npos) << words.out;

  for (Vec3f& p : probes.positions) p *= 10.0f;
  write_points(path("far.ply"), probes);
  std::filesystem::remove(path("feet.ply"));
  const Outcome far = run({"project", "far.ply", "--onto", "scan.ply", "-o", "feet.ply"});
  EXPECT_EQ(far.code, 1);
  EXPECT_EQ(far.lines_of_error(), 1) << far.err;
  EXPECT_NE(far.err.find("far.ply"), std::string::npos) << far.err;
  EXPECT_FALSE(std::filesystem::exists(path("feet.ply")));
}

TEST_F(SurfaceCommands, ProjectSpreadsNewPoints) {
  write_sphere("scan.ply", 3000);
  for (const auto& [count, method] : {std::pair{600, "curvature"}, {9000, "apss"}}) {
    const Json json =
        json_of({"project", "scan.ply", "-o", "even.xyz", "--point-count", std::to_string(count), "--method", method});
    EXPECT_NEAR(json["output"]["points"].get<double>(), count, 0.1 * count);
    EXPECT_LT(off_sphere(read_points(path("even.xyz"))), 2e-3) << method;
  }
  // The recommended method by default; options that only other surfaces use select one of them.
  write_sphere("noisy.ply", 3000, 0.02, 1);
  EXPECT_EQ(json_of({"project", "noisy.ply", "-o", "smooth.ply"})["method"], "partition");
  EXPECT_LT(off_sphere(read_points(path("smooth.ply"))), 0.3 * 0.02);
  EXPECT_EQ(json_of({"project", "noisy.ply", "-o", "smooth.ply", "--smoothing", "3"})["method"], "curvature");
  PointSet stray = sphere(3000, 0.01);
  for (const Vec3f& p : sphere(40).positions) {
    stray.positions.push_back(p * 2.0f);
    stray.normals.push_back(p);
  }
  write_points(path("stray.ply"), stray);
  const Json json = json_of({"project", "stray.ply", "-o", "lop.ply", "--method", "lop", "--point-count", "1000"});
  EXPECT_EQ(json["output"]["points"], 1000);
  const PointSet lop = read_points(path("lop.ply"));
  EXPECT_EQ(lop.size(), 1000u);
  EXPECT_LT(off_sphere(lop), 0.01);
}

// ------------------------------------------------------------------------------------------------- curvature

TEST_F(SurfaceCommands, CurvatureOfASphere) {
  SANSMESH_NOT_SANITIZED("judges accuracy; the next one runs the command, too");
  write_sphere("ball.ply", 2000, 0, 5);
  const Json json =
      json_of({"curvature", "ball.ply", "-o", "curved.ply", "--preview", "curved.png", "--color-by", "k1"});
  EXPECT_NEAR(json["quantiles"]["median"].get<double>(), 0.2, 0.004);
  EXPECT_NEAR(json["quantiles"]["q05"].get<double>(), 0.2, 0.01);
  EXPECT_NEAR(json["quantiles"]["q95"].get<double>(), 0.2, 0.01);
  EXPECT_EQ(json["undefined"], 0);
  EXPECT_EQ(json["input"]["points"], 2000);
  expect_picture("curved.png");
  const std::string file = slurp(path("curved.ply")), header = file.substr(0, file.find("end_header"));
  for (const char* name : {"k1", "k2", "mean_curvature", "gaussian_curvature", "curvedness", "shape_index", "d1x",
                           "d1y", "d1z", "d2x", "d2y", "d2z"})
    EXPECT_NE(header.find(std::string("property float ") + name + "\n"), std::string::npos) << name;
  const PointSet points = read_points(path("curved.ply"));
  EXPECT_EQ(points.size(), 2000u);
  EXPECT_EQ(points.colors.size(), 2000u);
  EXPECT_LT(off_sphere(points, 5), 1e-4) << "points stay where they are";
  const Json gaussian = json_of({"curvature", "ball.ply", "-o", "curved.ply", "--color-by", "gaussian"});
  EXPECT_NEAR(gaussian["quantiles"]["median"].get<double>(), 0.04, 0.002);
}

TEST_F(SurfaceCommands, CurvatureOfAMeshIsAtItsVertices) {
  // Flat triangles between few vertices: samples on the triangles would have no curvature.
  TriangleMesh coarse = octasphere(2);
  coarse.attributes.set("number", std::vector<float>(coarse.vertices.size(), 7));
  write_mesh(path("coarse.ply"), coarse);
  const Json json = json_of({"curvature", "coarse.ply", "-o", "curved.ply"});
  EXPECT_EQ(json["input"]["points"], coarse.vertices.size());
  EXPECT_NEAR(json["quantiles"]["median"].get<double>(), 1, 1e-3);
  EXPECT_EQ(json["undefined"], 0);
  EXPECT_TRUE(json["warnings"].empty()) << json["warnings"];
  const TriangleMesh curved = read_mesh(path("curved.ply"));
  EXPECT_EQ(curved.vertices, coarse.vertices) << "in the order of the file";
  EXPECT_EQ(curved.triangles, coarse.triangles);
  EXPECT_TRUE(curved.attributes.find("number"));
  ASSERT_TRUE(curved.attributes.find<float>("k2"));
  for (const float k : *curved.attributes.find<float>("k2")) EXPECT_NEAR(k, 1, 1e-3);
  json_of({"curvature", "coarse.ply", "-o", "table.csv"});
  EXPECT_EQ(number_rows(path("table.csv")).size(), coarse.vertices.size());
  EXPECT_EQ(json_of({"curvature", "coarse.ply", "-o", "curved.glb"})["output"]["file"], "curved.glb");
  write_sphere("ball.ply", 500);
  expect_failure({"curvature", "ball.ply", "-o", "curved.glb"}, 1, "curved.glb");
}

TEST_F(SurfaceCommands, CurvatureOfFewOrFlatVertices) {
  TriangleMesh tetrahedron;
  tetrahedron.vertices = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  tetrahedron.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  write_mesh(path("tetrahedron.ply"), tetrahedron);
  EXPECT_EQ(json_of({"curvature", "tetrahedron.ply", "-o", "c.ply"})["input"]["points"], 4);
  TriangleMesh flat;
  for (std::uint32_t v = 0; v < 36; ++v) {
    const std::uint32_t column = v % 6, row = v / 6;
    flat.vertices.push_back({static_cast<float>(column), static_cast<float>(row), 0});
    if (column == 5 || row == 5) continue;
    flat.triangles.push_back({v, v + 1, v + 7});
    flat.triangles.push_back({v, v + 7, v + 6});
  }
  write_mesh(path("flat.ply"), flat);
  const Json json = json_of({"curvature", "flat.ply", "-o", "c.ply"});
  EXPECT_EQ(json["undefined"], 0);
  EXPECT_NEAR(json["quantiles"]["q95"].get<double>(), 0, 1e-6);
}

TEST_F(SurfaceCommands, CurvatureAsATable) {
  write_sphere("ball.ply", 1500, 0, 0.5f);
  const Outcome outcome = run({"curvature", "ball.ply", "-o", "table.csv", "--color-range", "3"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("mean curvature"), std::string::npos) << outcome.out;
  std::istringstream table(slurp(path("table.csv")));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line,
            "x,y,z,nx,ny,nz,red,green,blue,k1,k2,mean_curvature,gaussian_curvature,curvedness,shape_index,"
            "d1x,d1y,d1z,d2x,d2y,d2z");
  std::size_t rows = 0;
  while (std::getline(table, line)) {
    std::vector<double> v;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) v.push_back(std::stod(field));
    ASSERT_EQ(v.size(), 21u);
    ASSERT_NEAR(v[9], 2, 0.3);
    ASSERT_NEAR(v[10], 2, 0.3);
    ASSERT_NEAR(v[11], (v[9] + v[10]) / 2, 1e-4);
    ASSERT_NEAR(v[12], v[9] * v[10], 1e-3);
    // Both directions are unit vectors of the tangent plane.
    const Vec3 n{v[3], v[4], v[5]}, a{v[15], v[16], v[17]}, b{v[18], v[19], v[20]};
    ASSERT_NEAR(norm(a), 1, 1e-4);
    ASSERT_NEAR(norm(b), 1, 1e-4);
    ASSERT_NEAR(dot(a, b), 0, 1e-4);
    ASSERT_NEAR(dot(a, n), 0, 0.1);
    ++rows;
  }
  EXPECT_EQ(rows, 1500u);
}

// ---------------------------------------------------------------------------------------------------- render

TEST_F(SurfaceCommands, RenderCastsRaysAtTheSurface) {
  write_sphere("ball.ply", 2500);
  const std::vector<std::string> small{"--width", "80", "--height", "60", "--antialiasing", "1"};
  const auto render = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"render", "ball.ply", "-o", "out.png"});
    arguments.insert(arguments.end(), small.begin(), small.end());
    std::filesystem::remove(path("out.png"));
    return run(arguments);
  };
  std::vector<std::string> pictures;
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--surface", "apss"}, std::vector<std::string>{"--surface", "curvature", "--quick"},
        std::vector<std::string>{"--surface", "apss", "--color-by", "mean", "--color-range", "1.5"},
        std::vector<std::string>{"--surface", "amls", "--order", "4", "--iterations", "2", "--sharp"},
        std::vector<std::string>{"--surface", "partition"},
        std::vector<std::string>{"--surface", "kolluri", "--reflection", "0.5"}}) {
    const Outcome outcome = render(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    expect_picture("out.png");
    pictures.push_back(slurp(path("out.png")));
    EXPECT_NE(outcome.out.find("80 × 60 pixels"), std::string::npos) << outcome.out;
  }
  EXPECT_NE(pictures[0], pictures[2]) << "colours";
  EXPECT_NE(pictures[0], pictures[5]) << "mirror";
  const Json json = json_of({"render", "ball.ply", "-o", "out.png", "--surface", "apss", "--width", "80", "--height",
                             "60", "--antialiasing", "1", "--view", "front"});
  EXPECT_EQ(json["surface"]["method"], "apss");
  EXPECT_EQ(json["input"]["samples"], 2500);
  EXPECT_GE(json["rays"]["cast"].get<double>(), 80 * 60);
  EXPECT_GT(json["rays"]["hit"].get<double>(), 500);
  EXPECT_EQ(json["output"]["width"], 80);
}

TEST_F(SurfaceCommands, RenderTurnsAround) {
  write_sphere("ball.ply", 1500);
  const Json json = json_of({"render", "ball.ply", "-o", "turn.png", "--surface", "apss", "--quick", "--frames", "3",
                             "--width", "60", "--height", "50"});
  EXPECT_EQ(json["output"]["files"], (std::vector<std::string>{"turn_000.png", "turn_001.png", "turn_002.png"}));
  EXPECT_EQ(listing(), (std::vector<std::string>{"ball.ply", "turn_000.png", "turn_001.png", "turn_002.png"}));
  for (const char* name : {"turn_000.png", "turn_001.png", "turn_002.png"}) expect_picture(name);
}

TEST_F(SurfaceCommands, OutputDoesNotDependOnThreads) {
  SANSMESH_NOT_SANITIZED("the same commands several times");
  PointSet cloud = torus(2500);
  write_points(path("ring.ply"), cloud);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"project", "ring.ply", "-o", "out.ply"},
        std::vector<std::string>{"project", "ring.ply", "-o", "out.ply", "--point-count", "1000"},
        std::vector<std::string>{"project", "ring.ply", "-o", "out.ply", "--method", "lop"},
        std::vector<std::string>{"curvature", "ring.ply", "-o", "out.ply"},
        std::vector<std::string>{"render", "ring.ply", "-o", "out.png", "--surface", "curvature", "--width", "60",
                                 "--height", "60"}}) {
    std::string first;
    for (const char* threads : {"1", "5"}) {
      std::vector<std::string> arguments = command;
      arguments.insert(arguments.end(), {"--threads", threads});
      const Outcome outcome = run(arguments);
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      const std::string bytes = slurp(path(command[3]));
      if (first.empty()) first = bytes;
      EXPECT_EQ(bytes, first) << command[0] << ", " << threads << " threads";
    }
  }
}

// ----------------------------------------------------------------------------------------------- reconstruct

TEST_F(SurfaceCommands, ReconstructCutsTheSurfaceOut) {
  write_sphere("ball.ply", 3000);
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--surface", "apss"}, std::vector<std::string>{"--surface", "curvature"},
        std::vector<std::string>{"--surface", "partition"},
        std::vector<std::string>{"--surface", "adamson", "--smoothing", "2"}}) {
    std::vector<std::string> arguments{"reconstruct", "ball.ply", "-o", "out.ply"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const TriangleMesh mesh = read_mesh(path("out.ply"));
    EXPECT_TRUE(measure_topology(mesh).closed()) << more[1];
    EXPECT_EQ(measure_topology(mesh).genus(), 0) << more[1];
    for (const Vec3f& v : mesh.vertices) ASSERT_NEAR(norm(v), 1, 0.01) << more[1];
  }
  write_points(path("cube.ply"), cube(6000));
  const auto on_edges = [&](bool sharp) {
    std::vector<std::string> arguments{"reconstruct", "cube.ply", "-o", "cube.obj", "--surface", "apss"};
    if (sharp) arguments.push_back("--sharp");
    EXPECT_EQ(run(arguments).code, 0);
    const TriangleMesh mesh = read_mesh(path("cube.obj"));
    EXPECT_TRUE(measure_topology(mesh).closed());
    std::size_t count = 0;
    for (const Vec3f& v : mesh.vertices) {
      std::array<float, 3> size{std::abs(v.x), std::abs(v.y), std::abs(v.z)};
      std::sort(size.begin(), size.end());
      count += size[1] > 0.995f && size[2] < 1.005f;
    }
    return count;
  };
  const std::size_t sharp = on_edges(true), rounded = on_edges(false);
  EXPECT_GT(sharp, 100u);
  EXPECT_GT(sharp, 3 * rounded);
}

// ------------------------------------------------------------------------------------- what cannot be done

TEST_F(SurfaceCommands, WrongOptionsAreUsageErrors) {
  write_sphere("ball.ply", 300);
  const auto before = listing();
  struct Refused {
    std::vector<std::string> arguments;
    const char* cause;
  };
  for (const Refused& wrong : std::vector<Refused>{
           {{"project", "ball.ply", "-o", "out.ply", "--method", "magic"}, "magic"},
           {{"project", "ball.ply", "-o", "out.ply", "--point-count", "0"}, "--point-count"},
           {{"project", "ball.ply", "-o", "out.ply", "--most-steps", "0"}, "steps"},
           {{"project", "ball.ply", "-o", "out.ply", "--tolerance", "7"}, "tolerance"},
           {{"project", "ball.ply", "-o", "out.ply", "--method", "apss", "--diffusion", "soft"}, "diffusion"},
           {{"project", "ball.ply", "-o", "out.ply", "--diffusion", "much"}, "much"},
           {{"project", "ball.ply", "-o", "out.ply", "--smoothing", "99"}, "smoothing"},
           {{"project", "ball.ply", "-o", "out.ply", "--method", "lop", "--repulsion", "0.9"}, "repulsion"},
           {{"project", "ball.ply", "-o", "out.ply", "--method", "lop", "--radius", "-1"}, "radius"},
           {{"project", "ball.ply", "-o", "out.ply", "--method", "lop", "--onto", "ball.ply"}, "onto"},
           {{"project", "ball.ply", "-o", "out.ply", "--method", "lop", "--sharp"}, "sharp"},
           {{"project", "ball.ply", "-o", "out.ply", "--method", "apss", "--radius", "1"}, "radius"},
           {{"project", "ball.ply"}, "--output"},
           {{"curvature", "ball.ply", "-o", "out.ply", "--color-by", "taste"}, "taste"},
           {{"curvature", "ball.ply", "-o", "out.ply", "--color-range", "0"}, "--color-range"},
           {{"curvature", "ball.ply", "-o", "out.ply", "--neighbours", "2"}, "neighbours"},
           {{"curvature", "ball.ply", "-o", "out.ply", "--tau", "9"}, "tau"},
           {{"curvature", "ball.ply", "-o", "out.ply", "--weights", "heavy"}, "gaussian"},
           {{"curvature", "ball.ply", "-o", "out.ply", "--bandwidth", "-2"}, "bandwidth"},
           {{"render", "ball.ply", "-o", "out.png", "--quick"}, "--quick"},
           {{"render", "ball.ply", "-o", "out.png", "--sharp"}, "--sharp"},
           {{"render", "ball.ply", "-o", "out.png", "--color-by", "mean"}, "--color-by"},
           {{"render", "ball.ply", "-o", "out.png", "--order", "4"}, "--order"},
           {{"render", "ball.ply", "-o", "out.png", "--smoothing", "2"}, "--smoothing"},
           {{"render", "ball.ply", "-o", "out.png", "--surface", "apss", "--order", "4"}, "order"},
           {{"render", "ball.ply", "-o", "out.png", "--surface", "partition", "--bandwidth", "4"}, "width"},
           {{"render", "ball.ply", "-o", "out.png", "--surface", "marble"}, "marble"},
           {{"render", "ball.ply", "-o", "out.png", "--surface", "apss", "--frames", "0"}, "--frames"},
           {{"render", "ball.ply", "-o", "out.png", "--surface", "apss", "--reflection", "2"}, "reflection"},
           {{"render", "ball.ply", "-o", "out.png", "--surface", "apss", "--color-by", "blue"}, "blue"},
           {{"reconstruct", "ball.ply", "-o", "out.ply", "--surface", "marble"}, "marble"},
           {{"reconstruct", "ball.ply", "-o", "out.ply", "--surface", "apss", "--iterations", "3"}, "iterations"},
           {{"reconstruct", "ball.ply", "-o", "out.ply", "--bandwidth", "3"}, "--bandwidth"}}) {
    std::string line;
    for (const std::string& a : wrong.arguments) line += a + " ";
    const Outcome outcome = run(wrong.arguments);
    EXPECT_EQ(outcome.code, 2) << line << outcome.err;
    EXPECT_EQ(outcome.out, "") << line;
    EXPECT_EQ(outcome.lines_of_error(), 1) << line << outcome.err;
    EXPECT_NE(outcome.err.find(wrong.cause), std::string::npos) << line << outcome.err;
    EXPECT_EQ(listing(), before) << line;
    for (const std::string& name : listing())
      if (std::find(before.begin(), before.end(), name) == before.end()) std::filesystem::remove(path(name));
  }
}

TEST_F(SurfaceCommands, BadInputIsOneLineAndLeavesNothing) {
  std::string line;
  for (int i = 0; i < 400; ++i) line += std::to_string(i) + " 3 7\n";
  write("empty.ply", "");
  write("nan.xyz", "nan nan nan\nnan nan nan\nnan nan nan\nnan nan nan\n");
  write("one.xyz", "1 2 3\n");
  write("line.xyz", line);
  write_sphere("ball.ply", 300);
  const auto before = listing();
  for (const char* file : {"absent.ply", "empty.ply", "nan.xyz", "one.xyz", "line.xyz"}) {
    std::vector<std::vector<std::string>> commands{
        {"project", file, "-o", "out.ply"},
        {"project", file, "-o", "out.ply", "--method", "apss", "--point-count", "100"},
        {"project", "ball.ply", "--onto", file, "-o", "out.ply"},
        {"curvature", file, "-o", "out.ply", "--preview", "out.png"},
        {"render", file, "-o", "out.png", "--surface", "apss"},
        {"render", file, "-o", "out.png", "--surface", "curvature", "--frames", "2", "--quick"},
        {"reconstruct", file, "-o", "out.ply", "--surface", "apss"}};
    // Consolidation needs no surface: it accepts lines and single points.
    if (file != std::string("line.xyz") && file != std::string("one.xyz"))
      commands.push_back({"project", file, "-o", "out.ply", "--method", "lop"});
    for (const auto& command : commands) {
      const Outcome outcome = run(command);
      EXPECT_EQ(outcome.code, 1) << command[0] << " " << file << ": " << outcome.err;
      EXPECT_EQ(outcome.out, "") << command[0];
      std::string last = outcome.err;  // warnings may precede it
      while (std::count(last.begin(), last.end(), '\n') > 1) last.erase(0, last.find('\n') + 1);
      EXPECT_EQ(last.find("sansmesh: "), 0u) << outcome.err;
      EXPECT_NE(last.find(file), std::string::npos) << command[0] << ": " << outcome.err;
      EXPECT_EQ(listing(), before) << command[0] << " " << file;
    }
  }
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"project", "ball.ply", "-o", "out.docx"},
        std::vector<std::string>{"project", "ball.ply", "-o", "no/such/out.ply"},
        std::vector<std::string>{"curvature", "ball.ply", "-o", "out.glb"},
        std::vector<std::string>{"curvature", "ball.ply", "-o", "out.ply", "--preview", "out.jpg"},
        std::vector<std::string>{"render", "ball.ply", "-o", "out.jpg", "--surface", "apss"}}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_EQ(outcome.lines_of_error(), 1) << outcome.err;
    EXPECT_EQ(listing(), before);
  }
}

}  // namespace
}  // namespace sansmesh::test
