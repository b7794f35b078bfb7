// Tests of pictures of flow surfaces.
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "run_tool.h"
#include "sansmesh/io.h"

namespace sansmesh::test {
namespace {

class FlowRenderTool : public ToolTest {
 protected:
  Outcome render(const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"flow",       "render", "rotation", "--seeds", "line(0.2,0,0, 1.8,0,0, 40)",
                                    "--duration", "4",      "--width",  "96",      "--height",
                                    "72"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run(all);
  }
};

TEST_F(FlowRenderTool, DrawsWithStreaksWithoutAndAsSplats) {
  for (const std::vector<std::string>& look :
       {std::vector<std::string>{}, {"--no-streaks"}, {"--splats"}, {"--opacity", "0.5"}, {"--color-by", "speed"}}) {
    std::vector<std::string> all = {"-o", path("a.png"), "--background", "white", "--json"};
    all.insert(all.end(), look.begin(), look.end());
    const Outcome o = render(all);
    ASSERT_EQ(o.code, 0) << o.err;
    const auto json = nlohmann::json::parse(o.out);
    EXPECT_GT(json["surface"]["particles"], 39);
    EXPECT_EQ(json["output"]["files"][0], path("a.png"));
    EXPECT_GT(std::filesystem::file_size(path("a.png")), 1500u) << "a picture of something";
    std::filesystem::remove(path("a.png"));
  }
}

TEST_F(FlowRenderTool, FramesDiffer) {
  const Outcome o = render({"-o", path("f.png"), "--frames", "3"});
  ASSERT_EQ(o.code, 0) << o.err;
  const std::string first = slurp(path("f_000.png"));
  EXPECT_NE(first, slurp(path("f_001.png")));
  EXPECT_NE(first, slurp(path("f_002.png")));
  EXPECT_FALSE(std::filesystem::exists(path("f_003.png")));
}

TEST_F(FlowRenderTool, StandsBesideOtherSurfaces) {
  ASSERT_EQ(run({"csg", "sphere(0.5)", "-o", path("ball.ply"), "--cell", "0.05"}).code, 0);
  const Outcome alone = render({"-o", path("a.png"), "--no-streaks", "--color-by", "none"});
  const Outcome beside =
      render({"-o", path("b.png"), "--no-streaks", "--color-by", "none", "--mesh", path("ball.ply")});
  ASSERT_EQ(alone.code, 0) << alone.err;
  ASSERT_EQ(beside.code, 0) << beside.err;
  EXPECT_NE(slurp(path("a.png")), slurp(path("b.png")));
}

TEST_F(FlowRenderTool, SaysWhatDoesNotGoTogether) {
  const auto failing = [&](const std::vector<std::string>& arguments, int code, const std::string& word) {
    std::vector<std::string> all = {"flow",       "render", "rotation", "--seeds", "line(0.2,0,0, 1.8,0,0, 40)",
                                    "--duration", "4",      "-o",       "x.png"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return Failing{all, code, {word}};
  };
  expect_failures(
      {failing({"--frames", "1"}, 2, "--frames"), failing({"--turn", "90"}, 2, "--frames"),
       failing({"--frames", "4", "--no-streaks"}, 2, "--turn"), failing({"--opacity-factor", "2"}, 2, "--volume-array"),
       failing({"--iso", "1"}, 2, "a flow of a file"),
       failing({"--color-by", "pressure"}, 2, "a steady flow of a file"), failing({"--opacity", "2"}, 2, "--opacity"),
       failing({"--streak-length", "0"}, 2, "--streak-length"), failing({"--mesh", "none.ply"}, 1, "none.ply")});
}

}  // namespace
}  // namespace sansmesh::test
