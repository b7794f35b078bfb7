// Tests of `advise`: its recommended commands run.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "support/clouds.h"

namespace sansmesh::test {
namespace {

using Json = nlohmann::json;

class AdviseCommand : public ToolTest {};

TEST_F(AdviseCommand, CommandsItPrintsRun) {
  PointSet cloud = sphere(1200, 0.015);
  for (int i = 0; i < 20; ++i) {
    cloud.positions.push_back({2 * std::cos(0.3f * float(i)), 2 * std::sin(0.3f * float(i)), 0.15f * float(i) - 2});
    cloud.normals.push_back({0, 0, 1});
  }
  write_points(path("in.ply"), cloud);
  write("handles.json", R"({"handles": [{"p": [0, 0, 0], "q": [0, 0, 0]}, {"p": [1, 0, 0], "q": [1, 0.2, 0]}]})");
  const auto before = listing();
  const Outcome outcome = run({"advise", "in.ply", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(listing(), before) << "it writes nothing";
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["traits"]["samples"], 1220);
  EXPECT_EQ(json["traits"]["normals"], "oriented outward");
  EXPECT_GT(json["traits"]["outliers"].get<double>(), 0.005);
  ASSERT_GE(json["recommendations"].size(), 3u);
  EXPECT_EQ(json["recommendations"][0]["aim"], "mesh");
  EXPECT_NE(json["recommendations"][0]["commands"][0].get<std::string>().find("--remove-outliers"), std::string::npos);
  for (const Json& r : json["recommendations"]) {
    EXPECT_GT(r["why"].get<std::string>().size(), 10u);
    for (const std::string line : r["commands"]) {
      std::istringstream words(line);
      std::vector<std::string> arguments;
      for (std::string word; words >> word;) arguments.push_back(word);
      ASSERT_EQ(arguments.at(0), "sansmesh");
      arguments.erase(arguments.begin());
      if (const auto preview = std::find(arguments.begin(), arguments.end(), "--preview"); preview != arguments.end())
        arguments.erase(preview, preview + 2);  // slow, and the same for all commands
      if (arguments[0] == "render") arguments.insert(arguments.end(), {"--width", "64", "--height", "48", "--quick"});
      const Outcome one = run(arguments);
      EXPECT_EQ(one.code, 0) << line << "\n" << one.err;
    }
  }
}

TEST_F(AdviseCommand, SaysWhyAndWhat) {
  PointSet cloud = cube(6000);
  cloud.normals.clear();
  write_points(path("a part.xyz"), cloud);
  const Outcome outcome = run({"advise", "a part.xyz"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* words : {"6,000 samples", "sharp edges", "no normals", "$ sansmesh reconstruct 'a part.xyz' -o ",
                            "--surface apss --sharp"})
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << " in\n" << outcome.out;
  EXPECT_EQ(run({"advise", "a part.xyz", "--quiet"}).out, "");
}

TEST_F(AdviseCommand, QuotesNamesForTheShell) {
  const PointSet cloud = sphere(2000);
  std::filesystem::create_directory(path("a"));
  write_points(path("my scan's.ply"), cloud);
  write_points(path("a/b-1.ply"), cloud);
  EXPECT_NE(run({"advise", "my scan's.ply"}).out.find(R"( 'my scan'\''s.ply' )"), std::string::npos);
  EXPECT_NE(run({"advise", "a/b-1.ply"}).out.find(" a/b-1.ply "), std::string::npos);
}

TEST_F(AdviseCommand, NamesOptionsAsTheToolDoes) {
  PointSet half;
  const PointSet ball = sphere(12000);
  for (std::size_t i = 0; i < ball.size(); ++i) {
    if (ball.positions[i].y < 0) continue;
    half.positions.push_back(ball.positions[i]);
    half.normals.push_back(ball.normals[i]);
  }
  write_points(path("half.ply"), half);
  const Outcome outcome = run({"advise", "half.ply"});
  EXPECT_NE(outcome.out.find("; it ends where the samples end (--closed closes it, --fill-holes closes narrower gaps)"),
            std::string::npos)
      << outcome.out;
  EXPECT_NE(outcome.out.find("-o surface.ply\n"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find('`'), std::string::npos) << outcome.out;
}

TEST_F(AdviseCommand, BadInputIsOneLine) {
  write("few.xyz", "1 2 3\n4 5 6\n7 8 0\n");
  for (const auto& [file, cause] : {std::pair{"few.xyz", "3 points"}, std::pair{"absent.ply", "no such file"}}) {
    const Outcome outcome = run({"advise", file});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.lines_of_error(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(file), std::string::npos);
    EXPECT_NE(outcome.err.find(cause), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(run({"advise"}).code, 2);
}

}  // namespace
}  // namespace sansmesh::test
