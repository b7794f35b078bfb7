// Tests of extensions by a program (a surface, a volume reconstruction, an integrator, a format, a job with its
// command): they appear in help, schema, reports and results like those of the library.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "support/clouds.h"

namespace sansmesh::test {
namespace {

class Extension : public ToolTest {
 protected:
  const char* program() const override { return extended_tool(); }
  nlohmann::json schema() const { return nlohmann::json::parse(run({"schema"}).out); }
};

const nlohmann::json* named(const nlohmann::json& list, const std::string& name) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const auto& entry) { return entry["name"] == name; });
  return found == list.end() ? nullptr : &*found;
}

const nlohmann::json* option_of(const nlohmann::json& command, const std::string& name) {
  for (const auto& option : command["options"])
    for (const auto& spelled : option["names"])
      if (spelled == name) return &option;
  return nullptr;
}

/// Help without line breaks.
std::string unwrapped(const std::string& help) {
  std::string text;
  for (const char c : help)
    if (c != ' ' && c != '\n')
      text += c;
    else if (!text.ends_with(' '))
      text += ' ';
  return text;
}

TEST_F(Extension, SurfaceIsKnownEverywhere) {
  write_points(path("ball.ply"), sphere(3000));
  for (const char* command : {"reconstruct", "render", "project"}) {
    const std::string help = run({command, "--help"}).out;
    EXPECT_NE(help.find("shepard     tangent planes of the nearest samples"), std::string::npos) << command;
  }
  const nlohmann::json all = schema();
  const nlohmann::json* const surface = named(all["surfaces"], "shepard");
  ASSERT_NE(surface, nullptr);
  EXPECT_EQ((*surface)["uses"], nlohmann::json::array({"sharp", "shepard_neighbours"}));
  const nlohmann::json* const choice = option_of(*named(all["commands"], "reconstruct"), "--surface");
  ASSERT_NE(choice, nullptr);
  EXPECT_EQ((*choice)["choices"].back(), "shepard");

  ASSERT_EQ(run({"reconstruct", "ball.ply", "-o", "mesh.ply", "--surface", "shepard"}).code, 0);
  const TriangleMesh mesh = read_mesh(path("mesh.ply"));
  EXPECT_TRUE(measure_topology(mesh).manifold());
  for (const Vec3f& v : mesh.vertices) EXPECT_NEAR(norm(v), 1, 0.02);
  EXPECT_EQ(json_of({"render", "ball.ply", "-o", "ball.png", "--surface", "shepard", "--sharp", "--width",
                     "80"})["surface"]["method"],
            "shepard");
  EXPECT_EQ(run({"project", "ball.ply", "-o", "feet.ply", "--method", "shepard"}).code, 0);
  const Outcome refused = run({"reconstruct", "ball.ply", "-o", "x.ply", "--surface", "shepard", "--order", "2"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--order belongs to amls, not to the surface shepard"), std::string::npos) << refused.err;
}

TEST_F(Extension, OptionThatASurfaceHasForItselfIsOneOfAllCommandsWithSurfaces) {
  write_points(path("ball.ply"), sphere(2000));
  const nlohmann::json all = schema();
  for (const char* const command : {"reconstruct", "render", "project"}) {
    const nlohmann::json* const option = option_of(*named(all["commands"], command), "--shepard-neighbours");
    ASSERT_NE(option, nullptr) << command;
    EXPECT_EQ((*option)["kind"], "whole");
    EXPECT_EQ((*option)["field"], "shepard_neighbours");
    EXPECT_EQ((*option)["usual"], "10");
    EXPECT_EQ((*option)["range"]["least"], 3);
    EXPECT_EQ((*option)["range"]["most"], 50);
    const std::string help = unwrapped(run({command, "--help-all"}).out);
    EXPECT_NE(help.find("shepard: nearest samples whose planes count, 3..50 [10]"), std::string::npos) << help;
  }
  EXPECT_NE(run({"completion", "bash"}).out.find("--shepard-neighbours"), std::string::npos);

  const std::vector<std::string> command{"reconstruct", "ball.ply", "--surface", "shepard", "-o"};
  const auto mesh_with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = command;
    words.emplace_back("mesh.ply"), words.insert(words.end(), more.begin(), more.end());
    const Outcome made = run(words);
    EXPECT_EQ(made.code, 0) << made.err;
    return read_mesh(path("mesh.ply"));
  };
  const TriangleMesh usual = mesh_with({});
  EXPECT_EQ(mesh_with({"--shepard-neighbours", "10"}).vertices, usual.vertices);
  const TriangleMesh smooth = mesh_with({"--shepard-neighbours", "40"});
  EXPECT_NE(smooth.vertices, usual.vertices);
  for (const Vec3f& v : smooth.vertices) EXPECT_NEAR(norm(v), 1, 0.05);

  const auto refused = [&](const std::vector<std::string>& words) {
    std::vector<std::string> line{"reconstruct", "ball.ply", "-o", "x.ply"};
    line.insert(line.end(), words.begin(), words.end());
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.code, 2);
    return outcome.err;
  };
  EXPECT_NE(refused({"--surface", "shepard", "--shepard-neighbours", "2"})
                .find("--shepard-neighbours must lie in 3..50, not 2"),
            std::string::npos);
  EXPECT_NE(refused({"--surface", "apss", "--shepard-neighbours", "20"})
                .find("--shepard-neighbours belongs to shepard, not to the surface apss"),
            std::string::npos);
  EXPECT_NE(refused({"--shepard-neighbours", "20"}).find("--shepard-neighbours"), std::string::npos);
}

TEST_F(Extension, ReconstructionOfVolumesIsKnownEverywhere) {
  std::string samples = "x,y,z,t\n";
  for (int i = 0; i < 64; ++i)
    samples += std::to_string(i % 4) + "," + std::to_string(i / 4 % 4) + "," + std::to_string(i / 16) + "," +
               std::to_string(i % 4) + "\n";
  write("samples.csv", samples);
  const nlohmann::json found =
      json_of({"volume", "probe", "samples.csv", "--array", "t", "--at", "0.3,1,1", "--method", "mean"});
  EXPECT_EQ(found["values"][0]["value"], 1.5);
  const Outcome refused =
      run({"volume", "probe", "samples.csv", "--array", "t", "--at", "0,0,0", "--method", "mean", "--degree", "2"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--degree means nothing to the reconstruction mean"), std::string::npos) << refused.err;
  const nlohmann::json all = schema();
  const nlohmann::json* const method = named(all["volume_methods"], "mean");
  ASSERT_NE(method, nullptr);
  EXPECT_EQ((*method)["grids"], "all");
  const nlohmann::json* const choice = option_of(*named(all["commands"], "volume probe"), "--method");
  ASSERT_NE(choice, nullptr);
  EXPECT_EQ((*choice)["choices"].back(), "mean");
  EXPECT_NE(run({"volume", "probe", "--help-all"}).out.find("mls-detail, amls, mean"), std::string::npos);
}

TEST_F(Extension, IntegratorIsKnownEverywhere) {
  const nlohmann::json all = schema();
  const nlohmann::json* const integrator = named(all["flow_integrators"], "heun");
  ASSERT_NE(integrator, nullptr);
  EXPECT_EQ((*integrator)["order"], 2);
  EXPECT_EQ((*integrator)["adaptive"], false);
  for (const char* const command : {"flow lines", "flow surface", "flow render"}) {
    const nlohmann::json* const choice = option_of(*named(all["commands"], command), "--integrator");
    ASSERT_NE(choice, nullptr) << command;
    EXPECT_EQ((*choice)["choices"], nlohmann::json::array({"euler", "rk4", "dopri5", "heun"}));
  }
  const std::string help = unwrapped(run({"flow", "lines", "--help-all"}).out);
  EXPECT_NE(help.find("heun (Heun's, second order)"), std::string::npos) << help;
  EXPECT_NE(help.find("Of euler, rk4, heun, and at most of dopri5"), std::string::npos) << help;

  // Trajectories of the rotation are circles; Heun's method approximates them, and better with shorter steps.
  const auto farthest = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command{"flow",       "lines", "rotation", "--seeds", "point(1,0,0)",
                                     "--duration", "6",     "-o",       "turn.csv"};
    command.insert(command.end(), more.begin(), more.end());
    EXPECT_EQ(run(command).code, 0);
    const PointSet line = read_points(path("turn.csv"));
    EXPECT_GT(line.size(), 20u);
    double most = 0;
    for (const Vec3f& p : line.positions) most = std::max(most, std::abs(norm(line.origin + Vec3(p)) - 1));
    return most;
  };
  const double coarse = farthest({"--integrator", "heun", "--step-length", "0.2"}),
               fine = farthest({"--integrator", "heun", "--step-length", "0.1"});
  EXPECT_LT(coarse, 0.01);
  EXPECT_NEAR(coarse / fine, 8, 1);  // radii have one order more than positions
  EXPECT_LT(farthest({"--integrator", "heun"}), 1e-4);
  EXPECT_GT(farthest({"--integrator", "euler", "--step-length", "0.1"}), 0.1);

  const Outcome refused = run({"flow", "lines", "rotation", "-o", "x.csv", "--integrator", "heum"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("euler, rk4, dopri5, heun"), std::string::npos) << refused.err;
}

TEST_F(Extension, FormatIsReadAndWritten) {
  const PointSet ball = sphere(500);
  write_points(path("ball.ply"), ball);
  ASSERT_EQ(run({"convert", "ball.ply", "-o", "ball.triples"}).code, 0);
  EXPECT_EQ(json_of({"info", "ball.triples"})["format"], "triples");
  ASSERT_EQ(run({"convert", "ball.triples", "-o", "again.xyz"}).code, 0);
  const PointSet again = read_points(path("again.xyz"));
  ASSERT_EQ(again.size(), ball.size());
  for (std::size_t i = 0; i < ball.size(); ++i)
    EXPECT_NEAR(norm(again.origin + Vec3(again.positions[i]) - Vec3(ball.positions[i])), 0, 1e-5);
  // Detection by content, with any name.
  std::filesystem::rename(path("ball.triples"), path("ball.unheard"));
  EXPECT_EQ(run({"info", "ball.unheard"}).code, 0);
  write("torn.triples", "triples\npoint 1 2\n");
  const Outcome torn = run({"info", "torn.triples"});
  EXPECT_EQ(torn.code, 1);
  EXPECT_NE(torn.err.find("torn.triples: a line is not 'point X Y Z'"), std::string::npos) << torn.err;

  const nlohmann::json all = schema();
  const nlohmann::json* const format = named(all["formats"], "triples");
  ASSERT_NE(format, nullptr);
  EXPECT_EQ((*format)["reads"], nlohmann::json::array({"points"}));
}

TEST_F(Extension, JobHasACommand) {
  write("two.xyz", "0 0 0\n1 0 0\n");
  EXPECT_NE(run({"help"}).out.find("\n  shift "), std::string::npos);
  EXPECT_NE(run({"shift", "--help"}).out.find("--axis NAME"), std::string::npos);
  const nlohmann::json all = schema();
  const nlohmann::json* const command = named(all["commands"], "shift");
  ASSERT_NE(command, nullptr);
  const nlohmann::json* const axis = option_of(*command, "--axis");
  ASSERT_NE(axis, nullptr);
  EXPECT_EQ((*axis)["choices"], nlohmann::json::array({"x", "y", "z"}));
  EXPECT_EQ((*axis)["usual"], "z");

  EXPECT_EQ(json_of({"shift", "two.xyz", "-o", "moved.xyz", "--distance", "2.5", "--axis", "y"})["output"]["points"],
            2);
  const PointSet moved = read_points(path("moved.xyz"));
  EXPECT_NEAR(moved.origin.y + static_cast<double>(moved.positions[0].y), 2.5, 1e-6);
  const Outcome far = run({"shift", "two.xyz", "-o", "far.xyz", "--distance", "1e9"});
  EXPECT_EQ(far.code, 2);
  EXPECT_NE(far.err.find("--distance must lie in -1000000..1000000, not 1e9"), std::string::npos) << far.err;
}

}  // namespace
}  // namespace sansmesh::test
