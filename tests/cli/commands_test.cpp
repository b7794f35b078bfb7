#include <algorithm>
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

class Commands : public ToolTest {
 protected:
  void write_sphere(const std::string& name, std::size_t n, bool normals = true) const {
    PointSet cloud = sphere(n);
    if (!normals) cloud.normals.clear();
    write_points(path(name), cloud);
  }
};

TEST_F(Commands, HelpTeaches) {
  for (const char* command : {"reconstruct", "normals", "assess", "info", "render"}) {
    const Outcome all = run({"--help"}), one = run({command, "--help"});
    EXPECT_EQ(all.code, 0);
    EXPECT_NE(all.out.find(command), std::string::npos);
    EXPECT_EQ(one.code, 0);
    EXPECT_NE(one.out.find("--threads"), std::string::npos);
  }
  EXPECT_EQ(run({"--version"}).out.find("sansmesh "), 0u);
  EXPECT_EQ(run({}).code, 2);
}

TEST_F(Commands, ReconstructsTheBundledScan) {
  const Outcome outcome = run({"reconstruct", kOwl, "-o", "owl.ply", "--preview", "owl.png", "--verbose"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("12,442 points"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("s CPU"), std::string::npos) << "--verbose tells the time of each stage";
  const TriangleMesh mesh = read_mesh(path("owl.ply"));
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.genus(), 0);
  EXPECT_EQ(mesh.normals.size(), mesh.vertices.size());
  EXPECT_EQ(slurp(path("owl.png")).substr(1, 3), "PNG");
  EXPECT_EQ(listing(), (std::vector<std::string>{"owl.ply", "owl.png"}));

  const Outcome judged = run({"assess", "owl.ply", kOwl, "--json"});
  ASSERT_EQ(judged.code, 0) << judged.err;
  const Json json = Json::parse(judged.out);
  EXPECT_TRUE(json["topology"]["closed"]);
  EXPECT_LT(json["from_reference"]["mean"].get<double>(), 4e-4 * json["reference"]["diagonal"].get<double>());
  EXPECT_LT(json["quality"]["aspect_mean"].get<double>(), 1.7);
  // Only the base of the closed mesh has no samples.
  EXPECT_EQ(json["coverage"]["lost"]["share"], 0);
  EXPECT_TRUE(json["coverage"]["lost"]["most_around"].is_null());
  EXPECT_EQ(json["coverage"]["lost"]["looked_at"], 12442);
  EXPECT_GT(json["coverage"]["invented"]["share"].get<double>(), 0.03);
  EXPECT_LT(json["coverage"]["invented"]["share"].get<double>(), 0.1);
  EXPECT_EQ(json["coverage"]["invented"]["most_around"].size(), 3u);
  ASSERT_EQ(run({"reconstruct", kOwl, "-o", "open.ply", "--open"}).code, 0);
  const Outcome open = run({"assess", "open.ply", kOwl});
  EXPECT_NE(open.out.find("lost            0.00 % of the samples"), std::string::npos) << open.out;
  EXPECT_NE(open.out.find("invented        0.00 % of the area"), std::string::npos) << open.out;
}

TEST_F(Commands, OutputDoesNotDependOnThreads) {
  SANSMESH_NOT_SANITIZED("the same commands several times");
  std::string first;
  for (const char* threads : {"1", "2", "8"}) {
    const Outcome outcome = run({"reconstruct", kOwl, "-o", "out.ply", "--threads", threads});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::string bytes = slurp(path("out.ply"));
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes, first) << threads << " threads";
  }
}

TEST_F(Commands, JsonIsTextWhateverTheFileIsCalled) {
  write_sphere("\xff.ply", 300);
  EXPECT_EQ(json_of({"info", "\xff.ply"})["points"], 300);
}

TEST_F(Commands, JsonIsAllThatIsPrinted) {
  write_sphere("in.ply", 3000);
  const Outcome outcome = run({"reconstruct", "in.ply", "-o", "out.obj", "--json", "--quality"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["input"]["points"], 3000);
  EXPECT_EQ(json["output"]["triangles"].get<std::size_t>(), read_mesh(path("out.obj")).triangles.size());
  EXPECT_EQ(json["output"]["components"], 1);
  EXPECT_TRUE(json["output"]["closed"]);
  EXPECT_GT(json["aspect_ratio"]["mean_before"].get<double>(), json["aspect_ratio"]["mean"].get<double>());
  EXPECT_GT(json["stages"].size(), 5u);
  EXPECT_NEAR(json["spacing"].get<double>(), std::sqrt(4 * std::numbers::pi / 3000), 0.02);
  EXPECT_EQ(run({"reconstruct", "in.ply", "-o", "out.obj", "--quiet"}).out, "");
}

TEST_F(Commands, DisplacementImprovesTheTrianglesOfTheSources) {
  write_sphere("in.ply", 3000);
  const Outcome outcome =
      run({"reconstruct", "in.ply", "-o", "out.ply", "--no-enhance", "--displacement", "0.9", "--quality", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json aspect = Json::parse(outcome.out)["aspect_ratio"];
  EXPECT_LT(aspect["mean"].get<double>(), aspect["mean_before"].get<double>());
  EXPECT_EQ(run({"reconstruct", "in.ply", "-o", "out.ply", "--displacement", "0.9"}).code, 2);
}

TEST_F(Commands, ThePapersFitIsWalkedAndSaysWhatItDid) {
  write_sphere("in.ply", 3000);
  const Outcome outcome = run({"reconstruct", "in.ply", "-o", "out.ply", "--fit", "paper", "--threshold", "0.0005",
                               "--displacement", "0.9", "--quality", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_TRUE(json["output"]["closed"]);
  EXPECT_GT(json["simplices"].get<int>(), 0);
  EXPECT_EQ(json["paper"]["fitted"].get<int>() + json["paper"]["borrowed"].get<int>(), json["fits"].get<int>());
  EXPECT_LT(json["aspect_ratio"]["mean"].get<double>(), 2);
  EXPECT_GT(json["aspect_ratio"]["mean_before"].get<double>(), 2.2);
  EXPECT_NE(run({"reconstruct", "in.ply", "-o", "out.ply", "--fit", "paper"}).out.find("traversed"), std::string::npos);
  ASSERT_EQ(run({"fit", "in.ply", "-o", "paper.smf", "--fit", "paper", "--coverage", "0.3,0.5,0.7"}).code, 0);
  ASSERT_EQ(run({"mesh", "paper.smf", "-o", "out.ply"}).code, 0);
  EXPECT_EQ(run({"mesh", "paper.smf", "-o", "few.ply", "--mesher", "blocks", "--triangles", "500"}).code, 0);
  // The default function can be walked, too.
  ASSERT_EQ(run({"reconstruct", "in.ply", "-o", "out.ply", "--mesher", "walk"}).code, 0);
}

TEST_F(Commands, OptionsOfAnotherFitAreRefused) {
  write_sphere("in.ply", 500);
  const std::vector<std::vector<std::string>> wrong{{"--fit", "paper", "--error", "0.1"},
                                                    {"--fit", "paper", "--smooth"},
                                                    {"--fit", "paper", "--open"},
                                                    {"--fit", "paper", "--closed"},
                                                    {"--threshold", "0.01"},
                                                    {"--coverage", "paper"},
                                                    {"--fit", "paper", "--triangles", "100"},
                                                    {"--fit", "paper", "--no-enhance"},
                                                    {"--fit", "paper", "--trim"},
                                                    {"--mesher", "walk", "--mesh-error", "0.1"},
                                                    {"--fit", "paper", "--surface", "apss"},
                                                    {"--mesher", "walk", "--surface", "apss"},
                                                    {"--fit", "paper", "--coverage", "1,2"},
                                                    {"--fit", "paper", "--coverage", "all"},
                                                    {"--fit", "paper", "--threshold", "0"}};
  for (const std::vector<std::string>& options : wrong) {
    std::vector<std::string> words{"reconstruct", "in.ply", "-o", "out.ply"};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = run(words);
    EXPECT_NE(outcome.code, 0) << options.back();
    EXPECT_NE(outcome.err.find("--"), std::string::npos) << outcome.err;
    const bool named = std::any_of(options.begin(), options.end(), [&](const std::string& word) {
      return word.starts_with("--") && outcome.err.find(word) != std::string::npos;
    });
    EXPECT_TRUE(named) << outcome.err;
    EXPECT_EQ(outcome.err.find('`'), std::string::npos) << outcome.err;
  }
}

TEST_F(Commands, WritesEveryFormat) {
  write_sphere("in.ply", 2000);
  for (const char* ending : {"ply", "obj", "stl", "off", "ply.gz"}) {
    const std::string file = std::string("out.") + ending;
    ASSERT_EQ(run({"reconstruct", "in.ply", "-o", file}).code, 0) << file;
    EXPECT_GT(read_mesh(path(file)).triangles.size(), 500u) << file;
  }
  ASSERT_EQ(run({"reconstruct", "in.ply", "-o", "out.glb"}).code, 0);
  EXPECT_EQ(slurp(path("out.glb")).substr(0, 4), "glTF");
  ASSERT_EQ(run({"reconstruct", "in.ply", "-o", "text.ply", "--ascii"}).code, 0);
  EXPECT_NE(slurp(path("text.ply")).find("format ascii"), std::string::npos);
}

TEST_F(Commands, ConfidenceIsWrittenAndShown) {
  write_points(path("ball.ply"), sphere(3000));
  ASSERT_EQ(run({"reconstruct", "ball.ply", "-o", "plain.ply"}).code, 0);
  EXPECT_EQ(read_mesh(path("plain.ply")).attributes.find("confidence"), nullptr);
  ASSERT_EQ(run({"reconstruct", "ball.ply", "-o", "marked.ply", "--confidence"}).code, 0);
  const TriangleMesh marked = read_mesh(path("marked.ply"));
  const auto* const confidence = marked.attributes.find<float>("confidence");
  ASSERT_TRUE(confidence);
  for (const float c : *confidence) EXPECT_EQ(c, 1) << "a ball without holes";
  EXPECT_EQ(
      run({"render", "marked.ply", "-o", "marked.png", "--color-by", "confidence", "--width", "64", "--height", "48"})
          .code,
      0);
  const Outcome refused = run({"render", "plain.ply", "-o", "plain.png", "--color-by", "confidence"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("no attribute confidence"), std::string::npos) << refused.err;
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "ball.smf"}).code, 0);
  EXPECT_EQ(
      run({"render", "ball.smf", "-o", "ball.png", "--color-by", "confidence", "--width", "64", "--height", "48"}).code,
      0);
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "lean.smf", "--without-samples"}).code, 0);
  EXPECT_EQ(run({"render", "lean.smf", "-o", "lean.png", "--color-by", "confidence"}).code, 1);
  EXPECT_EQ(run({"mesh", "lean.smf", "-o", "lean.ply", "--confidence"}).code, 1);
}

TEST_F(Commands, TrimOpensWhatHasNoData) {
  PointSet bowl = sphere(6000);
  std::vector<Vec3f> positions, normals;
  for (std::size_t i = 0; i < bowl.size(); ++i)
    if (bowl.positions[i][2] < 0.5f) positions.push_back(bowl.positions[i]), normals.push_back(bowl.normals[i]);
  bowl.positions = positions, bowl.normals = normals;
  write_points(path("bowl.ply"), bowl);
  ASSERT_EQ(run({"reconstruct", "bowl.ply", "-o", "closed.ply"}).code, 0);
  EXPECT_TRUE(measure_topology(read_mesh(path("closed.ply"))).closed());
  ASSERT_EQ(run({"reconstruct", "bowl.ply", "-o", "open.ply", "--trim"}).code, 0);
  const TriangleMesh open = read_mesh(path("open.ply"));
  const MeshTopology topology = measure_topology(open);
  EXPECT_EQ(topology.boundary_loops, 1u);
  EXPECT_TRUE(topology.manifold());
  for (const Vec3f& v : open.vertices) EXPECT_LT(v[2], 0.7f);
}

TEST_F(Commands, ComponentsAreChosen) {
  write_points(path("two.ply"), joined(sphere(4000), sphere(1000), 0.5f, {4, 0, 0}));
  for (const auto& [choice, expected] : {std::pair{"auto", 2u}, {"all", 2u}, {"largest", 1u}, {"1", 1u}, {"2", 2u}}) {
    ASSERT_EQ(run({"reconstruct", "two.ply", "-o", "out.ply", "--components", choice}).code, 0);
    EXPECT_EQ(measure_topology(read_mesh(path("out.ply"))).components, expected) << choice;
  }
}

TEST_F(Commands, NormalsPointOutward) {
  write_sphere("bare.ply", 5000, false);
  const Outcome outcome = run({"normals", "bare.ply", "-o", "with.ply", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out)["unknown"], 0);
  const PointSet cloud = read_points(path("with.ply"));
  ASSERT_EQ(cloud.normals.size(), 5000u);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    ASSERT_GT(dot(cloud.normals[i], normalized(cloud.positions[i])), 0.99f);
  EXPECT_EQ(run({"normals", "bare.ply", "-o", "with.ply", "--orient-only"}).code, 1) << "there are none to keep";
}

TEST_F(Commands, NormalsSayWhereTheirSignsAreUncertain) {
  PointSet noisy = sphere(8000, 0.3);
  noisy.normals.clear();
  write_points(path("noisy.ply"), noisy);
  const Outcome outcome = run({"normals", "noisy.ply", "-o", "out.ply"});
  EXPECT_NE(outcome.out.find("checked: orientation uncertain: "), std::string::npos) << outcome.out;
  const Json json = Json::parse(run({"normals", "noisy.ply", "-o", "out.ply", "--json"}).out);
  EXPECT_FALSE(json["oriented"]);
  EXPECT_FALSE(json["orientation"]["certain"]);
}

TEST_F(Commands, UnorientedNormalsAreTurnedWithAWarning) {
  PointSet cloud = sphere(5000);
  for (std::size_t i = 0; i < cloud.size(); i += 2) cloud.normals[i] = -cloud.normals[i];
  write_points(path("mixed.ply"), cloud);
  const Outcome outcome = run({"reconstruct", "mixed.ply", "-o", "out.ply"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("warning: mixed.ply: "), std::string::npos) << outcome.err;
  EXPECT_EQ(measure_topology(read_mesh(path("out.ply"))).euler, 2);
}

TEST_F(Commands, SayFromWhatSignsOfNormalsWereTaken) {
  // The view of a scanner from inside a ball, which alone would look like the outside.
  PointSet ball = sphere(4000);
  std::string pcd = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH " + std::to_string(ball.size()) +
                    "\nHEIGHT 1\nVIEWPOINT 0.1 0.2 0.3 1 0 0 0\nDATA ascii\n";
  for (const Vec3f& p : ball.positions)
    pcd += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  write("room.pcd", pcd);
  const auto outward = [&](const std::string& file) {
    const PointSet made = read_points(path(file));
    return std::count_if(made.normals.begin(), made.normals.end(), [&](const Vec3f& n) {
      return dot(n, made.positions[static_cast<std::size_t>(&n - made.normals.data())]) > 0;
    });
  };
  const Outcome seen = run({"normals", "room.pcd", "-o", "seen.ply"});
  EXPECT_NE(seen.out.find("oriented by scanner position"), std::string::npos) << seen.out;
  EXPECT_EQ(outward("seen.ply"), 0);
  const Json json =
      Json::parse(run({"normals", "room.pcd", "-o", "blind.ply", "--orient-by", "propagation", "--json"}).out);
  EXPECT_EQ(json["oriented_by"], "propagation");
  EXPECT_EQ(outward("blind.ply"), 4000);
  const Outcome info = run({"info", "room.pcd"});
  EXPECT_NE(info.out.find("none; signs by scanner position"), std::string::npos) << info.out;
  EXPECT_EQ(Json::parse(run({"info", "room.pcd", "--json"}).out)["orient_by"], "scanner");
  const Outcome mesh = run({"reconstruct", "room.pcd", "-o", "room.ply"});
  EXPECT_NE(mesh.out.find("normals estimated, oriented by scanner position"), std::string::npos) << mesh.out;
  write_sphere("in.ply", 3000);
  const Json given = Json::parse(run({"fit", "in.ply", "-o", "in.smf", "--json"}).out);
  EXPECT_FALSE(given["normals"]["estimated"]);
  EXPECT_TRUE(given["normals"]["oriented_by"].is_null());
  expect_failures({
      {{"reconstruct", "in.ply", "-o", "a.ply", "--orient-by", "flight"}, 1, {"in.ply", "scan angles"}},
      {{"normals", "in.ply", "-o", "a.ply", "--orient-by", "rows"}, 1, {"in.ply", "rows and columns"}},
      {{"normals", "in.ply", "-o", "a.ply", "--orient-by", "up", "--no-orient"}, 2, {"--orient-by", "--no-orient"}},
      {{"fit", "in.ply", "-o", "a.smf", "--orient-by", "up", "--normals", "given"},
       2,
       {"--orient-by", "--normals given"}},
  });
}

TEST_F(Commands, FacesOfASoupAreSampled) {
  SANSMESH_NOT_SANITIZED("the samples of faces have tests of their own");
  write("cube.off",
        "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
        "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
  const Outcome outcome = run({"reconstruct", "cube.off", "-o", "out.ply"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("faces are sampled"), std::string::npos) << outcome.err;
  const Json json = Json::parse(run({"assess", "out.ply", "cube.off", "--json"}).out);
  EXPECT_TRUE(json["topology"]["closed"]);
  EXPECT_EQ(json["topology"]["genus"], 0);
  EXPECT_LT(json["to_reference"]["mean"].get<double>(), 2e-4);
  EXPECT_NEAR(json["quality"]["volume"].get<double>(), 1, 2e-3);
}

TEST_F(Commands, InfoDescribes) {
  write_sphere("in.ply", 3000);
  const Outcome outcome = run({"info", "in.ply", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["points"], 3000);
  EXPECT_EQ(json["normals"], "oriented outward");
  EXPECT_NEAR(json["upper"][2].get<double>(), 1, 1e-3);
  EXPECT_EQ(run({"info", "nothing.ply"}).code, 1);
}

TEST_F(Commands, NormalsOfNoSurfaceAreNotCalledOutward) {
  // Points that fill a cube: planes through most of them agree without meaning.
  PointSet filled = sphere(300);
  std::uint32_t next = 1;
  for (Vec3f& p : filled.positions)
    for (std::size_t k = 0; k < 3; ++k) {
      next = next * 1664525u + 1013904223u;
      p[k] = static_cast<float>(next >> 8) / 16777216.0f;
    }
  filled.normals.clear();
  write_points(path("filled.ply"), filled);
  const Outcome outcome = run({"normals", "filled.ply", "-o", "out.ply"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("outward"), std::string::npos) << outcome.out;
}

TEST_F(Commands, AttributesAreToldAndStayWithTheirPoints) {
  PointSet cloud = sphere(3000);
  std::vector<std::uint16_t> id(cloud.size());
  std::vector<double> place;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    id[i] = static_cast<std::uint16_t>(i);
    for (std::size_t k = 0; k < 3; ++k) place.push_back(static_cast<double>(cloud.positions[i][k]));
  }
  cloud.attributes.set("id", id);
  cloud.attributes.set("place", place, 3);
  write_points(path("with.ply"), cloud);
  const Json attributes = Json::parse(run({"info", "with.ply", "--json"}).out)["attributes"];
  ASSERT_EQ(attributes.size(), 2u);
  EXPECT_EQ(attributes[0]["name"], "id");
  EXPECT_EQ(attributes[0]["of"], "point");
  EXPECT_EQ(attributes[0]["type"], "uint16");
  EXPECT_EQ(attributes[0]["lower"], Json::array({0.0}));
  EXPECT_EQ(attributes[0]["upper"], Json::array({2999.0}));
  EXPECT_EQ(attributes[1]["type"], "double");
  EXPECT_EQ(attributes[1]["components"], 3);
  EXPECT_NE(run({"info", "with.ply"}).out.find("id (uint16 a point): 0 to 2999"), std::string::npos);

  // Attributes stay with their points through other formats and a command that moves points.
  ASSERT_EQ(run({"project", "with.ply", "-o", "moved.vtp"}).code, 0);
  const PointSet moved = read_points(path("moved.vtp"));
  const auto& number = *moved.attributes.find<std::uint16_t>("id");
  const auto& before = *moved.attributes.find<double>("place");
  ASSERT_GT(moved.size(), 2900u);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const Vec3 at{before[3 * i], before[3 * i + 1], before[3 * i + 2]};
    ASSERT_EQ(Vec3f(at), cloud.positions[number[i]]);
    ASSERT_LT(norm(moved.origin + Vec3(moved.positions[i]) - at), 0.1);
  }
}

TEST_F(Commands, RenderDraws) {
  write_sphere("in.ply", 3000);
  const Outcome outcome =
      run({"render", "in.ply", "-o", "in.png", "--width", "200", "--height", "100", "--view", "top"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_GT(std::filesystem::file_size(path("in.png")), 1000u);
}

}  // namespace
}  // namespace sansmesh::test
