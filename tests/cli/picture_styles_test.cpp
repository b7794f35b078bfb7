// Splats, lines and accessibility of `render`: the picture is what the option says.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "run_tool.h"
#include "sansmesh/io/io.h"
#include "sansmesh/render/lighting.h"
#include "support/mesh_shapes.h"
#include "support/png_file.h"

namespace sansmesh::test {
namespace {

constexpr std::size_t kSide = 120;

class PictureStyles : public ToolTest {
 protected:
  PngPicture drawn(const std::string& file, const std::vector<std::string>& more,
                   const std::string& view = "front") const {
    std::vector<std::string> words = {"render",   file,  "-o",     "out.png", "--width",       "120",
                                      "--height", "120", "--view", view,      "--orthographic"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? read_png(path("out.png")) : PngPicture{};
  }
};

bool is_covered(const std::array<int, 4>& p) { return p[3] > 127; }
bool is_ink(const std::array<int, 4>& p) { return p[0] < 128; }

/// From the middle of the picture.
double away(std::size_t x, std::size_t y) {
  return std::hypot(static_cast<double>(x) + 0.5 - kSide / 2.0, static_cast<double>(y) + 0.5 - kSide / 2.0);
}

/// Linear light over that of a grey.
double light_of(const std::array<int, 4>& p, float gray) {
  const float c = static_cast<float>(p[0]) / 255;
  return static_cast<double>(linear_color({c, c, c}).x / linear_color({gray, gray, gray}).x);
}
const std::vector<std::string> kGray = {"--color", "#808080", "--background", "transparent"};
constexpr float kGrayLevel = 128.0f / 255;

TEST_F(PictureStyles, LinesOfABallAreARingAtItsSilhouette) {
  write_mesh(path("ball.ply"), octasphere(5));
  const PngPicture ball = drawn("ball.ply", {"--background", "transparent", "--no-shadows"});
  ASSERT_EQ(ball.width, kSide);
  double area = 0;  // within the silhouette: the shadow on the ground lies outside
  for (std::size_t x = 0; x < kSide; ++x) area += is_covered(ball.at(x, kSide / 2)) ? 1 : 0;
  const double radius = area / 2;
  const PngPicture drawing = drawn("ball.ply", {"--lines", "--background", "white"});
  std::vector<int> around(36);
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) {
      if (!is_ink(drawing.at(x, y))) continue;
      EXPECT_NEAR(away(x, y), radius, 1.5) << x << ", " << y;
      const double angle =
          std::atan2(static_cast<double>(y) + 0.5 - kSide / 2.0, static_cast<double>(x) + 0.5 - kSide / 2.0);
      around[static_cast<std::size_t>((angle / std::numbers::pi + 1) * 18) % 36] += 1;
    }
  EXPECT_GT(*std::min_element(around.begin(), around.end()), 0) << "the ring is closed";
  // Over the lit surface nothing else changes.
  const PngPicture lit = drawn("ball.ply", {"--background", "white"});
  const PngPicture over = drawn("ball.ply", {"--lines=over", "--background", "white"});
  std::size_t darker = 0;
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) {
      if (std::abs(away(x, y) - radius) > 3) EXPECT_EQ(over.at(x, y), lit.at(x, y)) << x << ", " << y;
      darker += over.at(x, y)[0] + 40 < lit.at(x, y)[0];
    }
  EXPECT_GT(darker, 100u);
}

/// Few samples are drawn as large discs, whose rims are no lines of the ball.
TEST_F(PictureStyles, LinesOfACloudAreThoseOfItsSurface) {
  PointSet cloud;
  cloud.positions = cloud.normals = octasphere(4).vertices;
  write_points(path("cloud.ply"), cloud);
  const PngPicture drawing = drawn("cloud.ply", {"--lines", "--background", "white"});
  ASSERT_EQ(drawing.width, kSide);
  double farthest = 0, nearest = kSide;
  std::size_t ink = 0;
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) {
      if (!is_ink(drawing.at(x, y))) continue;
      ++ink;
      farthest = std::max(farthest, away(x, y)), nearest = std::min(nearest, away(x, y));
    }
  EXPECT_GT(ink, 200u);
  EXPECT_LT(farthest - nearest, 3.5);
}

TEST_F(PictureStyles, PointsThatMakeNoSurfaceHaveLinesToo) {
  PointSet plane;
  for (int i = 0; i < 400; ++i)
    plane.positions.push_back({static_cast<float>(i % 20) / 19, 0, static_cast<float>(i / 20) / 19});
  write_points(path("plane.ply"), plane);
  const PngPicture drawing = drawn("plane.ply", {"--lines", "--background", "white"});
  ASSERT_EQ(drawing.width, kSide);
  std::size_t ink = 0;
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) ink += is_ink(drawing.at(x, y)) ? 1 : 0;
  EXPECT_GT(ink, 100u);
}

TEST_F(PictureStyles, SplatsCoverWhatTheMeshDoes) {
  const TriangleMesh ball = octasphere(5);
  write_mesh(path("ball.ply"), ball);
  PointSet cloud;
  cloud.positions = cloud.normals = ball.vertices;
  write_points(path("cloud.ply"), cloud);
  const std::vector<std::string> how = {"--background", "transparent", "--clip-box=-2,-2,-2,2,2,2"};
  const PngPicture mesh = drawn("ball.ply", how);
  std::vector<std::string> splats = how;
  splats.push_back("--splats=5000");
  const PngPicture picture = drawn("cloud.ply", splats);
  std::size_t either = 0, both = 0;
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) {
      const bool a = is_covered(mesh.at(x, y)), b = is_covered(picture.at(x, y));
      either += a || b, both += a && b;
    }
  ASSERT_GT(either, 5000u);
  EXPECT_GT(static_cast<double>(both), 0.97 * static_cast<double>(either));
}

TEST_F(PictureStyles, AccessibilityIsTheShareOfTheSkyThatIsOpen) {
  // A ball hides nothing of itself: all of it has the light of its own colour. Lit as usual it has not.
  write_mesh(path("ball.ply"), octasphere(5));
  std::vector<std::string> open = kGray;
  open.insert(open.end(), {"--accessibility", "--bend-light", "0"});
  const PngPicture even = drawn("ball.ply", open), lit = drawn("ball.ply", kGray);
  int least = 255, most = 0;
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) {
      if (away(x, y) > 45) continue;
      EXPECT_NEAR(light_of(even.at(x, y), kGrayLevel), 1, 0.02) << x << ", " << y;
      least = std::min(least, lit.at(x, y)[0]), most = std::max(most, lit.at(x, y)[0]);
    }
  EXPECT_GT(most, least + 40);
  // Bends of the same sign give light: 1 / radius over that of a ball as large as the reach.
  std::vector<std::string> bent = kGray;
  bent.insert(bent.end(), {"--accessibility=0.3", "--bend-light", "0.5"});
  const double expected = 1 + 0.5 * 2 / std::numbers::pi * std::atan(0.3 * std::sqrt(12.0));
  EXPECT_NEAR(light_of(drawn("ball.ply", bent).at(60, 60), kGrayLevel), expected, 0.05);

  // From the middle of a long channel, as deep as half its width, the walls leave √½.
  TriangleMesh channel;
  for (const auto& [x, y] : {std::pair{-0.5f, 0.5f}, {-0.5f, 0.0f}, {0.5f, 0.0f}, {0.5f, 0.5f}})
    for (const float z : {-20.0f, 20.0f}) channel.vertices.push_back({x, y, z});
  for (std::uint32_t k = 0; k < 6; k += 2) {
    channel.triangles.push_back({k, k + 1, k + 3});
    channel.triangles.push_back({k, k + 3, k + 2});
  }
  write_mesh(path("channel.ply"), channel);
  std::vector<std::string> deep = kGray;
  deep.insert(deep.end(), {"--accessibility=1", "--bend-light", "0", "--look-at", "0,0,0", "--look-radius", "0.45"});
  EXPECT_NEAR(light_of(drawn("channel.ply", deep, "top").at(60, 60), kGrayLevel), std::sqrt(0.5), 0.03);
}

TEST_F(PictureStyles, WrongValuesNameTheOption) {
  write_mesh(path("ball.ply"), octasphere(3));
  const auto failing = [](std::vector<std::string> more, std::vector<std::string> parts) {
    more.insert(more.begin(), {"render", "ball.ply", "-o", "no.png"});
    return Failing{more, 2, std::move(parts)};
  };
  expect_failures({
      failing({"--accessibility=0"}, {"--accessibility", "0"}),
      failing({"--accessibility=far"}, {"--accessibility", "far"}),
      failing({"--accessibility", "--bend-light", "1.5"}, {"--bend-light", "0..1", "1.5"}),
      failing({"--bend-light", "0.1"}, {"--bend-light", "--accessibility"}),
      failing({"--accessibility", "--lines"}, {"--accessibility", "--lines=over"}),
      failing({"--accessibility", "--plain", "--surface", "apss"}, {"--accessibility", "--plain"}),
      failing({"--lines=under"}, {"--lines", "under"}),
      failing({"--lines", "--line-width", "0"}, {"--line-width", "0.1..50"}),
      failing({"--line-color", "red"}, {"--line-color", "--lines"}),
      failing({"--lines", "--line-color", "redd"}, {"--line-color", "redd"}),
      failing({"--splats=many"}, {"--splats", "many"}),
      failing({"--splats=-3"}, {"--splats", "-3"}),
      failing({"--splats", "--reflection", "0.5"}, {"--splats", "--reflection"}),
  });
}

}  // namespace
}  // namespace sansmesh::test
