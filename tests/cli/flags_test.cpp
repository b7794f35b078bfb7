// Tests of option names in messages: the flags of the command instead of the fields of the library.
#include <regex>
#include <sstream>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/model/surface_method.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

class Flags : public ToolTest {
 protected:
  /// Flags in a command's help.
  std::vector<std::string> known(const std::string& command) const {
    const std::string help = run({command, "--help-all"}).out;
    const std::regex flag("--[a-z][a-z-]*");
    std::vector<std::string> names;
    for (std::sregex_iterator i(help.begin(), help.end(), flag), end; i != end; ++i) names.push_back(i->str());
    return names;
  }
};

TEST_F(Flags, ErrorsNameWhatWasTyped) {
  SANSMESH_NOT_SANITIZED("dozens of runs that end alike");
  write_points(path("ball.ply"), sphere(300));
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "ball.smf"}).code, 0);
  struct Mistyped {
    std::vector<std::string> command, typed;
  };
  const std::vector<std::string> reconstruct{"reconstruct", "ball.ply", "-o", "x.ply"},
      fit{"fit", "ball.ply", "-o", "x.smf"}, mesh{"mesh", "ball.smf", "-o", "x.ply"},
      render{"render", "ball.ply", "-o", "x.png"}, project{"project", "ball.ply", "-o", "x.ply"},
      lop{"project", "ball.ply", "-o", "x.ply", "--method", "lop"}, normals{"normals", "ball.ply", "-o", "x.ply"},
      curvature{"curvature", "ball.ply", "-o", "x.ply"}, diagnose{"diagnose", "ball.smf"},
      csg{"csg", "sphere(1)", "-o", "x.ply"}, section{"section", "ball.smf"},
      compare{"compare", "ball.ply", "ball.ply"}, evaluate{"assess", "ball.ply", "ball.ply"};
  std::vector<Mistyped> wrong{{reconstruct, {"--depth", "40"}},
                              {reconstruct, {"--error", "-1"}},
                              {reconstruct, {"--support", "99"}},
                              {reconstruct, {"--degree", "0"}},
                              {reconstruct, {"--mesh-error", "0"}},
                              {reconstruct, {"--triangles", "3"}},
                              {reconstruct, {"--trim", "-3"}},
                              {reconstruct, {"--displacement", "2", "--no-enhance"}},
                              {reconstruct, {"--components", "0"}},
                              {fit, {"--depth", "1"}},
                              {fit, {"--error", "1e9"}},
                              {mesh, {"--block-depth", "15"}},
                              {mesh, {"--mesh-error", "nan"}},
                              {mesh, {"--box", "1,1,1,0,0,0"}},
                              {render, {"--width", "0"}},
                              {render, {"--antialiasing", "9"}},
                              {render, {"--elevation", "100"}},
                              {render, {"--azimuth", "nan"}},
                              {render, {"--point-radius", "-1"}},
                              {render, {"--reflection", "2", "--surface", "apss"}},
                              {project, {"--most-steps", "0"}},
                              {project, {"--tolerance", "7"}},
                              {lop, {"--radius", "-1"}},
                              {lop, {"--repulsion", "0.9"}},
                              {normals, {"--neighbours", "2"}},
                              {normals, {"--reweightings", "99"}},
                              {curvature, {"--tau", "9"}},
                              {curvature, {"--neighbours", "2"}},
                              {curvature, {"--bandwidth", "-2"}},
                              {diagnose, {"--coverage-below", "3"}},
                              {diagnose, {"--error-above", "-1"}},
                              {diagnose, {"--gradient-above", "0"}},
                              {csg, {"--cell", "-1"}},
                              {csg, {"--resolution", "1"}},
                              {csg, {"--simplify", "-1"}},
                              {csg, {"--box", "1,1,1,0,0,0"}},
                              {section, {"--resolution", "1"}},
                              {compare, {"--within", "-1"}},
                              {compare, {"--max-distance", "0"}},
                              {compare, {"--color-range", "0"}},
                              {evaluate, {"--samples", "0"}}};
  // Options of surfaces: out of range, and of other methods.
  for (const std::vector<std::string>& typed :
       {std::vector<std::string>{"--smoothing", "99"}, std::vector<std::string>{"--bandwidth", "-1"},
        std::vector<std::string>{"--bandwidth", "1e9"}, std::vector<std::string>{"--order", "4"},
        std::vector<std::string>{"--iterations", "4"}, std::vector<std::string>{"--diffusion", "soft"},
        std::vector<std::string>{"--epsilon", "0.8"}, std::vector<std::string>{"--normal", "iterated"},
        std::vector<std::string>{"--reference-plane", "nonlinear"}, std::vector<std::string>{"--polynomial", "3"},
        std::vector<std::string>{"--flow", "free"}, std::vector<std::string>{"--diffusion-threshold", "2"},
        std::vector<std::string>{"--tau", "1"}})
    for (std::vector<std::string> command : {reconstruct, render}) {
      command.insert(command.end(), {"--surface", "apss"});
      wrong.push_back({command, typed});
    }
  wrong.push_back({{"render", "ball.ply", "-o", "x.png", "--surface", "apss"}, {"--rays", "stored"}});
  wrong.push_back({{"reconstruct", "ball.ply", "-o", "x.ply", "--surface", "amls"}, {"--normal", "iterated"}});
  for (const char* typed : {"--sharp", "--no-sheets"})
    wrong.push_back({{"reconstruct", "ball.ply", "-o", "x.ply", "--surface", "partition"}, {typed}});
  // Options of the fit with another surface.
  for (const std::vector<std::string>& typed :
       {std::vector<std::string>{"--depth", "5"}, std::vector<std::string>{"--error", "0.1"},
        std::vector<std::string>{"--support", "1.3"}, std::vector<std::string>{"--degree", "2"},
        std::vector<std::string>{"--smooth"}})
    wrong.push_back({{"reconstruct", "ball.ply", "-o", "x.ply", "--surface", "apss"}, typed});

  for (const Mistyped& w : wrong) {
    std::vector<std::string> arguments = w.command;
    arguments.insert(arguments.end(), w.typed.begin(), w.typed.end());
    std::string shown;
    for (const std::string& a : arguments) shown += a + " ";
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << shown << outcome.err;
    const std::string flag = w.typed[0].substr(0, w.typed[0].find('='));
    EXPECT_NE(outcome.err.find(flag), std::string::npos) << shown << outcome.err;
    EXPECT_EQ(outcome.err.find('`'), std::string::npos) << shown << outcome.err;
    EXPECT_EQ(outcome.err.find('_'), std::string::npos) << "a name of the library: " << shown << outcome.err;
    // Messages name only flags of the command.
    const std::vector<std::string> flags = known(w.command[0]);
    const std::regex any("--[a-z][a-z-]*");
    for (std::sregex_iterator i(outcome.err.begin(), outcome.err.end(), any), end; i != end; ++i)
      EXPECT_NE(std::find(flags.begin(), flags.end(), i->str()), flags.end()) << shown << outcome.err;
  }
}

TEST_F(Flags, WarningsNameThemToo) {
  PointSet cloud = sphere(4000);
  const PointSet small = sphere(60);
  for (std::size_t i = 0; i < small.size(); ++i) {
    cloud.positions.push_back(small.positions[i] * 0.05f + Vec3f{3, 0, 0});
    cloud.normals.push_back(small.normals[i]);
  }
  write_points(path("two.ply"), cloud);
  const Outcome outcome = run({"reconstruct", "two.ply", "-o", "x.ply", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("left out (--components all keeps them)"), std::string::npos) << outcome.err;
  const Json warnings = Json::parse(outcome.out)["warnings"];
  ASSERT_FALSE(warnings.empty());
  for (const Json& w : warnings) EXPECT_NE(outcome.err.find(w.get<std::string>()), std::string::npos) << w;
  const Outcome all = run({"reconstruct", "two.ply", "-o", "x.ply", "--components", "all"});
  EXPECT_EQ(all.err.find("left out"), std::string::npos) << all.err;
}

TEST_F(Flags, HelpTellsOfEverySurface) {
  for (const char* command : {"reconstruct", "render", "project"}) {
    std::istringstream words(run({command, "--help"}).out);
    std::string help;
    for (std::string word; words >> word;) help += word + " ";
    for (const SurfaceMethod* const method : SurfaceMethod::registry().all())
      EXPECT_NE(help.find(std::string(method->name) + " " + std::string(method->summary)), std::string::npos)
          << command << ", " << method->name;
  }
  // Names are checked against the same table.
  write_points(path("ball.ply"), sphere(300));
  for (const std::vector<std::string>& line :
       {std::vector<std::string>{"reconstruct", "ball.ply", "-o", "x.ply", "--surface", "marble"},
        std::vector<std::string>{"render", "ball.ply", "-o", "x.png", "--surface", "marble"},
        std::vector<std::string>{"project", "ball.ply", "-o", "x.ply", "--method", "marble"}}) {
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find(SurfaceMethod::registry().names()), std::string::npos) << outcome.err;
  }
}

TEST_F(Flags, ReconstructTellsBothTreesApart) {
  SANSMESH_NOT_SANITIZED("others run the same command");
  write_points(path("ring.ply"), torus(3000));
  const Json fit = json_of({"fit", "ring.ply", "-o", "ring.smf"});
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, std::vector<std::string>{"--mesh-error", "0.02"},
        std::vector<std::string>{"--mesh-error", "0.0005"}}) {
    std::vector<std::string> one{"reconstruct", "ring.ply", "-o", "a.ply"}, two{"mesh", "ring.smf", "-o", "b.ply"};
    one.insert(one.end(), more.begin(), more.end());
    two.insert(two.end(), more.begin(), more.end());
    const Json both = json_of(one), mesh = json_of(two);
    EXPECT_EQ(both["fits"], fit["fits"]);
    EXPECT_EQ(both["fit_depth"], fit["depth"]);
    EXPECT_EQ(both["blocks"], mesh["blocks"]);
    EXPECT_EQ(both["block_depth"], mesh["block_depth"]);
    EXPECT_EQ(slurp(path("a.ply")), slurp(path("b.ply")));
    const std::string line = run(one).out;
    EXPECT_NE(line.find("fits down to depth " + fit["depth"].dump() + ", meshed in "), std::string::npos) << line;
    EXPECT_NE(line.find("blocks down to depth " + mesh["block_depth"].dump() + "\n"), std::string::npos) << line;
  }
  const Json other = json_of({"reconstruct", "ring.ply", "-o", "a.ply", "--surface", "apss"});
  EXPECT_EQ(other["fits"], 0);
  EXPECT_EQ(other["fit_depth"], 0);
  EXPECT_GT(other["block_depth"], 2);
}

}  // namespace
}  // namespace sansmesh::test
