// Tests of surveys: tiles, classes of points, coordinates of a thousand kilometres in millimetres.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "support/clouds.h"
#include "support/las_file.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

constexpr double kRadius = 25;
constexpr std::size_t kSamples = 6000;
const Vec3 kCenter{1234567.891, 5432109.877, 321.005};

class SurveyCommands : public ToolTest {
 protected:
  /// Writes two overlapping tiles: a ball of class 2, with stray samples of class 7 around it in the first.
  void write_tiles() const {
    LasFile west{.format = 6, .offset = {1234000, 5432000, 0}}, east{.format = 1, .offset = {1230000, 5430000, 100}};
    const auto put = [](LasFile& tile, const Vec3& x, unsigned number) {
      const Vec3 steps = (x - tile.offset) * 1000.0;
      tile.points.push_back({.x = static_cast<std::int32_t>(std::lround(steps.x)),
                             .y = static_cast<std::int32_t>(std::lround(steps.y)),
                             .z = static_cast<std::int32_t>(std::lround(steps.z)),
                             .intensity = 100,
                             .classification = number});
    };
    for (const Vec3f& p : sphere(kSamples).positions) {
      const Vec3 x = kCenter + Vec3(p) * kRadius;
      if (p.x < 0.1f) put(west, x, 2);
      if (p.x > -0.1f) put(east, x, 2);
    }
    for (int i = 0; i < 300; ++i)
      put(west, kCenter + Vec3{-40 + 0.2 * i, 30 + 10 * std::sin(i), 10 * std::cos(3.0 * i)}, 7);
    write("west.las", west.bytes());
    write("east.las", east.bytes());
  }

  static double off_the_ball(const TriangleMesh& mesh) {
    double worst = 0;
    for (const Vec3f& v : mesh.vertices)
      worst = std::max(worst, std::abs(norm(mesh.origin + Vec3(v) - kCenter) - kRadius));
    return worst;
  }
};

TEST_F(SurveyCommands, BoxesAndLevelsSelectWhileReading) {
  write_tiles();
  // East of the centre: the western tile has no points there.
  const std::string box = "1234571,5432000,0,1234700,5432200,1000";
  Outcome outcome = run({"convert", "west.las", "east.las", "--read-box", box, "-o", "part.laz"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const PointSet part = read_points(path("part.laz"));
  EXPECT_GT(part.size(), 1000u);
  for (const Vec3f& p : part.positions) ASSERT_GE(part.origin.x + p.x, 1234570.999);
  outcome = run({"info", "west.las", "--read-box", "0,0,0,1,1,1"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("holds no points in the box from (0, 0, 0) to (1, 1, 1)"), std::string::npos)
      << outcome.err;
  outcome = run({"info", "part.laz", "--read-spacing", "5"});
  EXPECT_NE(outcome.err.find("has no levels of resolution"), std::string::npos) << outcome.err;
  EXPECT_EQ(run({"info", "part.laz", "--read-box", "1,1,1,0,0,0"}).code, 2);
  EXPECT_EQ(run({"info", "part.laz", "--read-spacing", "0"}).code, 2);
}

TEST_F(SurveyCommands, TilesAndClassesMakeOneSurface) {
  write_tiles();
  const Outcome outcome =
      run({"reconstruct", "west.las", "east.las", "--class", "ground", "-o", "ball.ply", "--threads", "2"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("west.las and 1 other file"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("at the position of another sample"), std::string::npos) << outcome.err;
  const TriangleMesh mesh = read_mesh(path("ball.ply"));
  EXPECT_TRUE(measure_topology(mesh).closed());
  EXPECT_EQ(measure_topology(mesh).components, 1u);
  EXPECT_LT(off_the_ball(mesh), 0.01 * kRadius);

  // Dropping the stray samples gives the same result.
  const Json json = json_of({"reconstruct", "west.las", "east.las", "--without-class", "noise", "-o", "again.ply"});
  EXPECT_EQ(slurp(path("again.ply")), slurp(path("ball.ply")));
  EXPECT_EQ(json["input"]["files"], (Json{"west.las", "east.las"}));
  EXPECT_EQ(json["input"]["format"], "2 files, LAS 1.4");
  EXPECT_EQ(json["input"]["points"], read_points(path("west.las")).size() + read_points(path("east.las")).size() - 300);
}

TEST_F(SurveyCommands, OtherCommandsReadThemToo) {
  write_tiles();
  const std::vector<std::string> tiles{"west.las", "east.las", "--class", "2"};
  const auto with = [&](std::string command, std::vector<std::string> more) {
    more.insert(more.begin(), tiles.begin(), tiles.end());
    more.insert(more.begin(), std::move(command));
    return more;
  };
  const std::size_t points = read_points(path("west.las")).size() + read_points(path("east.las")).size() - 300;
  for (const auto& [command, more] :
       std::vector<std::pair<std::string, std::vector<std::string>>>{{"fit", {"-o", "a.smf"}},
                                                                     {"normals", {"-o", "a.ply"}},
                                                                     {"project", {"-o", "b.ply"}},
                                                                     {"curvature", {"-o", "c.ply"}},
                                                                     {"advise", {}}}) {
    const Json json = json_of(with(command, more));
    // `curvature` counts the samples after removal of duplicates, which are those in both tiles.
    EXPECT_EQ(json["input"]["points"], command == "curvature" ? kSamples : points) << command;
    EXPECT_EQ(json["input"]["files"], (Json{"west.las", "east.las"})) << command;
    if (command == "advise") {
      const std::string told = json["recommendations"][0]["commands"][0];
      EXPECT_NE(told.find(" west.las east.las --class 2 "), std::string::npos) << told;
    }
  }
  EXPECT_EQ(read_points(path("a.ply")).size(), points);
  for (const std::vector<std::string>& how : {std::vector<std::string>{}, {"--surface", "apss"}}) {
    std::vector<std::string> arguments = with("render", {"-o", "a.png", "--width", "64", "--height", "48"});
    arguments.insert(arguments.end(), how.begin(), how.end());
    EXPECT_EQ(run(arguments).code, 0);
  }

  const Json all = json_of({"info", "west.las", "east.las", "--as-one"});
  EXPECT_EQ(all["points"], points + 300);
  EXPECT_EQ(all["classes"], (Json{{"2", points}, {"7", 300}}));
  const Outcome told = run({"info", "west.las"});
  EXPECT_NE(told.out.find("7 low-noise: 300"), std::string::npos) << told.out;
}

/// One report per file; an error in one does not suppress the others.
TEST_F(SurveyCommands, InfoTellsOfSeveralFiles) {
  write_tiles();
  const Json two = json_of({"info", "west.las", "east.las"});
  ASSERT_EQ(two["files"].size(), 2u);
  EXPECT_EQ(two["files"][0]["file"], "west.las");
  EXPECT_EQ(two["files"][1]["points"], read_points(path("east.las")).size());
  EXPECT_EQ(two["schema"], 1);
  const Outcome outcome = run({"info", "west.las", "none.las", "east.las", "--json"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "sansmesh: none.las: no such file\n");
  const Json three = Json::parse(outcome.out)["files"];
  ASSERT_EQ(three.size(), 3u);
  EXPECT_EQ(three[1]["file"], "none.las");
  EXPECT_EQ(three[1]["error"]["text"], "none.las: no such file");
  EXPECT_EQ(three[2], two["files"][1]);
  const Outcome words = run({"info", "none.las", "west.las"});
  EXPECT_EQ(words.code, 1);
  EXPECT_NE(words.out.find("west.las: LAS"), std::string::npos) << words.out;
  EXPECT_EQ(run({"info", "west.las", "none.las", "--as-one"}).out, "");
}

TEST_F(SurveyCommands, TheyAreReferencesToo) {
  write_tiles();
  const Json files{"west.las", "east.las"};
  ASSERT_EQ(run({"fit", "west.las", "east.las", "--class", "ground", "-o", "ball.smf"}).code, 0);
  ASSERT_EQ(run({"mesh", "ball.smf", "-o", "ball.ply"}).code, 0);

  const Json ground = json_of({"assess", "ball.ply", "west.las", "east.las", "--class", "ground"});
  EXPECT_EQ(ground["reference"]["files"], files);
  EXPECT_EQ(ground["coverage"]["lost"]["share"], 0);
  const Json noise = json_of({"assess", "ball.ply", "west.las", "east.las", "--class", "noise"});
  EXPECT_GT(noise["from_reference"]["mean"], 4) << "strays";
  EXPECT_LT(ground["from_reference"]["mean"], 0.005 * kRadius);

  const Json map = json_of({"compare", "ball.ply", "west.las", "east.las", "--without-class", "7"});
  EXPECT_EQ(map["reference"]["files"], files);
  EXPECT_EQ(map["reference"]["kind"], "points");
  EXPECT_LT(map["distance"]["rms"], 0.03 * kRadius);

  const std::size_t points = read_points(path("west.las")).size() + read_points(path("east.las")).size() - 300;
  const Json values = json_of({"probe", "ball.smf", "--points", "west.las", "--points", "east.las", "--class", "2"});
  EXPECT_EQ(values["points"], points);
  EXPECT_LT(values["absolute_value"]["max"], 0.01 * kRadius);
  EXPECT_EQ(run({"probe", "ball.smf", "--at", "0,0,0", "--class", "2"}).code, 2) << "a place has no class";

  PointSet probes = sphere(200);  // without classes: the selected classes are those of the samples
  probes.origin = kCenter;
  for (Vec3f& p : probes.positions) p *= 1.01f * static_cast<float>(kRadius);
  write_points(path("probes.ply"), probes);
  ASSERT_EQ(
      run({"project", "probes.ply", "--onto", "west.las", "--onto", "east.las", "--class", "2", "-o", "feet.ply"}).code,
      0);
  const PointSet feet = read_points(path("feet.ply"));
  EXPECT_EQ(feet.size(), 200u);
  for (const Vec3f& p : feet.positions) EXPECT_NEAR(norm(feet.origin + Vec3(p) - kCenter), kRadius, 0.005 * kRadius);

  // Two meshes are one body.
  const Json one = json_of({"measure", "ball.ply"});
  TriangleMesh beside = read_mesh(path("ball.ply"));
  beside.origin.x += 4 * kRadius;
  write_mesh(path("beside.ply"), beside);
  const Json two = json_of({"measure", "ball.ply", "beside.ply"});
  EXPECT_EQ(two["input"]["files"], (Json{"ball.ply", "beside.ply"}));
  EXPECT_EQ(two["component_count"], 2);
  EXPECT_NEAR(two["whole"]["volume"], 2 * static_cast<double>(one["whole"]["volume"]),
              1e-3 * static_cast<double>(one["whole"]["volume"]));
  EXPECT_EQ(json_of({"section", "ball.ply", "beside.ply", "--axis", "z"})["planes"][0]["curves"], 2);
}

TEST_F(SurveyCommands, BadChoicesAreOneLine) {
  write_tiles();
  PointSet bare = sphere(100);
  write_points(path("bare.ply"), bare);
  write("bad.las", "LASF and nothing more");
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  write_mesh(path("mesh.ply"), mesh);
  expect_failures({
      {{"reconstruct", "west.las", "-o", "a.ply", "--class", "grund"}, 2, {"--class", "'grund'", "ground", "building"}},
      {{"fit", "west.las", "-o", "a.smf", "--without-class", "300"}, 2, {"--without-class", "'300'"}},
      {{"normals", "bare.ply", "-o", "a.ply", "--class", "2"}, 1, {"bare.ply", "no class", "--class"}},
      {{"info", "west.las", "--class", "water"}, 1, {"west.las", "--class", "2 (ground), 7 (low-noise)"}},
      {{"info", "west.las", "east.las", "--as-one", "--without-class", "ground,noise"},
       1,
       {"west.las and 1 other file"}},
      {{"reconstruct", "west.las", "none.las", "-o", "a.ply"}, 1, {"none.las", "no such file"}},
      {{"reconstruct", "west.las", "bad.las", "-o", "a.ply"}, 1, {"bad.las", "truncated"}},
      {{"reconstruct", "west.las", "mesh.ply", "-o", "a.ply"}, 1, {"mesh.ply", "holds faces"}},
  });
  ASSERT_EQ(run({"fit", "west.las", "--class", "ground", "-o", "a.smf"}).code, 0);
  expect_failures({
      {{"info", "a.smf", "west.las", "--as-one"}, 1, {"a.smf", "is a function"}},
      {{"render", "a.smf", "--class", "ground", "-o", "a.png"}, 2, {"--class", "function"}},
  });
}

TEST_F(SurveyCommands, WarningsNameTheirFiles) {
  LasFile a{.format = 1, .offset = kCenter}, b = a;
  for (const Vec3f& p : sphere(2000).positions) {
    LasFile& tile = p.z > 0 ? a : b;
    tile.points.push_back({.x = static_cast<std::int32_t>(10000 * p.x),
                           .y = static_cast<std::int32_t>(10000 * p.y),
                           .z = static_cast<std::int32_t>(10000 * p.z)});
  }
  for (int i = 0; i < 10; ++i) b.points[static_cast<std::size_t>(100 * i)].withheld = true;
  write("a.las", a.bytes());
  write("b.las", b.bytes());
  const Outcome outcome = run({"normals", "a.las", "b.las", "-o", "n.ply"});
  ASSERT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "warning: b.las: 10 of 1,000 points are flagged as withheld and were left out\n");
}

/// The same ball, near zero and far away, from files of three kinds to meshes of all kinds, has the same accuracy.
TEST_F(SurveyCommands, MillimetresSurviveReconstruction) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others reconstruct, too");
  LasFile las{.format = 0, .offset = kCenter};
  std::string table;
  PointSet far;
  far.origin = kCenter;
  for (const Vec3f& p : sphere(4000).positions) {
    const Vec3 steps = Vec3(p) * (1000 * kRadius);
    const Vec3 x{std::round(steps.x), std::round(steps.y), std::round(steps.z)};
    las.points.push_back({.x = static_cast<std::int32_t>(x.x),
                          .y = static_cast<std::int32_t>(x.y),
                          .z = static_cast<std::int32_t>(x.z)});
    far.positions.push_back(Vec3f(x * 0.001));
    char line[80];
    const Vec3 world = kCenter + x * 0.001;
    std::snprintf(line, sizeof line, "%.3f %.3f %.3f\n", world.x, world.y, world.z);
    table += line;
  }
  write("far.las", las.bytes());
  write("far.xyz", table);
  write_points(path("far.ply"), far);
  far.origin = {};
  write_points(path("near.ply"), far);
  ASSERT_EQ(run({"reconstruct", "near.ply", "-o", "mesh.ply"}).code, 0);
  TriangleMesh near = read_mesh(path("mesh.ply"));
  near.origin = near.origin + kCenter;
  const double wanted = off_the_ball(near);
  for (const std::string input : {"far.las", "far.xyz", "far.ply"})
    for (const std::string output : {"mesh.ply", "mesh.obj", "mesh.stl", "mesh.off", "mesh.vtp"}) {
      if (input != "far.las" && output != "mesh.ply") continue;  // readers and writers are independent
      ASSERT_EQ(run({"reconstruct", input, "-o", output}).code, 0);
      EXPECT_LT(off_the_ball(read_mesh(path(output))), wanted + 0.002) << input << " to " << output;
    }
  EXPECT_LT(wanted, 0.003 * kRadius);
}

TEST_F(SurveyCommands, AFolderAPatternAndAListAreTheTiles) {
  write_tiles();
  write("notes.txt", "flown in May");
  write("tiles.lst", "# sorted\neast.las\nwest.las\n");
  ASSERT_EQ(run({"convert", "east.las", "west.las", "-o", "named.ply"}).code, 0);
  const std::string named = slurp(path("named.ply"));
  std::filesystem::remove(path("named.ply"));
  std::filesystem::create_directory(path("out"));
  for (const std::string input : {".", "*.las", "tiles.lst"}) {
    ASSERT_EQ(run({"convert", input, "-o", "out/all.ply"}).code, 0) << input;
    EXPECT_EQ(slurp(path("out/all.ply")), named) << input;
  }
  const Outcome none = run({"info", "*.laz"});
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.err.find("*.laz: no file matches the pattern"), std::string::npos) << none.err;
}

TEST_F(SurveyCommands, ReferenceSystemsGoThroughCommands) {
  write_tiles();
  write("east.prj", "EPSG:32633");
  const auto system_of = [&](const std::string& file) {
    const auto reference = read_points(path(file)).reference;
    return reference ? reference->code : 0;
  };
  const Json made = json_of({"reconstruct", "east.las", "-o", "east.ply"});
  EXPECT_EQ(made["input"]["reference_system"], "WGS 84 / UTM zone 33N (EPSG:32633), unit metre");
  EXPECT_EQ(made["input"]["unit"], "metre");
  const std::vector<std::vector<std::string>> commands = {
      {"simplify", "east.ply", "-o", "a.obj"},  {"fill", "east.ply", "-o", "c.glb"},
      {"fit", "east.las", "-o", "d.smf"},       {"mesh", "d.smf", "-o", "e.ply"},
      {"normals", "east.las", "-o", "f.ply"},   {"project", "east.las", "-o", "g.las"},
      {"curvature", "east.las", "-o", "h.csv"}, {"convert", "east.las", "-o", "i.pcd"},
      {"csg", "d.smf", "-o", "j.vtp"},          {"align", "east.ply", "east.las", "-o", "k.ply"}};
  for (const std::vector<std::string>& command : commands) {
    const Outcome outcome = run(command);
    ASSERT_EQ(outcome.code, 0) << command[0] << ": " << outcome.err;
    if (!command.back().ends_with(".smf")) EXPECT_EQ(system_of(command.back()), 32633) << command[0];
  }
  // Moved coordinates are in no system, and others must be in the same.
  const Outcome moved = run({"convert", "east.ply", "--scale", "2", "-o", "moved.ply"});
  EXPECT_EQ(system_of("moved.ply"), 0);
  EXPECT_NE(moved.err.find("moved coordinates are no longer in the reference system"), std::string::npos) << moved.err;
  write("west.prj", "EPSG:32634");
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"compare", "east.ply", "west.las"},
                                             {"assess", "east.ply", "west.las"},
                                             {"align", "east.ply", "west.las", "-o", "x.ply"},
                                             {"project", "east.las", "--onto", "west.las", "-o", "x.ply"},
                                             {"reconstruct", "east.las", "west.las", "-o", "x.ply"}}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 1) << command[0];
    EXPECT_NE(outcome.err.find("EPSG:32633"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("EPSG:32634"), std::string::npos) << outcome.err;
  }
}

TEST_F(SurveyCommands, UnclassifiedTilesHaveGroundAndHeights) {
  std::string rows = "x,y,z\n";
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 60);
  for (int i = 0; i < 6000; ++i) {
    const double x = uniform(random), y = uniform(random);
    const bool house = std::abs(x - 30) < 5 && std::abs(y - 20) < 4;
    char line[80];
    std::snprintf(line, sizeof line, "%.3f,%.3f,%.3f\n", 512000 + x, 5403000 + y, 100 + 0.1 * x + (house ? 6 : 0));
    rows += line;
  }
  write("tile.csv", rows);
  const Json classes = json_of({"convert", "tile.csv", "-o", "tile.las", "--classify-ground"});
  EXPECT_EQ(classes["left_out"], Json::array());
  const Json info = json_of({"info", "tile.las"});
  const double ground = info["classes"]["2"], others = info["classes"]["1"];
  EXPECT_NEAR(others, 6000 * 80 / 3600.0, 30);
  EXPECT_EQ(ground + others, 6000);
  const Outcome outcome = run({"reconstruct", "tile.csv", "--class", "ground", "-o", "terrain.ply"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE((outcome.out + outcome.err).find("found by its shape"), std::string::npos) << outcome.out << outcome.err;

  const Json heights = json_of({"convert", "tile.las", "-o", "dem.tif", "--cell", "2", "--interval", "1", "--contours",
                                "lines.dxf", "--hillshade", "shade.png"});
  EXPECT_EQ(heights["heights"]["columns"], 30);
  EXPECT_EQ(heights["heights"]["rows"], 30);
  EXPECT_EQ(heights["heights"]["unknown"], 0) << "the house is filled";
  EXPECT_NEAR(heights["heights"]["lowest"], 100.1, 0.02);
  EXPECT_NEAR(heights["heights"]["highest"], 105.9, 0.02);
  EXPECT_EQ(heights["contours"]["lines"], 5);
  EXPECT_EQ(slurp(path("dem.tif")).substr(0, 4), std::string("II*\0", 4));
  EXPECT_NE(slurp(path("lines.dxf")).find("CONTOUR_INDEX"), std::string::npos);
  // A mesh has heights, too.
  const Json mesh = json_of({"convert", "terrain.ply", "-o", "mesh.tif", "--cell", "2"});
  EXPECT_NEAR(mesh["heights"]["highest"], 105.9, 0.1);
  EXPECT_EQ(run({"convert", "tile.las", "-o", "a.ply", "--contours", "lines.dxf"}).code, 2);
  EXPECT_EQ(run({"convert", "tile.las", "-o", "a.tif", "--contours", "lines.doc"}).code, 1);
}

/// A terrace of 120 × 120 with a step of 4 at x = 60, as CSV in coordinates of a survey.
std::string terrace_rows() {
  std::string rows = "x,y,z\n";
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 120);
  for (int i = 0; i < 14400; ++i) {
    const double x = uniform(random), y = uniform(random);
    char line[80];
    std::snprintf(line, sizeof line, "%.3f,%.3f,%.3f\n", 512000 + x, 5403000 + y, 100 + 0.05 * y + (x > 60 ? 4 : 0));
    rows += line;
  }
  return rows;
}

TEST_F(SurveyCommands, ReconstructionsHaveHeightsInOneStep) {
  write("tile.csv", terrace_rows());
  const Json made = json_of({"reconstruct", "tile.csv", "-o", "surface.tif", "--contours", "lines.dxf", "--hillshade",
                             "shade.png", "--preview", "mesh.png"}),
             same = json_of({"convert", "tile.csv", "-o", "samples.tif"});
  for (const char* key : {"samples", "cell", "interval"}) EXPECT_EQ(made["heights"][key], same["heights"][key]) << key;
  for (const char* key : {"lowest", "highest"})
    EXPECT_NEAR(made["heights"][key], static_cast<double>(same["heights"][key]), 0.3) << key;
  EXPECT_EQ(made["heights"]["file"], "surface.tif");
  EXPECT_GE(made["contours"]["lines"], 10);
  for (const char* file : {"surface.tif", "lines.dxf", "shade.png", "mesh.png"})
    EXPECT_GT(std::filesystem::file_size(path(file)), 100u) << file;
  // Two steps give the same heights.
  ASSERT_EQ(run({"reconstruct", "tile.csv", "--class", "ground", "-o", "mesh.ply"}).code, 0);
  ASSERT_EQ(run({"convert", "mesh.ply", "-o", "mesh.tif", "--cell", "1"}).code, 0);
  EXPECT_EQ(slurp(path("mesh.tif")), slurp(path("surface.tif")));
  // Its tiles are those of the grid.
  const Json tiles = json_of({"reconstruct", "tile.csv", "-o", "t.tif", "--cell", "1", "--tile-size", "50"});
  const Json split = json_of({"convert", "mesh.ply", "-o", "m.tif", "--cell", "1", "--tile-size", "50"});
  ASSERT_EQ(tiles["heights"]["files"].size(), split["heights"]["files"].size());
  ASSERT_GE(split["heights"]["files"].size(), 9u);
  for (std::size_t k = 0; k < split["heights"]["files"].size(); ++k) {
    const std::string a = tiles["heights"]["files"][k]["file"], b = split["heights"]["files"][k]["file"];
    EXPECT_EQ(a.substr(1), b.substr(1));
    EXPECT_EQ(slurp(path(a)), slurp(path(b))) << a;
  }
  expect_failures({
      {{"reconstruct", "tile.csv", "-o", "a.tif", "--cell", "3", "--tile-size", "50"}, 2, {"--tile-size", "--cell"}},
      {{"reconstruct", "tile.csv", "-o", "a.ply", "--tile-size", "50"}, 2, {"--tile-size", "-o FILE.tif"}},
      {{"reconstruct", "tile.csv", "-o", "a.ply", "--contours", "lines.dxf"}, 2, {"-o FILE.tif"}},
      {{"reconstruct", "tile.csv", "-o", "a.tif", "--ascii"}, 2, {"--ascii"}},
      {{"reconstruct", "tile.csv", "-o", "none/a.tif"}, 1, {"none"}},
  });
}

TEST_F(SurveyCommands, TilesAreNamedByTheirPlace) {
  write("tile.csv", terrace_rows());
  std::filesystem::create_directory(path("out"));
  const Json made = json_of({"convert", "tile.csv", "-o", "out/t.laz", "--tile-size", "50"});
  ASSERT_EQ(made["outputs"].size(), 9u);
  EXPECT_EQ(made["outputs"][0]["file"], "out/t_512000_5403000.laz");
  EXPECT_EQ(made["outputs"][8]["file"], "out/t_512100_5403100.laz");
  EXPECT_EQ(made["parts"]["tile_size"], 50);
  std::size_t points = 0;
  for (const Json& file : made["outputs"]) points += static_cast<std::size_t>(file["points"]);
  EXPECT_EQ(points, 14400u);
  EXPECT_EQ(read_merged({path("out")}).size(), 14400u);
  const Json grid = json_of({"convert", "out", "-o", "out/dem.tif", "--tile-size", "50", "--contours", "lines.vtp"});
  ASSERT_EQ(grid["heights"]["files"].size(), 9u);
  EXPECT_EQ(grid["heights"]["files"][4]["file"], "out/dem_512050_5403050.tif");
  EXPECT_EQ(grid["heights"]["files"][4]["cells"], 2500);
  // Tiles of another size would double the samples of the folder.
  EXPECT_EQ(run({"convert", "tile.csv", "-o", "out/t.laz", "--tile-size", "50"}).err.find("another run"),
            std::string::npos);
  std::filesystem::create_directory(path("mixed"));
  ASSERT_EQ(run({"convert", "tile.csv", "-o", "mixed/t.laz", "--tile-size", "50"}).code, 0);
  const Outcome larger = run({"convert", "tile.csv", "-o", "mixed/t.laz", "--tile-size", "100"});
  EXPECT_EQ(larger.code, 0);
  EXPECT_NE(larger.err.find("another run"), std::string::npos) << larger.err;
  // The ending counts in any case.
  const Json octrees = json_of({"convert", "tile.csv", "-o", "A.COPC.LAZ", "--tile-size", "100"});
  const std::string octree = octrees["outputs"][0]["file"];
  EXPECT_EQ(octree, "A_512000_5403000.COPC.LAZ");
  EXPECT_EQ(json_of({"info", octree})["format"].get<std::string>().substr(0, 4), "COPC");
  // Its own tiles are not overwritten.
  expect_failures({
      {{"convert", "out/t_512000_5403000.laz", "-o", "out/t.laz", "--tile-size", "50"}, 1, {"is an input"}},
      {{"convert", "tile.csv", "-o", "out/a.laz", "--tile-size", "0"}, 2, {"--tile-size"}},
      {{"convert", "tile.csv", "-o", "out/a.laz", "--tile-size", "0.5"}, 1, {"tile.csv", "--tile-size"}},
      {{"convert", "tile.csv", "-o", "out/a.tif", "--tile-size", "50", "--cell", "3"}, 2, {"--tile-size", "--cell"}},
      {{"convert", "tile.csv", "-o", "out/a.laz", "--tile-size", "50", "--split"}, 2, {"--split", "--tile-size"}},
  });
}

TEST_F(SurveyCommands, BreaklinesAreRead) {
  write("tile.csv", terrace_rows());
  write("edge.obj", "v 512060 5402990 104\nv 512060 5403130 110\nl 1 2\n");
  write("empty.obj", "v 0 0 0\n");
  const Json made =
      json_of({"convert", "tile.csv", "-o", "a.tif", "--cell", "1", "--breaklines", "edge.obj", "--contours", "c.csv"});
  EXPECT_EQ(made["heights"]["breaklines"], 1);
  ASSERT_EQ(run({"convert", "tile.csv", "-o", "b.tif", "--cell", "1"}).code, 0);
  EXPECT_NE(slurp(path("a.tif")), slurp(path("b.tif")));
  expect_failures({
      {{"convert", "tile.csv", "-o", "c.tif", "--breaklines", "empty.obj"}, 1, {"empty.obj", "no lines"}},
      {{"convert", "tile.csv", "-o", "c.tif", "--breaklines", "none.dxf"}, 1, {"none.dxf"}},
      {{"convert", "tile.csv", "-o", "c.ply", "--breaklines", "edge.obj"}, 2, {"-o FILE.tif", "--breaklines"}},
      {{"convert", "tile.csv", "-o", "c.tif", "--breaklines", "edge.obj", "--center"}, 2, {"--breaklines", "--center"}},
      {{"convert", "tile.csv", "-o", "c.tif", "--contours", "tile.csv"}, 1, {"tile.csv", "is an input"}},
  });
  ASSERT_EQ(run({"convert", "tile.csv", "-o", "c.tif", "--contours", "lines.vtp"}).code, 0);
  expect_failures({{{"convert", "tile.csv", "-o", "c.tif", "--breaklines", "lines.vtp", "--contours", "lines.vtp"},
                    1,
                    {"lines.vtp", "is an input"}}});
}

TEST_F(SurveyCommands, AllCommandsReadBoxes) {
  write_tiles();
  const std::string box = "1234571,5432000,0,1234700,5432200,1000", nowhere = "0,0,0,1,1,1";
  ASSERT_EQ(run({"convert", "west.las", "east.las", "--class", "2", "-o", "ball.ply"}).code, 0);
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "ball.smf"}).code, 0);
  const std::vector<std::vector<std::string>> commands{{"render", "west.las", "-o", "a.png", "--width", "40"},
                                                       {"assess", "ball.ply", "west.las"},
                                                       {"compare", "ball.ply", "west.las"},
                                                       {"align", "ball.ply", "west.las"},
                                                       {"probe", "ball.smf", "--points", "west.las"}};
  for (std::vector<std::string> command : commands) {
    command.insert(command.end(), {"--read-box", nowhere});
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 1) << command[0];
    EXPECT_NE(outcome.err.find("holds no points in the box"), std::string::npos) << outcome.err;
  }
  const Json part = json_of({"probe", "ball.smf", "--points", "west.las", "--points", "east.las", "--read-box", box});
  const Json all = json_of({"probe", "ball.smf", "--points", "west.las", "--points", "east.las"});
  EXPECT_LT(part["points"], all["points"]);
  expect_failures({
      {{"assess", "ball.ply", "--read-box", box}, 2, {"--read-box"}},
      {{"probe", "ball.smf", "--at", "0,0,0", "--read-box", box}, 2, {"--read-box"}},
      {{"compare", "ball.ply", "ball.smf", "--read-box", box}, 2, {"--read-box", "function"}},
  });
}

}  // namespace
}  // namespace sansmesh::test
