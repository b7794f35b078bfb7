// Tests of `volume surface`: pictures, meshes and points of a ball in a small raw file.
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "ball_volume.h"
#include "run_tool.h"
#include "support/png_file.h"

namespace sansmesh::test {
namespace {

constexpr const char* kSoftBall = "soft_21x21x21_float32.raw";

/// 1 in a ball of radius 6 about (10, 10, 10), 0 outside, with a transition of about two samples.
std::string soft_ball_bytes() {
  std::vector<float> values;
  for (int k = 0; k < 21; ++k)
    for (int j = 0; j < 21; ++j)
      for (int i = 0; i < 21; ++i)
        values.push_back(static_cast<float>(0.5 * std::erfc(std::hypot(i - 10.0, j - 10.0, k - 10.0) - 6)));
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

class VolumeSurfaceTool : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write(kSoftBall, soft_ball_bytes());
  }
  Outcome surface(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"volume", "surface", path(kSoftBall)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
};

TEST_F(VolumeSurfaceTool, MeshesAreClosedAndHoldTheBall) {
  const double volume = 4.0 / 3 * std::numbers::pi * 216;
  const std::vector<std::vector<std::string>> ways{
      {"--value", "0.5"}, {"--high-gradient"}, {"--value", "0.5", "--exact-projection"}};
  for (const std::vector<std::string>& way : ways) {
    SCOPED_TRACE(way.back());
    std::vector<std::string> arguments{"-o", path("ball.ply"), "--json"};
    arguments.insert(arguments.end(), way.begin(), way.end());
    const Outcome outcome = surface(arguments);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_TRUE(json["output"]["closed"]);
    EXPECT_EQ(json["output"]["components"], 1);
    EXPECT_NEAR(json["volume"].get<double>(), volume, 0.1 * volume);
    EXPECT_EQ(json["surface"]["kind"], way[0] == "--value" ? "isovalue" : "high-gradient");
  }
}

TEST_F(VolumeSurfaceTool, PicturesShowADiscAndColoursOfAnArray) {
  const auto drawn = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--value", "0.5",     "-o", path("ball.png"), "--quick", "--view",
                                       "front",   "--width", "80", "--height",       "80",      "--background",
                                       "white"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = surface(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? read_png(path("ball.png")) : PngPicture{};
  };
  const auto count = [](const PngPicture& picture, const auto& such) {
    std::size_t n = 0;
    for (std::size_t y = 0; y < picture.height; ++y)
      for (std::size_t x = 0; x < picture.width; ++x) n += such(picture.at(x, y)) ? 1u : 0u;
    return n;
  };
  const auto covered = [](const std::array<int, 4>& p) { return p[0] + p[1] + p[2] < 740; };
  const auto coloured = [](const std::array<int, 4>& p) { return std::abs(p[0] - p[2]) > 60; };
  const PngPicture plain = drawn({});
  EXPECT_TRUE(covered(plain.at(40, 40)));
  EXPECT_FALSE(covered(plain.at(2, 2)));
  EXPECT_EQ(count(plain, coloured), 0u);
  EXPECT_GT(count(plain, covered), 80u * 80u / 4);
  EXPECT_GT(count(drawn({"--color-by", "value"}), coloured), 80u * 80u / 8);
  EXPECT_GT(count(drawn({"--color-by", "mean", "--color-range", "0.05"}), coloured), 80u * 80u / 8);
}

TEST_F(VolumeSurfaceTool, PointsAreCountedAndSpread) {
  const Outcome outcome =
      surface({"--value", "0.5", "--points-output", path("ball.ply"), "--point-spacing", "1", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto points = nlohmann::json::parse(outcome.out)["points"]["points"].get<double>();
  EXPECT_GT(points, 0.45 * 16 * 36);  // for discs of half a distance
  EXPECT_LT(points, 0.91 * 16 * 36);
}

TEST_F(VolumeSurfaceTool, SaysWhatIsWrongInOneLine) {
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& why) {
    const Outcome outcome = surface(arguments);
    EXPECT_NE(outcome.code, 0);
    EXPECT_NE(outcome.err.find(why), std::string::npos) << outcome.err;
  };
  refused({"--value", "0.5"}, "--output or --points-output is required");
  refused({"--value", "7", "-o", path("a.ply")}, "values lie between");
  refused({"--value", "0.5", "--high-gradient", "-o", path("a.ply")}, "exclude each other");
  refused({"--value", "0.5", "--array", "nothing", "-o", path("a.ply")}, "nothing");
  refused({"--value", "0.5", "--least-gradient", "1", "-o", path("a.ply")}, "needs --high-gradient");
  refused({"--value", "0.5", "--sharp", "-o", path("a.ply")}, "need a picture");
  refused({"--value", "0.5", "-o", path("a.xyz3")}, "a.xyz3");
  EXPECT_FALSE(std::filesystem::exists(path("a.ply")));
}

}  // namespace
}  // namespace sansmesh::test
