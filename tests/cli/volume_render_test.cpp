// Tests of `volume render`: every option has its effect on the picture of a ball in a small raw file.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ball_volume.h"
#include "run_tool.h"
#include "support/png_file.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

constexpr std::size_t kWide = 160, kHigh = 120;

using PixelIs = std::function<bool(const std::array<int, 4>&)>;

const PixelIs is_white = [](const std::array<int, 4>& p) { return std::min({p[0], p[1], p[2]}) > 250; };
const PixelIs is_orange = [](const std::array<int, 4>& p) { return p[0] > p[2] + 60 && p[0] > p[1]; };
const PixelIs is_blue = [](const std::array<int, 4>& p) { return p[2] > p[0] + 60; };
const PixelIs is_ink = [](const std::array<int, 4>& p) { return std::max({p[0], p[1], p[2]}) < 100; };

/// Number of pixels of [x0, x1) × [y0, y1) that satisfy a predicate.
std::size_t count_if(const PngPicture& picture, const PixelIs& such, std::size_t x0 = 0, std::size_t x1 = 1u << 20,
                     std::size_t y0 = 0, std::size_t y1 = 1u << 20) {
  std::size_t count = 0;
  for (std::size_t y = y0; y < std::min(y1, picture.height); ++y)
    for (std::size_t x = x0; x < std::min(x1, picture.width); ++x) count += such(picture.at(x, y));
  return count;
}

/// Share of the pixels that differ by more than a number of levels.
double differing(const PngPicture& a, const PngPicture& b, int levels = 3) {
  EXPECT_EQ(a.bytes.size(), b.bytes.size());
  if (a.bytes.size() != b.bytes.size() || a.bytes.empty()) return 1;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.bytes.size(); i += 4)
    count += std::abs(a.bytes[i] - b.bytes[i]) > levels || std::abs(a.bytes[i + 1] - b.bytes[i + 1]) > levels ||
             std::abs(a.bytes[i + 2] - b.bytes[i + 2]) > levels;
  return 4 * static_cast<double>(count) / static_cast<double>(a.bytes.size());
}

class VolumeRenderTool : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write(kBallFile, ball_bytes());
    ball_ = path(kBallFile);
  }

  /// A picture from the front on white, with further options.
  PngPicture picture(const std::vector<std::string>& more, const std::string& name = "picture.png") {
    std::vector<std::string> arguments = {"volume", "render",   ball_, "-o",     path(name), "--width",
                                          "160",    "--height", "120", "--view", "front"};
    if (std::find(more.begin(), more.end(), "--background") == more.end())
      arguments.insert(arguments.end(), {"--background", "white"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? read_png(path(name)) : PngPicture{};
  }
  std::string ball_;
};

TEST_F(VolumeRenderTool, IsoSurfaceIsWhereItsBallIs) {
  SANSMESH_NOT_SANITIZED("judges pictures; others draw them, too");
  const PngPicture p = picture({"--iso", "2:#ff8800", "--opacity-factor", "0", "--no-bar"});
  ASSERT_EQ(p.width, kWide);
  ASSERT_EQ(p.height, kHigh);
  EXPECT_TRUE(is_orange(p.at(kWide / 2, kHigh / 2)));
  // The frame shows the box, 16 across, with its ball of radius 5 as a disc on an empty background.
  const std::size_t ball = count_if(p, is_orange), rest = count_if(p, is_white);
  const double radius = std::sqrt(static_cast<double>(ball) / std::numbers::pi);
  EXPECT_GT(radius, 0.2 * kHigh);
  EXPECT_LT(radius, 5.0 / 16 * kHigh);
  EXPECT_GT(ball + rest, kWide * kHigh - static_cast<std::size_t>(4 * std::numbers::pi * radius));  // except its rim
  EXPECT_EQ(count_if(p, is_white, 0, 20), 20 * kHigh);
  for (const double turn : {0.0, 1.0, 2.5, 4.0, 5.5}) {
    const auto at = [&](double r) {
      return p.at(static_cast<std::size_t>(0.5 * kWide + r * std::cos(turn)),
                  static_cast<std::size_t>(0.5 * kHigh + r * std::sin(turn)));
    };
    EXPECT_TRUE(is_orange(at(radius - 3))) << turn;
    EXPECT_TRUE(is_white(at(radius + 3))) << turn;
  }
  // Half of it where the other half is clipped; none where a slab covers all.
  const PngPicture half = picture({"--iso", "2:#ff8800", "--opacity-factor", "0", "--no-bar", "--clip", "x>8"});
  EXPECT_NEAR(static_cast<double>(count_if(half, is_orange, 0, kWide / 2)), static_cast<double>(ball) / 2,
              0.05 * static_cast<double>(ball));
  EXPECT_EQ(count_if(half, is_white, kWide / 2 + 2), (kWide / 2 - 2) * kHigh);
  EXPECT_EQ(count_if(picture({"--iso", "2", "--opacity-factor", "0", "--no-bar", "--clip", "-1<z<17"}), is_white),
            kWide * kHigh);
  // Of two surfaces, the inner one is visible only through the outer one.
  const std::vector<std::string> two = {"--iso", "5:#0000ff", "--opacity-factor", "0", "--no-bar", "--iso"};
  auto clear = two, dense = two;
  clear.emplace_back("2:#ff8800:0.2"), dense.emplace_back("2:#ff8800");
  EXPECT_GT(count_if(picture(clear), is_blue), 200u);
  EXPECT_EQ(count_if(picture(dense), is_blue), 0u);
}

TEST_F(VolumeRenderTool, PlainPictureShowsTheBallAndItsColourBar) {
  const PngPicture p = picture({});
  ASSERT_EQ(p.width, kWide) << "the bar is in the width that is asked for";
  ASSERT_EQ(p.height, kHigh);
  // The bar has many colours above each other, and numbers beside it.
  const auto colors = [&](std::size_t x) {
    std::set<std::array<int, 4>> found;
    for (std::size_t y = kHigh / 4; y < 3 * kHigh / 4; ++y) found.insert(p.at(x, y));
    return found.size();
  };
  std::size_t bar = kWide - 1;
  while (bar > kWide / 2 && colors(bar) <= 30) --bar;
  ASSERT_GT(bar, 100u);
  EXPECT_GT(count_if(p, is_ink, bar + 4), 20u);
  // Darker in the centre than the background, and all in the frame.
  EXPECT_FALSE(is_white(p.at(50, kHigh / 2)));
  EXPECT_EQ(count_if(p, is_white, 0, 5), 5 * kHigh);
  EXPECT_EQ(count_if(p, is_white, 0, 100, 0, 4), 100u * 4);
  EXPECT_EQ(picture({"--no-bar"}).width, kWide);
}

TEST_F(VolumeRenderTool, EveryOptionShows) {
  SANSMESH_NOT_SANITIZED("thirty pictures; tests of render draw them sanitized");
  const PngPicture plain = picture({"--no-bar"});
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--preset", "ct-bone"},
                                             {"--preset", "ct-soft-tissue"},
                                             {"--preset", "mr"},
                                             {"--preset", "flow"},
                                             {"--preset", "diverging"},
                                             {"--preset", "gray"},
                                             {"--opacity-factor", "4"},
                                             {"--no-shading"},
                                             {"--clip", "1,1,0>12"},
                                             {"--clip", "z>8", "--no-clip-faces"},
                                             {"--axes"},
                                             {"--title", "a ball"},
                                             {"--zoom", "2"},
                                             {"--look-at", "12,8,8"},
                                             {"--azimuth", "30"},
                                             {"--elevation", "50"},
                                             {"--z-up"},
                                             {"--background", "black"},
                                             {"--method", "nearest"}}) {
    auto options = more;
    options.emplace_back("--no-bar");
    // A ball looks the same from the front and from above: the surfaces of a corner show rotations of the view.
    if (more[0] == "--azimuth" || more[0] == "--elevation" || more[0] == "--z-up") {
      const std::vector<std::string> corner = {"--no-bar", "--clip", "x>8", "--clip", "y>8", "--iso", "2"};
      options.insert(options.end(), corner.begin() + 1, corner.end());
      const auto turned = [&](const std::vector<std::string>& view) {
        std::vector<std::string> all = {"volume",  "render", ball_,      "-o",  path("turned.png"),
                                        "--width", "160",    "--height", "120", "--background",
                                        "white"};
        all.insert(all.end(), corner.begin(), corner.end());
        all.insert(all.end(), view.begin(), view.end());
        const Outcome outcome = run(all);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return read_png(path("turned.png"));
      };
      EXPECT_GT(differing(turned({}), turned(more)), 0.02) << more[0];
      continue;
    }
    EXPECT_GT(differing(plain, picture(options)), 0.002) << more[0] << ' ' << (more.size() > 1 ? more[1] : "");
  }
  const auto large = [&](std::vector<std::string> more, const std::string& name) {
    more.insert(more.begin(), {"volume", "render", ball_, "-o", path(name), "--width", "320", "--height", "240"});
    const Outcome outcome = run(more);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return read_png(path(name));
  };
  // Labels make the picture wider.
  EXPECT_NE(large({"--axes"}, "axes.png").bytes, large({"--axes=mm"}, "axes-unit.png").bytes);
  EXPECT_NE(large({}, "bar.png").bytes, large({"--unit", "K"}, "unit.png").bytes);
}

TEST_F(VolumeRenderTool, GridsAreDrawnWhereTheVolumeEnds) {
  // 17 samples per side give as many lines in both directions of the front, which hide those of the back.
  const Outcome outcome =
      run({"volume", "render", ball_, "-o", path("grid.png"), "--width", "640", "--height", "480", "--view", "front",
           "--background", "white", "--no-bar", "--opacity-factor", "0", "--grid", "--orthographic"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const PngPicture p = read_png(path("grid.png"));
  // Between two horizontal lines, near the centre.
  std::size_t most = 0, row = 0;
  for (std::size_t y = 230; y < 260; ++y) {
    const std::size_t white = count_if(p, is_white, 0, 640, y, y + 1);
    if (white > most) most = white, row = y;
  }
  std::size_t lines = 0;
  const auto dark = [&](std::size_t x) { return p.at(x, row)[0] < 200; };
  for (std::size_t x = 1; x < 640; ++x) lines += dark(x) && !dark(x - 1);
  EXPECT_EQ(lines, 17u);
  EXPECT_EQ(count_if(picture({"--no-bar", "--opacity-factor", "0", "--iso", "1e9"}), is_ink), 0u);
}

TEST_F(VolumeRenderTool, CloseUpsShowThePlaceAskedFor) {
  const std::vector<std::string> ball = {"--iso",  "2:#ff8800", "--opacity-factor", "0", "--no-bar",
                                         "--zoom", "4",         "--look-at"};
  auto inside = ball, rim = ball;
  inside.emplace_back("8,8,13"), rim.emplace_back("13,8,8");
  EXPECT_EQ(count_if(picture(inside), is_orange), kWide * kHigh);
  // About half, since the silhouette of a ball in perspective is in front of its widest circle.
  const double share = static_cast<double>(count_if(picture(rim), is_orange)) / (kWide * kHigh);
  EXPECT_GT(share, 0.35);
  EXPECT_LT(share, 0.55);
}

TEST_F(VolumeRenderTool, TransferFunctionsAreWrittenAndReadBack) {
  const PngPicture first = picture({"--save-transfer", path("f.json")});
  EXPECT_EQ(differing(first, picture({"--transfer", path("f.json")}), 0), 0);
  // A colour map of ParaView: blue inside, red outside, opaque.
  write(
      "map.json",
      R"([{"Name": "ours", "RGBPoints": [-7, 1, 0, 0, 7, 0, 0, 1], "Points": [-7, 0, 0.5, 0, 1, 0, 0.5, 0, 2, 1, 0.5, 0, 7, 1, 0.5, 0]}])");
  const PngPicture map = picture({"--transfer", path("map.json"), "--no-bar", "--no-shading"});
  EXPECT_GT(count_if(map, [](const auto& p) { return p[2] > 80 && p[2] > p[1] + 60; }), 1000u);
}

TEST_F(VolumeRenderTool, OtherThingsMayStandInThePicture) {
  // A blue square in front of the ball, as a mesh; and a blue ball as samples without a mesh.
  write("square.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
        "red\nproperty uchar green\nproperty uchar blue\nelement face 2\nproperty list uchar int vertex_indices\n"
        "end_header\n6 6 15 0 0 255\n10 6 15 0 0 255\n10 10 15 0 0 255\n6 10 15 0 0 255\n3 0 1 2\n3 0 2 3\n");
  constexpr int kPoints = 400;
  std::string cloud = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(kPoints) +
                      "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar "
                      "green\nproperty uchar blue\nend_header\n";
  for (int i = 0; i < kPoints; ++i) {  // on a ball of radius 2
    const double z = 1 - (2 * i + 1.0) / kPoints, r = std::sqrt(1 - z * z), turn = 2.399963 * i;
    cloud += std::to_string(8 + 2 * r * std::cos(turn)) + " " + std::to_string(8 + 2 * r * std::sin(turn)) + " " +
             std::to_string(14 + 2 * z) + " 0 0 255\n";
  }
  write("cloud.ply", cloud);
  for (const auto& [option, file] : {std::pair{"--mesh", "square.ply"}, {"--points", "cloud.ply"}}) {
    const PngPicture p = picture({"--no-bar", option, path(file), "--iso", "2:#ff8800"});
    EXPECT_GT(count_if(p, is_blue), 300u) << file;
    EXPECT_TRUE(is_blue(p.at(kWide / 2, kHigh / 2))) << file;
    EXPECT_GT(count_if(p, is_orange), 300u) << file;
  }
  expect_failures(
      {{{"volume", "render", ball_, "-o", path("never.png"), "--mesh", path("cloud.ply")}, 1, {"cloud.ply"}},
       {{"volume", "render", ball_, "-o", path("never.png"), "--points", path("none.ply")}, 1, {"none.ply"}}});
}

TEST_F(VolumeRenderTool, OpacityMayComeFromAnotherArray) {
  std::string csv = "x,y,z,t,p\n";
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i)
        csv += std::to_string(i) + "," + std::to_string(j) + "," + std::to_string(k) + "," + std::to_string(i) + "," +
               std::to_string(j) + "\n";
  write("two.csv", csv);
  write("f.json", R"({"version": 1, "colors": [[0, "#0000ff"], [2.4, "#0000ff"], [2.6, "#ff8800"], [5, "#ff8800"]],
                      "opacities": [[0, 0], [3, 0], [3.2, 0.99], [5, 0.99]]})");
  const Outcome outcome = run(
      {"volume",       "render",       path("two.csv"), "--array",  "t",           "--opacity-by", "p",   "--transfer",
       path("f.json"), "-o",           path("two.png"), "--width",  "160",         "--height",     "120", "--view",
       "front",        "--background", "white",         "--no-bar", "--no-shading"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const PngPicture p = read_png(path("two.png"));
  // The colour changes from left to right, the opacity from top (large p) to bottom.
  EXPECT_TRUE(is_blue(p.at(kWide / 2 - 20, kHigh / 4)));
  EXPECT_TRUE(is_orange(p.at(kWide / 2 + 20, kHigh / 4)));
  EXPECT_TRUE(is_white(p.at(kWide / 2 - 20, 3 * kHigh / 4)));
  EXPECT_TRUE(is_white(p.at(kWide / 2 + 20, 3 * kHigh / 4)));
}

TEST_F(VolumeRenderTool, QuickPicturesTellTheirErrorAndTendToTheOthers) {
  SANSMESH_NOT_SANITIZED("judges pictures; tests of render bake volumes sanitized");
  const auto json = json_of({"volume", "render", ball_, "-o", path("quick.png"), "--width", "160", "--height", "120",
                             "--view", "front", "--background", "white", "--baked", "--bake-error", "0.002"});
  EXPECT_LT(json["baked"]["error_mean"].get<double>(), 0.002);
  EXPECT_LE(json["baked"]["error_mean"].get<double>(), json["baked"]["error_most"].get<double>());
  EXPECT_LT(differing(picture({}), read_png(path("quick.png")), 8), 0.02);
  const auto coarse = json_of({"volume", "render", ball_, "-o", path("coarse.png"), "--width", "160", "--height", "120",
                               "--baked", "--bake-error", "0.2"});
  EXPECT_LE(coarse["baked"]["bricks"], json["baked"]["bricks"]);
}

TEST_F(VolumeRenderTool, TurntablesGoRoundAndKeepTheirSize) {
  const auto json = json_of({"volume",
                             "render",
                             ball_,
                             "-o",
                             path("turn.png"),
                             "--width",
                             "160",
                             "--height",
                             "120",
                             "--frames",
                             "4",
                             "--background",
                             "white",
                             "--clip",
                             "x>8",
                             "--iso",
                             "2:#ff8800",
                             "--opacity-factor",
                             "0",
                             "--no-clip-faces"});
  ASSERT_EQ(json["output"]["files"].size(), 4u);
  std::vector<std::size_t> shown;
  for (const auto& file : json["output"]["files"]) {
    const PngPicture p = read_png(file.get<std::string>());
    ASSERT_EQ(p.height, kHigh);
    shown.push_back(count_if(p, is_orange, 0, kWide));
    EXPECT_GT(shown.back(), 500u);
  }
  // Four views show the open half from outside or from inside, so they cannot all be equal.
  EXPECT_GT(*std::max_element(shown.begin(), shown.end()), *std::min_element(shown.begin(), shown.end()) + 100);
}

}  // namespace
}  // namespace sansmesh::test
