// Tests of messages about mistyped command lines: the option as typed, its value, and suggestions.
#include <fmt/core.h>

#include <cmath>
#include <map>
#include <regex>
#include <set>

#include "ball_volume.h"
#include "run_tool.h"
#include "sansmesh/io.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

using Words = std::vector<std::string>;

Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::string spaced(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += " " + word;
  return text;
}

/// An option in the help of a command.
struct HelpEntry {
  std::string flag, value, what;
};

class CommandLineTool : public ToolTest {
 protected:
  /// Names under the heading Commands of a help.
  static Words commands_of(const std::string& help) {
    Words names;
    std::istringstream lines(help.substr(std::min(help.find("\nCommands:\n"), help.size())));
    std::string line;
    std::getline(lines, line), std::getline(lines, line);
    const std::regex entry("^  ([a-z]+) .*");
    std::smatch found;
    while (std::getline(lines, line) && !line.empty())
      if (std::regex_match(line, found, entry)) names.push_back(found[1]);
    return names;
  }
  /// All commands without subcommands, {"volume", "probe"}, with their help.
  std::map<Words, std::string> commands() const {
    std::map<Words, std::string> all;
    std::vector<Words> to_do{{}};
    while (!to_do.empty()) {
      const Words command = to_do.back();
      to_do.pop_back();
      const std::string help = run(Words{"help"} + command + Words{"--all"}).out;
      const Words further = commands_of(help);
      for (const std::string& name : further) to_do.push_back(command + Words{name});
      if (further.empty()) all[command] = help;
    }
    for (const char* told : {"help", "completion", "manual", "schema"}) all.erase({told});
    return all;
  }
  static std::vector<HelpEntry> options_of(const std::string& help) {
    std::vector<HelpEntry> options;
    const std::regex entry("^  (?:-[a-z], )?(--[a-z-]+)(?: (\\S+(?: \\[N N\\])?))?(?:  +(.*))?$"), more("^ {28}(.*)$");
    std::istringstream lines(help);
    std::string line;
    std::smatch found;
    bool within = false;
    while (std::getline(lines, line))
      if (std::regex_match(line, found, entry))
        options.push_back({found[1], found[2], found[3]}), within = true;
      else if (within && std::regex_match(line, found, more))
        options.back().what += (options.back().what.empty() ? "" : " ") + found[1].str();
      else
        within = false;
    return options;
  }
  void expect_line(const Words& arguments, const std::string& line, int code = 2) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, code) << spaced(arguments);
    EXPECT_EQ(outcome.err, "sansmesh: " + line + "\n") << spaced(arguments);
    EXPECT_EQ(outcome.out, "") << spaced(arguments);
  }
};

TEST_F(CommandLineTool, ErrorsNameTheOptionAsItWasTyped) {
  write_points(path("ball.ply"), sphere(100));
  const Words reconstruct{"reconstruct", "ball.ply", "-o", "x.ply"};
  const std::string more = " (see sansmesh help reconstruct)";
  expect_line(reconstruct + Words{"--depth", "99"}, "--depth must lie in 2..14, not 99" + more);
  expect_line(reconstruct + Words{"--depth=deep"}, "--depth: 'deep' is not a number" + more);
  expect_line(reconstruct + Words{"--depth", "3.5"}, "--depth: '3.5' is not a whole number" + more);
  expect_line(reconstruct + Words{"--triangles", "-4"}, "--triangles must be 4 or more, not -4" + more);
  expect_line(reconstruct + Words{"--mesh-error", "0"}, "--mesh-error must be above 0, not 0" + more);
  expect_line(reconstruct + Words{"--trim=ball.ply"}, "--trim: 'ball.ply' is not a number" + more);
  expect_line(reconstruct + Words{"--faces", "vertex"},
              "--faces must be one of auto, ignore, sample, vertices, not 'vertex'" + more);
  expect_line(reconstruct + Words{"--depth"}, "--depth needs a value (LEVEL)" + more);
  expect_line(reconstruct + Words{"--depth", "--ascii"}, "--depth needs a value (LEVEL) before --ascii" + more);
  expect_line(reconstruct + Words{"--ascii=yes"}, "--ascii takes no value, not 'yes'" + more);
  expect_line(reconstruct + Words{"--output", "y.ply"}, "--output is given twice" + more);
  expect_line({"reconstruct", "ball.ply", "-o"}, "-o needs a value (FILE)" + more);
  expect_line({"reconstruct", "ball.ply", "--ascii"}, "reconstruct needs --output FILE" + more);
  expect_line({"section", "ball.ply", "--plane", "w=1"},
              "--plane must be like z=0.5 or nx,ny,nz,d with finite numbers, not 'w=1' (see sansmesh help section)");
  expect_line({"mesh", "a.smf", "b.smf", "-o", "x.ply"},
              "'b.smf' is left over: mesh takes one input (see sansmesh help mesh)");
  expect_line({"probe", "a.smf", "--at", "1,2"},
              "--at needs 3 comma-separated numbers, not '1,2' (see sansmesh help probe)");
  expect_line({"probe", "a.smf", "1,2,3"},
              "'1,2,3' is left over: probe takes one input (did you mean --at 1,2,3?) (see sansmesh help probe)");
  expect_line({"probe", "a.smf", "--at", "1mm,2,3"},
              "--at: '1mm,2,3' is not a number: write plain numbers, in the unit of the input "
              "(see sansmesh help probe)");
  expect_line(reconstruct + Words{"--trim", "5mm"},
              "--trim: '5mm' is not a number: write a plain number, in the unit of the input" + more);
  expect_line(reconstruct + Words{"--width=5px"},
              "--width: '5px' is not a number: write a plain number, in pixels" + more);
  expect_line(reconstruct + Words{"--triangles", "1,000,000"},
              "--triangles: '1,000,000' is not a number: write 1000000" + more);
  expect_line(reconstruct + Words{"--triangles", "1,00"}, "--triangles: '1,00' is not a number" + more);
  // Without a value, before the input: the file name is not read as a length.
  EXPECT_EQ(run({"reconstruct", "--trim", "ball.ply", "-o", "x.ply"}).code, 0);
  EXPECT_EQ(run({"reconstruct", "--trim", "0.5", "ball.ply", "-ox.ply"}).code, 0);
}

// Every option of every command with values that are no numbers or out of the range in the help.
TEST_F(CommandLineTool, EveryOptionOfTheTableSaysWhatIsWrongWithItsValue) {
  SANSMESH_NOT_SANITIZED("hundreds of runs that end alike");
  // Placeholders of values that are no texts.
  const std::set<std::string> checked{
      "LENGTH",   "COUNT",  "RATIO", "LEVEL",   "DEGREE",   "DEGREES", "PIXELS", "NUMBER", "FACTOR", "SHARE",
      "DURATION", "TIME",   "SPEED", "SECONDS", "EXPONENT", "GIB",     "POINT",  "X,Y,Z",  "BOX",    "ORDER",
      "NORM",     "CHOICE", "TYPE",  "LENGTHS", "N/M",      "PA",      "HOW",    "AXIS",   "SHELL",  "NXxNYxNZ"};
  std::set<std::string> known;
  std::size_t numbers = 0, ranges = 0;
  const std::regex range(", (-?[0-9.]*[0-9])\\.\\.(-?[0-9.]*[0-9])(?= [\\[(]|: |$)");
  for (const auto& [command, help] : commands()) {
    const std::vector<HelpEntry> options = options_of(help);
    ASSERT_GT(options.size(), 3u) << spaced(command) << "\n" << help;
    for (const HelpEntry& o : options) {
      if (o.value.empty()) continue;
      const bool optional = o.value[0] == '[';
      const std::string value_name = optional ? o.value.substr(1, o.value.size() - 2) : o.value;
      if (!known.insert(o.flag + o.what).second) continue;  // options shared by several commands are checked once
      const auto complains = [&, &command = command](const std::string& value, const std::string& part) {
        const Outcome outcome = run(command + Words{"--quiet", o.flag + "=" + value, "absent"});
        EXPECT_EQ(outcome.code, 2) << spaced(command) << " " << o.flag << "=" << value << "\n" << outcome.err;
        EXPECT_EQ(outcome.lines_of_error(), 1) << outcome.err;
        EXPECT_EQ(outcome.err.find("sansmesh: " + o.flag), 0u) << o.flag << "=" << value << "\n" << outcome.err;
        EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
        return 1;
      };
      if (!optional && known.size() % 8 == 0) {
        const Outcome outcome = run(command + Words{"absent", o.flag});
        EXPECT_EQ(outcome.err.find("sansmesh: " + o.flag + " needs a value (" + o.value), 0u) << outcome.err;
      }
      if (checked.count(value_name) > 0) numbers += complains("wro?ng", "wro?ng");
      std::smatch ends;
      if (!std::regex_search(o.what, ends, range) || o.what.find("..") != o.what.rfind("..")) continue;
      for (const double outside : {std::stod(ends[1]) - 1, std::stod(ends[2]) + 1}) {
        const std::string value = fmt::format("{}", outside);
        ranges += complains(value, "must lie in " + ends[1].str() + ".." + ends[2].str() + ", not " + value);
      }
    }
  }
  EXPECT_GT(numbers, 80u);
  EXPECT_GT(ranges, 40u);
}

TEST_F(CommandLineTool, SaysWhatMayHaveBeenMeant) {
  write_points(path("scan.ply"), sphere(100));
  write("scan.smf", "");
  expect_line({"reconstrcut", "scan.ply"},
              "unknown command 'reconstrcut' (did you mean reconstruct?) (see sansmesh help)");
  expect_line({"resample", "scan.ply"},
              "unknown command 'resample' (did you mean volume resample?) (see sansmesh help)");
  expect_line({"volume", "reasmple"},
              "unknown command 'reasmple' of volume (did you mean resample?) (see sansmesh help volume)");
  expect_line({"scan.ply"},
              "unknown command 'scan.ply': a command comes first, as in sansmesh info scan.ply (see sansmesh help)");
  expect_line({"info", "scan.ply", "--jsn"}, "unknown option --jsn (did you mean --json?) (see sansmesh help info)");
  expect_line({"reconstruct", "scan.ply", "-output", "x.ply"},
              "unknown option -output (did you mean --output?) (see sansmesh help reconstruct)");
  expect_line({"mesh", "x.smf", "-o", "x.ply", "--mesh_error", "1"},
              "unknown option --mesh_error (did you mean --mesh-error?) (see sansmesh help mesh)");
  expect_line({"advise", "scan.ply", "--neighbours", "5"},
              "unknown option --neighbours (it is an option of normals and curvature) (see sansmesh help advise)");
  expect_line(
      {"reconstruct", "scan.ply", "-o", "x.ply", "--normals", "estimated"},
      "--normals must be one of auto, given, estimate, not 'estimated' (did you mean estimate?) (see sansmesh help "
      "reconstruct)");
  expect_line({"render", "scan.ply", "-o", "x.png", "--view", "tpo"},
              "--view must be one of front, back, left, right, top, bottom, iso, not 'tpo' (did you mean top?) (see "
              "sansmesh help render)");
  expect_line({"info", "scna.ply"}, "scna.ply: no such file (did you mean 'scan.ply'?)", 1);
  expect_line({"info", "scan.pyl"}, "scan.pyl: no such file (did you mean 'scan.ply'?)", 1);
  expect_line({"info", "elsewhere.las"}, "elsewhere.las: no such file", 1);
  const std::string more = " (see sansmesh help reconstruct)", known = "unknown option ";
  expect_line({"version"}, "unknown command 'version' (did you mean --version?) (see sansmesh help)");
  expect_line({"reconstruct", "scan.ply", "-o", "x.ply", "—depth", "5"},
              known + "—depth (did you mean --depth?)" + more);
  expect_line({"reconstruct", "scan.ply", "-o", "x.ply", "-q"},
              known + "-q (did you mean --quality or --quiet?)" + more);
  expect_line({"reconstruct", "scan.ply", "x.ply"}, "reconstruct needs --output FILE (did you mean -o x.ply?)" + more);
  expect_line({"reconstruct", "scan.ply", "-o", "x.ply", "--open", "--closed"},
              "--open and --closed exclude each other" + more);
  expect_line({"--threads", "info", "scan.ply"}, "--threads: 'info' is not a number (see sansmesh help)");
  expect_line({"reconstruct", "scan.ply", "-o", "x.ply", "depth=5"}, "depth=5: no such file (did you mean --depth=5?)",
              1);
  for (const std::vector<std::string>& line : std::vector<std::vector<std::string>>{
           {"csg", "spere(1)", "-o", "x.ply", "sphere?"},
           {"csg", "scan.sfm - box(1)", "-o", "x.ply", "scan.smf"},
           {"reconstruct", "scan.ply", "-o", "x.ply", "--class", "gruond", "ground?"},
           {"flow", "lines", "rotaton", "-o", "x.ply", "rotation?"},
           {"flow", "lines", "rotation", "--seeds", "pont(1,0,0)", "-o", "x.ply", "point?"},
           {"edit", "scan.smf", "--script", "scan.jsn", "-o", "x.smf", "scan.jsn: no such file"}}) {
    const Outcome outcome = run({line.begin(), line.end() - 1});
    EXPECT_NE(outcome.code, 0);
    EXPECT_EQ(outcome.lines_of_error(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(line.back()), std::string::npos) << outcome.err;
  }
  std::filesystem::create_directory(path("scans"));
  expect_line({"info", "scnas/scan.ply"}, "scnas/scan.ply: no such file (did you mean 'scans'?)", 1);
}

/// Former names of options and commands are accepted with a warning.
TEST_F(CommandLineTool, OldNamesAreUnderstood) {
  write_points(path("scan.ply"), sphere(100));
  for (const auto& [line, now] : std::vector<std::pair<Words, std::string>>{
           {{"normals", "scan.ply", "-o", "a.ply", "--keep"}, "--keep is now called --orient-only"},
           {{"evaluate", "scan.ply"}, "evaluate is now called assess"},
           {{"flow", "lines", "rotation", "-o", "l.csv", "--seeds", "point(0.5,0,0)", "--time", "1"},
            "--time is now called --duration"}}) {
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE((outcome.out + outcome.err).find(now), std::string::npos) << outcome.out << outcome.err;
  }
}

/// No former name of the previous version has a new meaning.
TEST_F(CommandLineTool, OldNamesMeanNothingElse) {
  const auto schema = nlohmann::json::parse(run({"schema"}).out);
  std::size_t old_names = 0;
  for (const auto& command : schema["commands"]) {
    const std::string name = command["name"];
    std::multiset<std::string> understood;
    Words words, old;
    std::istringstream parts(name);
    for (std::string word; parts >> word;) words.push_back(word);
    for (const auto& option : command["options"]) {
      for (const auto& one : option["names"]) understood.insert(one);
      if (!option.contains("old_names")) continue;
      for (const auto& one : option["old_names"]) understood.insert(one), old.push_back(one);
    }
    for (const std::string& one : understood) EXPECT_EQ(understood.count(one), 1u) << name << " " << one;
    old_names += old.size();
    if (old.empty()) continue;
    // All former names together: an unknown name is reported before a wrong value.
    for (const std::string& one : old) words.push_back(one + "=1");
    EXPECT_EQ(run(words).err.find("unknown option"), std::string::npos) << name << run(words).err;
  }
  EXPECT_GT(old_names, 40u);
  for (const auto& [line, now] : std::vector<std::pair<Words, std::string>>{
           {{"convert", "scan.ply", "-o", "a.ply", "--crop", "-9,-9,-9,9,9,9"}, "--crop is now called --box"},
           {{"convert", "scan.ply", "-o", "a.ply", "--count=3"}, "--count is now called --point-count"},
           {{"flow", "render", "rotation", "-o", "l.png", "--seeds", "line(0.2,0,0, 1,0,0, 9)", "--duration", "0.1",
             "--width", "40", "--height", "30", "--no-bar", "--smooth"},
            "--smooth is now called --no-streaks"}}) {
    write_points(path("scan.ply"), sphere(100));
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find(now), std::string::npos) << outcome.err;
  }
}

/// With --json an error is printed as data, too.
TEST_F(CommandLineTool, ErrorsAreDataWhereTheyAreWanted) {
  write_points(path("scan.ply"), sphere(100));
  const auto error_of = [&](const Words& line, int code) {
    const Outcome outcome = run(line + Words{"--json"});
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_EQ(outcome.lines_of_error(), 1) << outcome.err;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json["schema"], 1);
    EXPECT_EQ(json["error"]["exit_code"], code);
    EXPECT_EQ("sansmesh: " + json["error"]["text"].get<std::string>() + "\n", outcome.err);
    return json["error"];
  };
  const auto missing = error_of({"info", "none.ply"}, 1);
  EXPECT_EQ(missing["kind"], "file");
  EXPECT_EQ(missing["file"], "none.ply");
  const auto wrong = error_of({"reconstruct", "scan.ply", "-o", "x.ply", "--surface", "apss", "--order", "2"}, 2);
  EXPECT_EQ(wrong["kind"], "argument");
  EXPECT_EQ(json_of({"info", "scan.ply"})["schema"], 1);
}

TEST_F(CommandLineTool, HelpIsAskedForInEveryWay) {
  const std::string help = run({"volume", "probe", "--help"}).out;
  EXPECT_NE(help.find("Usage: sansmesh volume probe data... [OPTIONS]\n"), std::string::npos) << help;
  EXPECT_EQ(run({"help", "volume", "probe"}).out, help);
  EXPECT_EQ(run({"volume", "probe", "-h"}).out, help);
  EXPECT_EQ(run({"--help", "volume", "probe"}).out, help);
  EXPECT_EQ(run({"volume", "probe", "x.vti", "--no-such-option", "--help"}).out, help);
  EXPECT_EQ(run({"help"}).out, run({"--help"}).out);
  const std::string all = run({"volume", "probe", "--help-all"}).out;
  EXPECT_EQ(run({"help", "volume", "probe", "--all"}).out, all);
  EXPECT_NE(all.find("\nReconstruction:\n"), std::string::npos) << all;
  // The short help names advanced options and the command that shows them.
  EXPECT_NE(all.find("\n  --iterations COUNT "), std::string::npos) << all;
  EXPECT_EQ(help.find("\n  --iterations COUNT "), std::string::npos) << help;
  EXPECT_NE(help.find("\n  reconstruction "), std::string::npos) << help;
  EXPECT_NE(help.find(" --iterations "), std::string::npos) << help;
  const std::string group = run({"help", "volume", "probe", "reconstruction"}).out;
  EXPECT_TRUE(group.starts_with("Reconstruction:\n")) << group;
  EXPECT_NE(all.find(group), std::string::npos) << group;
  expect_line({"help", "volume", "prob"},
              "unknown command 'prob' of volume (did you mean probe?) (see sansmesh help volume)");
  expect_line({"help", "mesh", "it"}, "mesh has no commands, so 'it' is unknown (see sansmesh help mesh)");
  expect_line({"help", "mesh", "--json"}, "--json means nothing to help (see sansmesh help help)");
  std::istringstream lines(run({"help", "reconstruct"}).out);
  for (std::string line; std::getline(lines, line) && line.find("Reads") != 0;) EXPECT_LE(line.size(), 120u) << line;
}

/// The short help shows at most twenty options and the common ones; views and published variants are separate.
TEST_F(CommandLineTool, HelpShowsWhatPeopleUseFirst) {
  SANSMESH_NOT_SANITIZED("runs that end alike");
  const auto schema = nlohmann::json::parse(run({"schema"}).out);
  const std::size_t common = schema["common"].size() - 1;  // without --version
  for (const auto& [command, all] : commands()) {
    const std::string help = run(command + Words{"--help"}).out;
    const std::size_t shown = options_of(help.substr(0, help.find("\nMore options"))).size();
    EXPECT_LE(shown, 20 + common) << spaced(command) << help;
    EXPECT_GE(options_of(all).size(), shown) << spaced(command);
    EXPECT_EQ(help.find("\n  --azimuth"), std::string::npos) << spaced(command);
    if (all.find("\n  --azimuth") != std::string::npos)
      EXPECT_NE(help.find("sansmesh help view"), std::string::npos) << help;
  }
  const std::string view = run({"help", "view"}).out;
  EXPECT_NE(view.find("\nView:\n"), std::string::npos) << view;
  EXPECT_NE(view.find("\n  --azimuth DEGREES"), std::string::npos) << view;
  const std::string sources = run({"help", "reconstruct", "as-in-the-sources"}).out;
  EXPECT_NE(sources.find("\n  --mesher "), std::string::npos) << sources;
  EXPECT_NE(sources.find("\n  --tau "), std::string::npos) << sources;
  // The level depends on the command: --array is basic for flows and advanced for simulations.
  const auto level = [&](const std::string& name, const std::string& flag) -> std::string {
    for (const auto& command : schema["commands"])
      for (const auto& option : command["options"])
        if (command["name"] == name && option["names"].back() == flag) return option["level"];
    return "";
  };
  EXPECT_EQ(level("flow lines", "--array"), "basic");
  EXPECT_EQ(level("simulate", "--array"), "advanced");
}

TEST_F(CommandLineTool, ACommandAloneTeaches) {
  SANSMESH_NOT_SANITIZED("runs that end alike");
  for (const auto& [command, help] : commands()) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 2) << spaced(command);
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find("\nUsage: sansmesh" + spaced(command) + " "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("\nMore: sansmesh help" + spaced(command) + "\n"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("\nFor example:\n  sansmesh"), std::string::npos) << spaced(command) << "\n"
                                                                                 << outcome.err;
    EXPECT_LT(outcome.lines_of_error(), 16) << outcome.err;
  }
  EXPECT_NE(run({"volume"}).err.find("\n  probe "), std::string::npos);
}

TEST_F(CommandLineTool, OptionsOfTheToolStandAnywhere) {
  write_points(path("scan.ply"), sphere(100));
  const std::string json = run({"info", "scan.ply", "--json"}).out;
  EXPECT_EQ(nlohmann::json::parse(json)["points"], 100);
  EXPECT_EQ(run({"--json", "info", "scan.ply"}).out, json);
  EXPECT_EQ(run({"--threads", "2", "--json", "info", "scan.ply"}).out, json);
  EXPECT_EQ(run({"--quiet", "info", "scan.ply"}).out, "");
  const Outcome nested = run({"volume", "--threads=1", "probe", "absent.vti", "--at", "0,0,0"});
  EXPECT_NE(nested.err.find("absent.vti"), std::string::npos) << nested.err;
  expect_line({"--threads", "none", "info", "scan.ply"}, "--threads: 'none' is not a number (see sansmesh help)");
  expect_line(
      {"--depth", "4", "reconstruct", "scan.ply", "-o", "x.ply"},
      "unknown option --depth here: options of a command come after it (it is an option of reconstruct, render, "
      "project and others) "
      "(see sansmesh help)");
}

// New commands need a line here.
TEST_F(CommandLineTool, TheJsonOfEveryCommandHasItsWarnings) {
  SANSMESH_NOT_SANITIZED("others run every command");
  PointSet cloud = sphere(300);
  write_points(path("ball.ply"), cloud);
  cloud.positions[7].x = std::nanf("");
  write_points(path("gap.ply"), cloud);  // one of its samples is dropped with a warning
  write(kBallFile, ball_bytes());
  write("pull.json", R"({"handles": [{"p": [1, 0, 0], "q": [1.2, 0, 0]}, {"p": [-1, 0, 0]}, {"p": [0, 1, 0]}]})");
  write("edits.json",
        R"({"version": 1, "steps": [{"select": {"ball": {"center": [0, 0, 1], "radius": 0.3}}, "degree": 1}]})");
  write("bar.mesh",
        "MeshVersionFormatted 1\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra 1\n1 2 3 4 "
        "0\nEnd\n");
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "ball.smf"}).code, 0);
  ASSERT_EQ(run({"mesh", "ball.smf", "-o", "mesh.ply"}).code, 0);
  const std::string ball = kBallFile, circle = "circle(0.5,0,0, 0,0,1, 0.2, 8)";
  const Words small{"--width", "40", "--height", "30"};
  const std::map<Words, Words> rest{
      {{"reconstruct"}, {"gap.ply", "-o", "x.ply"}},
      {{"convert"}, {"gap.ply", "-o", "x.ply"}},
      {{"normals"}, {"gap.ply", "-o", "x.ply"}},
      {{"assess"}, {"gap.ply", "--samples", "100"}},
      {{"info"}, {"gap.ply"}},
      {{"render"}, Words{"gap.ply", "-o", "x.png"} + small},
      {{"project"}, {"gap.ply", "-o", "x.ply"}},
      {{"curvature"}, {"gap.ply", "-o", "x.ply"}},
      {{"advise"}, {"gap.ply"}},
      {{"fit"}, {"gap.ply", "-o", "x.smf"}},
      {{"mesh"}, {"ball.smf", "-o", "x.ply"}},
      {{"probe"}, {"ball.smf", "--at", "0,0,1"}},
      {{"edit"}, {"ball.smf", "--script", "edits.json", "-o", "x.smf"}},
      {{"diagnose"}, {"ball.smf"}},
      {{"section"}, {"mesh.ply"}},
      {{"compare"}, {"mesh.ply", "gap.ply"}},
      {{"measure"}, {"mesh.ply"}},
      {{"csg"}, {"sphere(1)", "-o", "x.ply", "--resolution", "16"}},
      {{"deform"}, {"gap.ply", "--handles", "pull.json", "-o", "x.ply"}},
      {{"simulate"}, {"bar.mesh", "-o", "x.ply", "--frames", "2", "--duration", "0.01"}},
      {{"align"}, {"gap.ply", "ball.ply", "--from", "here"}},
      {{"fill"}, {"mesh.ply", "--list"}},
      {{"simplify"}, {"mesh.ply", "-o", "x.ply"}},
      {{"smooth"}, {"mesh.ply", "-o", "x.ply"}},
      {{"volume", "fit"}, {ball, "-o", "x.smv"}},
      {{"volume", "smooth"}, {ball, "-o", "x.vtu"}},
      {{"volume", "probe"}, {ball, "--at", "8,8,8", "--at", "8,8,4", "--method", "linear"}},
      {{"volume", "resample"}, {ball, "-o", "x.vti", "--size", "4", "--method", "linear"}},
      {{"volume", "isosurface"}, {ball, "-o", "x.ply", "--method", "linear"}},
      {{"volume", "render"}, Words{ball, "-o", "x.png", "--method", "linear"} + small},
      {{"volume", "surface"}, Words{ball, "-o", "x.png", "--quick"} + small},
      {{"flow", "lines"},
       {"rotation", "--seeds", "point(0.5,0,0); point(99,99,99)", "--duration", "0.1", "-o", "x.ply"}},
      {{"flow", "surface"}, {"rotation", "--seeds", circle, "--duration", "0.1", "-o", "x.ply"}},
      {{"flow", "render"},
       Words{"rotation", "--seeds", circle, "--duration", "0.1", "--no-streaks", "-o", "x.png"} + small}};
  std::size_t warned = 0;
  for (const auto& [command, help] : commands()) {
    const auto found = rest.find(command);
    ASSERT_NE(found, rest.end()) << "no case for" << spaced(command);
    const Words line = command + found->second + Words{"--json"};
    const Outcome outcome = run(line);
    ASSERT_EQ(outcome.code, 0) << spaced(line) << "\n" << outcome.err;
    const auto json = nlohmann::json::parse(outcome.out);
    ASSERT_TRUE(json.contains("warnings") && json["warnings"].is_array()) << spaced(line);
    std::string told;
    for (const auto& warning : json["warnings"]) told += "warning: " + warning.get<std::string>() + "\n";
    EXPECT_EQ(told, outcome.err) << spaced(line);
    warned += json["warnings"].empty() ? 0 : 1;
    if (command.back() == "normals") {
      EXPECT_EQ(run(line + Words{"--quiet"}).out, outcome.out);
    }
  }
  EXPECT_GT(warned, 9u);
}

TEST_F(CommandLineTool, SeveralPlacesAreAskedAtOnce) {
  write_points(path("ball.ply"), sphere(300));
  ASSERT_EQ(run({"fit", "ball.ply", "-o", "ball.smf"}).code, 0);
  const auto values =
      json_of({"probe", "ball.smf", "--at", "0,0,1.02", "--at=0,0,0.5", "--at", "1e6", "0.1", "0"})["values"];
  ASSERT_EQ(values.size(), 3u);
  EXPECT_EQ(values[0], json_of({"probe", "ball.smf", "--at", "0,0,1.02"})["values"][0]);
  EXPECT_EQ(values[1], json_of({"probe", "ball.smf", "--at", "0,0,0.5"})["values"][0]);
  EXPECT_EQ(values[2]["at"], nlohmann::json({1e6, 0.1, 0}));
  EXPECT_EQ(values[2], json_of({"probe", "ball.smf", "--at", "1e6,0.1,0"})["values"][0]);
  write(kBallFile, ball_bytes());
  const auto probed = json_of({"volume", "probe", kBallFile, "--at", "8,8,4", "--at", "99,0,0", "--method", "linear"});
  ASSERT_EQ(probed["values"].size(), 2u);
  EXPECT_NEAR(probed["values"][0]["value"].get<double>(), 3, 1e-5);
  EXPECT_FALSE(probed["values"][1]["inside"]);
  EXPECT_EQ(probed["inside"], 1);
}

}  // namespace
}  // namespace sansmesh::test
