// Tests of splats, lines and accessibility of `render`.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "run_tool.h"
#include "sansmesh/io.h"
#include "sansmesh/render/scene/lighting.h"
#include "support/mesh_shapes.h"
#include "support/png_file.h"
#include "support/sanitizers.h"

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
    const bool frames = std::find(more.begin(), more.end(), "--frames") != more.end();
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? read_png(path(frames ? "out_000.png" : "out.png")) : PngPicture{};
  }

  /// Writes samples of a ball with some stray samples.
  void write_ball_and_strays() const {
    PointSet cloud;
    cloud.positions = cloud.normals = octasphere(4).vertices;
    write_points(path("ball.ply"), cloud);
    for (const Vec3f& stray : {Vec3f{2, 0, 0}, {0, 1.7f, 0.3f}, {-1.5f, 0.4f, 1}}) {
      cloud.positions.push_back(stray);
      cloud.normals.push_back({0, 0, 1});
    }
    write_points(path("strays.ply"), cloud);
  }
};

std::vector<std::string> and_more(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

bool is_covered(const std::array<int, 4>& p) { return p[3] > 127; }
bool is_ink(const std::array<int, 4>& p) { return p[0] < 128; }

std::size_t ink_of(const PngPicture& drawing) {
  std::size_t ink = 0;
  for (std::size_t y = 0; y < kSide && drawing.width == kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) ink += is_ink(drawing.at(x, y)) ? 1 : 0;
  return ink;
}

/// Number of pixels that differ.
std::size_t changed(const PngPicture& a, const PngPicture& b) {
  EXPECT_EQ(a.width, kSide);
  EXPECT_EQ(b.width, kSide);
  std::size_t pixels = 0;
  for (std::size_t y = 0; y < kSide && a.width == kSide && b.width == kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) pixels += a.at(x, y) != b.at(x, y) ? 1 : 0;
  return pixels;
}

/// Distance from the centre of the picture.
double away(std::size_t x, std::size_t y) {
  return std::hypot(static_cast<double>(x) + 0.5 - kSide / 2.0, static_cast<double>(y) + 0.5 - kSide / 2.0);
}

/// Linear light relative to that of a grey.
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
  double area = 0;  // inside the silhouette: the shadow on the ground is outside
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

/// Few samples are drawn as large discs, whose rims must not appear as lines.
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
  PointSet line;
  for (int i = 0; i < 60; ++i) line.positions.push_back({static_cast<float>(i) / 59, 0, static_cast<float>(i) / 59});
  write_points(path("line.ply"), line);
  const PngPicture drawing = drawn("line.ply", {"--lines", "--background", "white"});
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
  // A ball does not occlude itself, so all of it has its own colour; with the usual shading it does not.
  write_mesh(path("ball.ply"), octasphere(5));
  std::vector<std::string> open = kGray;
  open.insert(open.end(), {"--accessibility", "--curvature-shading", "0"});
  const PngPicture even = drawn("ball.ply", open), lit = drawn("ball.ply", kGray);
  int least = 255, most = 0;
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) {
      if (away(x, y) > 45) continue;
      EXPECT_NEAR(light_of(even.at(x, y), kGrayLevel), 1, 0.02) << x << ", " << y;
      least = std::min(least, lit.at(x, y)[0]), most = std::max(most, lit.at(x, y)[0]);
    }
  EXPECT_GT(most, least + 40);
  // Curvatures of equal sign brighten: 1 / radius relative to a ball as large as the reach.
  std::vector<std::string> bent = kGray;
  bent.insert(bent.end(), {"--accessibility=0.3", "--curvature-shading", "0.5"});
  const double expected = 1 + 0.5 * 2 / std::numbers::pi * std::atan(0.3 * std::sqrt(12.0));
  EXPECT_NEAR(light_of(drawn("ball.ply", bent).at(60, 60), kGrayLevel), expected, 0.05);

  // In the middle of a long channel, half as deep as wide, the walls leave √½ of the light.
  TriangleMesh channel;
  for (const auto& [x, y] : {std::pair{-0.5f, 0.5f}, {-0.5f, 0.0f}, {0.5f, 0.0f}, {0.5f, 0.5f}})
    for (const float z : {-20.0f, 20.0f}) channel.vertices.push_back({x, y, z});
  for (std::uint32_t k = 0; k < 6; k += 2) {
    channel.triangles.push_back({k, k + 1, k + 3});
    channel.triangles.push_back({k, k + 3, k + 2});
  }
  write_mesh(path("channel.ply"), channel);
  std::vector<std::string> deep = kGray;
  deep.insert(deep.end(),
              {"--accessibility=1", "--curvature-shading", "0", "--look-at", "0,0,0", "--look-radius", "0.45"});
  EXPECT_NEAR(light_of(drawn("channel.ply", deep, "top").at(60, 60), kGrayLevel), std::sqrt(0.5), 0.03);
}

/// Turntables show curvature like single pictures.
TEST_F(PictureStyles, FramesHaveBendsAndRidges) {
  write_mesh(path("ball.ply"), octasphere(5));
  const std::vector<std::string> frames = {"--frames", "1"};
  const double expected = 1 + 0.5 * 2 / std::numbers::pi * std::atan(0.3 * std::sqrt(12.0));
  const std::vector<std::string> bent = and_more(and_more(kGray, frames), {"--accessibility=0.3"});
  EXPECT_NEAR(light_of(drawn("ball.ply", and_more(bent, {"--curvature-shading", "0.5"})).at(60, 60), kGrayLevel),
              expected, 0.05);
  EXPECT_NEAR(light_of(drawn("ball.ply", and_more(bent, {"--curvature-shading", "0"})).at(60, 60), kGrayLevel), 1,
              0.02);
  // A ring that is higher than wide: seen along its axis, its top is a ridge between the silhouettes.
  TriangleMesh ring = torus_mesh(120, 60);
  for (Vec3f& p : ring.vertices) p.z *= 2;
  write_mesh(path("ring.ply"), ring);
  const std::vector<std::string> drawing = and_more(frames, {"--lines", "--line-strength"});
  const std::size_t with_ridge = ink_of(drawn("ring.ply", and_more(drawing, {"2"})));
  const std::size_t without = ink_of(drawn("ring.ply", and_more(drawing, {"1e6"})));
  EXPECT_GT(without, 500u);
  EXPECT_GT(with_ridge, without + 300);
}

TEST_F(PictureStyles, FramesOfACloudHaveTheLinesOfItsSurface) {
  write_ball_and_strays();
  const PngPicture drawing = drawn("ball.ply", {"--lines", "--background", "white", "--frames", "1"});
  ASSERT_EQ(drawing.width, kSide);
  double farthest = 0, nearest = kSide;
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x)
      if (is_ink(drawing.at(x, y))) farthest = std::max(farthest, away(x, y)), nearest = std::min(nearest, away(x, y));
  EXPECT_GT(ink_of(drawing), 200u);
  EXPECT_LT(farthest - nearest, 3.5);
}

/// For all ways of drawing points: lines of their surface, discs, and discs of a turntable.
TEST_F(PictureStyles, OutliersAreLeftOutOfCloudsOfAllKinds) {
  SANSMESH_NOT_SANITIZED("others draw clouds, too");
  write_ball_and_strays();
  for (const std::vector<std::string>& how : std::vector<std::vector<std::string>>{
           {"--lines"}, {"--lines=over", "--point-radius", "0.05"}, {}, {"--frames", "1"}, {"--opacity", "0.5"}}) {
    const PngPicture ball = drawn("ball.ply", how);
    EXPECT_GT(changed(ball, drawn("strays.ply", how)), 100u) << (how.empty() ? "" : how[0]);
    EXPECT_EQ(changed(ball, drawn("strays.ply", and_more(how, {"--remove-outliers"}))), 0u)
        << (how.empty() ? "" : how[0]);
  }
}

TEST_F(PictureStyles, FilesAsOneAreOneObjectHoweverTheyAreDrawn) {
  TriangleMesh left = octasphere(3);
  left.normals.clear();
  const TriangleMesh right = joined({}, left, {3, 0, 0});
  write_mesh(path("left.ply"), left), write_mesh(path("right.ply"), right);
  write_mesh(path("both.ply"), joined(left, right, {}));
  for (const std::vector<std::string>& how :
       std::vector<std::vector<std::string>>{{"--opacity", "0.5"}, {"--frames", "2"}, {"--color", "red"}})
    EXPECT_EQ(changed(drawn("both.ply", how), drawn("left.ply", and_more(how, {"right.ply", "--as-one"}))), 0u)
        << how[0];
}

/// Options that do not apply to a picture are rejected by name.
TEST_F(PictureStyles, NothingIsIgnored) {
  TriangleMesh ball = octasphere(3);
  write_mesh(path("ball.ply"), ball);
  std::vector<float> heights;
  for (const Vec3f& p : ball.vertices) heights.push_back(p.y);
  ball.attributes.set("height", std::move(heights));
  write_mesh(path("high.ply"), ball);
  PointSet cloud;
  cloud.positions = ball.vertices;
  write_points(path("cloud.ply"), cloud);
  const auto failing = [](const std::vector<std::string>& words, const std::vector<std::string>& parts) {
    return Failing{and_more({"render", "-o", "no.png"}, words), 2, parts};
  };
  expect_failures({
      // curvature
      failing({"ball.ply", "cloud.ply", "--accessibility", "--curvature-shading", "0.4"},
              {"--curvature-shading", "several"}),
      failing({"ball.ply", "cloud.ply", "--lines", "--line-strength", "30"}, {"--line-strength", "several"}),
      failing({"ball.ply", "--curvature-shading", "0.4"}, {"--curvature-shading", "--accessibility"}),
      failing({"ball.ply", "--line-strength", "30"}, {"--line-strength", "--lines"}),
      // translucent
      failing({"ball.ply", "--opacity", "0.5", "--lines"}, {"--lines", "--opacity"}),
      failing({"ball.ply", "--opacity", "0.5", "--accessibility"}, {"--accessibility", "--opacity"}),
      failing({"high.ply", "--opacity", "0.5", "--color-by", "height"}, {"--color-by", "--opacity"}),
      failing({"high.ply", "--frames", "2", "--color-by", "height"}, {"--color-by", "--frames"}),
      // lines only
      failing({"ball.ply", "--lines", "--color", "red"}, {"--color", "--lines=over"}),
      failing({"ball.ply", "cloud.ply", "--lines", "--name", "a"}, {"--name", "--lines=over"}),
      failing({"high.ply", "--lines", "--color-by", "height"}, {"--color-by", "--lines=over"}),
      failing({"ball.ply", "--lines", "--wireframe"}, {"--wireframe", "--lines=over"}),
      failing({"cloud.ply", "--surface", "apss", "--lines", "--reflection", "0.5"}, {"--reflection", "--lines=over"}),
      failing({"cloud.ply", "--surface", "apss", "--lines", "--exact-shadows"}, {"--exact-shadows", "--lines=over"}),
      // meshes and points
      failing({"cloud.ply", "--flat"}, {"--flat", "triangles"}),
      failing({"cloud.ply", "--lines", "--flat"}, {"--flat", "triangles"}),
      failing({"cloud.ply", "--frames", "2", "--wireframe"}, {"--wireframe", "triangles"}),
      failing({"ball.ply", "--point-radius", "0.1"}, {"--point-radius", "points"}),
      failing({"ball.ply", "high.ply", "--point-radius", "0.1"}, {"--point-radius", "points"}),
      failing({"ball.ply", "--lines", "--remove-outliers"}, {"--remove-outliers", "points"}),
      failing({"ball.ply", "--name", "a"}, {"--name", "several"}),
      // surfaces without a mesh
      failing({"ball.ply", "--reflection", "0.5"}, {"--reflection", "--surface"}),
      failing({"cloud.ply", "--rays", "march"}, {"--rays", "--surface"}),
      failing({"cloud.ply", "--splats", "--rays", "march"}, {"--rays", "--splats"}),
      failing({"cloud.ply", "--surface", "apss", "--refraction-index", "1.5"},
              {"--refraction-index", "--transmission"}),
      failing({"cloud.ply", "--splats", "--exact-shadows"}, {"--exact-shadows", "--splats"}),
      failing({"cloud.ply", "--splats", "--wireframe"}, {"--wireframe"}),
      failing({"cloud.ply", "--surface", "apss", "--quick", "--antialiasing", "2"}, {"--antialiasing", "--quick"}),
      failing({"cloud.ply", "--surface", "apss", "--quick", "--exact-shadows"}, {"--exact-shadows", "--quick"}),
  });
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
      failing({"--accessibility", "--curvature-shading", "1.5"}, {"--curvature-shading", "0..1", "1.5"}),
      failing({"--curvature-shading", "0.1"}, {"--curvature-shading", "--accessibility"}),
      failing({"--accessibility", "--lines"}, {"--accessibility", "--lines=over"}),
      failing({"--accessibility", "--quick", "--surface", "apss"}, {"--accessibility", "--quick"}),
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
