// Tests of option names in messages: the flags of the command instead of the fields of the library.
#include <iterator>
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

/// Words between blanks.
std::vector<std::string> words_of_line(const std::string& line) {
  std::istringstream in(line);
  return {std::istream_iterator<std::string>(in), {}};
}

/// Options of surfaces: out of range, and of other methods.
const std::vector<std::string> kOfSurfaces = {"--smoothing 99",
                                              "--bandwidth -1",
                                              "--bandwidth 1e9",
                                              "--order 4",
                                              "--iterations 4",
                                              "--diffusion soft",
                                              "--epsilon 0.8",
                                              "--normal iterated",
                                              "--polynomial 3",
                                              "--flow free",
                                              "--diffusion-threshold 2",
                                              "--tau 1",
                                              "--reference-plane nonlinear"};

/// Commands, each with options that it rejects.
const std::pair<const char*, std::vector<std::string>> kMistyped[] = {
    {"reconstruct ball.ply -o x.ply",
     {"--depth 40", "--error -1", "--support 99", "--degree 0", "--mesh-error 0", "--triangles 3", "--trim -3",
      "--displacement 2 --no-enhance", "--components 0"}},
    {"fit ball.ply -o x.smf", {"--depth 1", "--error 1e9"}},
    {"mesh ball.smf -o x.ply", {"--block-depth 15", "--mesh-error nan", "--box 1,1,1,0,0,0"}},
    {"render ball.ply -o x.png",
     {"--width 0", "--antialiasing 9", "--elevation 100", "--azimuth nan", "--point-radius -1",
      "--reflection 2 --surface apss"}},
    {"project ball.ply -o x.ply", {"--most-steps 0", "--tolerance 7"}},
    {"project ball.ply -o x.ply --method lop", {"--radius -1", "--repulsion 0.9"}},
    {"normals ball.ply -o x.ply", {"--neighbours 2", "--reweightings 99"}},
    {"curvature ball.ply -o x.ply", {"--tau 9", "--neighbours 2", "--bandwidth -2"}},
    {"diagnose ball.smf", {"--coverage-below 3", "--error-above -1", "--gradient-above 0"}},
    {"csg sphere(1) -o x.ply", {"--cell -1", "--resolution 1", "--simplify -1", "--box 1,1,1,0,0,0"}},
    {"section ball.smf", {"--resolution 1"}},
    {"compare ball.ply ball.ply", {"--within -1", "--max-distance 0", "--color-range 0"}},
    {"assess ball.ply ball.ply", {"--samples 0"}},
    {"reconstruct ball.ply -o x.ply --surface apss", kOfSurfaces},
    {"render ball.ply -o x.png --surface apss", kOfSurfaces},
    {"render ball.ply -o x.png --surface apss", {"--rays stored"}},
    {"reconstruct ball.ply -o x.ply --surface amls", {"--normal iterated"}},
    {"reconstruct ball.ply -o x.ply --surface partition", {"--sharp", "--no-sheets"}},
    // Options of the fit with another surface.
    {"reconstruct ball.ply -o x.ply --surface apss",
     {"--depth 5", "--error 0.1", "--support 1.3", "--degree 2", "--smooth"}}};

TEST_F(Flags, ErrorsNameWhatWasTyped) {
  SANSMESH_NOT_SANITIZED("dozens of runs that end alike");
  write_points(path("ball.ply"), sphere(300));
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "ball.smf"}).code, 0);
  const std::regex any("--[a-z][a-z-]*");
  for (const auto& [command, mistyped] : kMistyped) {
    const std::vector<std::string> flags = known(words_of_line(command)[0]);
    for (const std::string& options : mistyped) {
      const std::string shown = std::string(command) + " " + options;
      const Outcome outcome = run(words_of_line(shown));
      EXPECT_EQ(outcome.code, 2) << shown << outcome.err;
      EXPECT_NE(outcome.err.find(words_of_line(options)[0]), std::string::npos) << shown << outcome.err;
      EXPECT_EQ(outcome.err.find('`'), std::string::npos) << shown << outcome.err;
      EXPECT_EQ(outcome.err.find('_'), std::string::npos) << "a name of the library: " << shown << outcome.err;
      // Messages name only flags of the command.
      for (std::sregex_iterator i(outcome.err.begin(), outcome.err.end(), any), end; i != end; ++i)
        EXPECT_NE(std::find(flags.begin(), flags.end(), i->str()), flags.end()) << shown << outcome.err;
    }
  }
}

TEST_F(Flags, WarningsNameThemToo) {
  PointSet cloud = sphere(4000);
  const PointSet small = sphere(40);
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
