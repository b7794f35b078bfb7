// Tests of pictures by commands: views, crops, several objects, colour bars.
#include <cmath>

#include "ball_volume.h"
#include "run_tool.h"
#include "sansmesh/io.h"
#include "support/clouds.h"
#include "support/mesh_shapes.h"
#include "support/png_file.h"
#include "support/sanitizers.h"

namespace sansmesh::test {
namespace {

class PictureCommands : public ToolTest {
 protected:
  void write_ball(const std::string& name, double radius, const Vec3& at) const {
    TriangleMesh ball = octasphere(4);
    for (Vec3f& p : ball.vertices) p = Vec3f(Vec3(p) * radius);
    ball.origin = at;
    write_mesh(path(name), ball);
  }
  PngPicture drawn(const std::vector<std::string>& arguments, const std::string& file = "out.png") const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? read_png(path(file)) : PngPicture{};
  }
  static std::vector<std::string> with(std::vector<std::string> a, const std::vector<std::string>& more) {
    a.insert(a.end(), more.begin(), more.end());
    return a;
  }
};

const std::vector<std::string> kSmallFront = {"-o",     "out.png", "--width",      "96",          "--height",      "72",
                                              "--view", "front",   "--background", "transparent", "--orthographic"};

bool is_red(const std::array<int, 4>& p) { return p[3] == 255 && p[0] > 2 * p[1] && p[0] > 2 * p[2]; }
bool is_blue(const std::array<int, 4>& p) { return p[3] == 255 && p[2] > p[0] + 40 && p[2] > p[1] + 20; }

TEST_F(PictureCommands, ObjectsHideEachOtherAndHaveTheirColors) {
  write_ball("back.ply", 1, {0, 0, 0});
  write_ball("front.ply", 0.4, {0.1, 0, 1.5});
  const std::vector<std::string> both = {"render", "back.ply", "front.ply", "--color", "red", "--color", "#2040ff"};
  const PngPicture picture = drawn(with(both, with(kSmallFront, {"--no-legend"})));
  ASSERT_EQ(picture.width, 96u);
  // The ball of radius 1 is 72 · 0.87 pixels wide.
  EXPECT_TRUE(is_blue(picture.at(51, 36))) << "the nearer one";
  EXPECT_TRUE(is_red(picture.at(48 - 22, 36))) << "beside it the other one";
  EXPECT_EQ(picture.at(2, 2)[3], 0);
  // From behind the small ball is hidden.
  std::vector<std::string> behind = with(both, with(kSmallFront, {"--no-legend"}));
  std::replace(behind.begin(), behind.end(), std::string("front"), std::string("back"));
  EXPECT_TRUE(is_red(drawn(behind).at(45, 36)));
  // A translucent ball in front shows the colour of the other.
  const auto through =
      drawn(with(both, with(kSmallFront, {"--no-legend", "--opacity", "1", "--opacity", "0.3"}))).at(51, 36);
  EXPECT_GT(through[0], picture.at(51, 36)[0] + 30);
  EXPECT_EQ(through[3], 255);
}

TEST_F(PictureCommands, ObjectsOfAllKindsStandInOnePicture) {
  write_ball("mesh.ply", 1, {-3, 0, 0});
  const TriangleMesh ball = octasphere(5);
  PointSet cloud;
  cloud.positions = cloud.normals = ball.vertices;
  write_points(path("cloud.ply"), cloud);
  cloud.origin = {3, 0, 0};
  write_points(path("other.ply"), cloud);
  ASSERT_EQ(run({"fit", "other.ply", "-o", "function.smf"}).code, 0);
  const auto arguments =
      with({"render", "mesh.ply", "cloud.ply", "function.smf", "--color", "red", "--color", "green", "--color", "blue"},
           with(kSmallFront, {"--name", "left"}));
  const auto json = json_of(arguments);
  ASSERT_EQ(json["objects"].size(), 3u);
  EXPECT_EQ(json["objects"][0]["kind"], "mesh");
  EXPECT_EQ(json["objects"][0]["name"], "left");
  EXPECT_EQ(json["objects"][1]["kind"], "points");
  EXPECT_EQ(json["objects"][2]["kind"], "function");
  EXPECT_EQ(json["objects"][2]["name"], "function.smf");
  EXPECT_EQ(json["output"]["width"], 96);
  const PngPicture picture = drawn(with(arguments, {"--no-legend"}));
  // The scene is eight wide; the balls, each two wide, are at a quarter of the frame.
  const double length = 96 * 0.87 / 8;
  const auto at = [&](double x) { return picture.at(static_cast<std::size_t>(48 + x * length), 36); };
  EXPECT_TRUE(is_red(at(-3)));
  EXPECT_GT(at(0)[1], at(0)[0] + 40) << "green";
  EXPECT_TRUE(is_blue(at(3)));
  EXPECT_EQ(at(-1.5)[3], 0);
  EXPECT_EQ(at(1.5)[3], 0);
}

TEST_F(PictureCommands, LinesAreTubesBesideOtherObjects) {
  write_ball("ball.ply", 1, {0, 0, 0});
  PolylineSet lines;
  lines.positions = {{-2, 0, 0}, {2, 0, 0}, {0, 1.5f, 0}, {0, 2, 0}};
  lines.origin = {0, 0, 0.5};
  lines.offsets = {0, 2, 4};
  lines.attributes.set("time", std::vector<float>{0, 1, 2, 3});
  write_lines(path("lines.vtp"), lines);
  const PolylineSet read = read_lines(path("lines.vtp"));
  EXPECT_EQ(read.offsets, lines.offsets);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT(norm(read.origin + Vec3(read.positions[i]) - lines.origin - Vec3(lines.positions[i])), 1e-6);
  EXPECT_EQ(read.attributes.find("time")->number(3), 3);
  EXPECT_EQ(read_lines(path("ball.ply")).size(), 0u);
  const auto json =
      json_of(with({"render", "ball.ply", "lines.vtp", "--color", "green", "--color", "red"}, kSmallFront));
  EXPECT_EQ(json["objects"][1]["kind"], "lines");
  const PngPicture picture = read_png(path("out.png"));
  // The scene is four wide: the tubes leave the ball, which hides their inner part.
  std::size_t outside = 0, inside = 0;
  for (std::size_t y = 0; y < 72; ++y)
    for (std::size_t x = 0; x < 96; ++x) {
      const auto p = picture.at(x, y);
      if (p[3] < 50 || p[0] < 2 * p[1]) continue;
      (std::abs(static_cast<int>(x) - 48) > 22 ? outside : inside) += 1;
    }
  EXPECT_GT(outside, 15u);
  EXPECT_LT(inside, 32u) << "the upright one alone";
}

TEST_F(PictureCommands, ALegendStandsBesideThePicture) {
  write_ball("a.ply", 1, {0, 0, 0});
  write_ball("b.ply", 1, {3, 0, 0});
  const std::vector<std::string> size = {"-o", "out.png", "--width", "300", "--height", "120", "--background", "white"};
  const PngPicture with_list = drawn(with({"render", "a.ply", "b.ply", "--color", "red", "--color", "blue"}, size));
  EXPECT_EQ(with_list.width, 300u);
  // The swatches of the legend, to the right of the picture, have pure colours.
  std::size_t red = 0, blue = 0;
  for (std::size_t y = 0; y < with_list.height; ++y)
    for (std::size_t x = 230; x < with_list.width; ++x) {
      const auto p = with_list.at(x, y);
      const bool swatch =
          (p[0] == 0xd6 && p[1] == 0x28 && p[2] == 0x28) || (p[0] == 0x2f && p[1] == 0x6f && p[2] == 0xde);
      if (!swatch) continue;
      (p[0] == 0xd6 ? red : blue) += 1;
    }
  EXPECT_GT(red, 40u);
  EXPECT_EQ(red, blue);
  // Without given colours, each object has its own.
  const auto json = json_of(with({"render", "a.ply", "b.ply"}, size));
  EXPECT_NE(json["objects"][0]["color"], json["objects"][1]["color"]);
}

TEST_F(PictureCommands, EveryCommandWithPicturesHasTheSameViews) {
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{{"render"},
                                                                                       {"reconstruct"},
                                                                                       {"mesh"},
                                                                                       {"csg"},
                                                                                       {"compare"},
                                                                                       {"align"},
                                                                                       {"fill"},
                                                                                       {"simplify"},
                                                                                       {"smooth"},
                                                                                       {"diagnose"},
                                                                                       {"curvature"},
                                                                                       {"deform"},
                                                                                       {"simulate"},
                                                                                       {"volume", "render"},
                                                                                       {"volume", "isosurface"},
                                                                                       {"volume", "surface"},
                                                                                       {"flow", "render"},
                                                                                       {"flow", "lines"},
                                                                                       {"flow", "surface"}}) {
    const std::string help = run(with(command, {"--help-all"})).out;
    for (const char* option : {"--width", "--view", "--z-up", "--field-of-view", "--orthographic", "--scale-bar",
                               "--look-at", "--zoom", "--look-radius", "--clip-box", "--crop"})
      EXPECT_NE(help.find(option), std::string::npos) << command.back() << " " << option;
  }
}

TEST_F(PictureCommands, TheUnitOfAScaleBarMayBeAWordOfItsOwn) {
  write_mesh(path("ball.ply"), octasphere(2));
  const std::vector<std::string> render = {"render", "ball.ply", "-o", "out.png", "--width", "200", "--orthographic"};
  const auto picture = [&](const std::vector<std::string>& bar) {
    EXPECT_EQ(run(with(render, bar)).code, 0);
    return slurp(path("out.png"));
  };
  EXPECT_TRUE(picture({"--scale-bar", "mm"}) == picture({"--scale-bar=mm"}));
  EXPECT_FALSE(picture({"--scale-bar", "mm"}) == picture({"--scale-bar"}));
  // A word that is no unit is the next input.
  EXPECT_EQ(run({"render", "-o", "out.png", "--width", "200", "--orthographic", "--scale-bar", "ball.ply"}).code, 0);
}

/// The requested width includes bars and legends.
TEST_F(PictureCommands, AllAreAsWideAsIsAsked) {
  SANSMESH_NOT_SANITIZED("pictures that other tests draw sanitized");
  write_points(path("ball.ply"), sphere(2000));
  write(kBallFile, ball_bytes());
  write("still.json", R"({"handles": [{"p": [0, 0, 0], "q": [1, 0, 0]}, {"p": [16, 16, 16]}, {"p": [16, 0, 16]}]})");
  ASSERT_EQ(run({"reconstruct", "ball.ply", "-o", "mesh.ply", "--confidence"}).code, 0);
  const std::string line = "line(0.2,0,0, 1,0,0, 9)";
  for (const auto& [command, file] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"render", "mesh.ply", "-o", "a.png", "--color-by", "confidence"}, "a.png"},
           {{"render", "mesh.ply", "ball.ply", "-o", "b.png"}, "b.png"},
           {{"render", "ball.ply", "-o", "c.png", "--surface", "apss", "--color-by", "mean", "--quick"}, "c.png"},
           {{"curvature", "ball.ply", "-o", "c.ply", "--preview", "d.png"}, "d.png"},
           {{"compare", "mesh.ply", "ball.ply", "--preview", "e.png"}, "e.png"},
           {{"volume", "render", kBallFile, "-o", "f.png"}, "f.png"},
           {{"volume", "render", kBallFile, "-o", "g.png", "--baked", "--label", "a long name", "--unit", "K"},
            "g.png"},
           {{"volume", "surface", kBallFile, "-o", "h.png", "--color-by", "mean", "--quick"}, "h.png"},
           {{"deform", kBallFile, "--handles", "still.json", "-o", "i.png"}, "i.png"},
           {{"flow", "lines", "rotation", "--seeds", line, "--duration", "1", "-o", "l.vtp", "--preview", "j.png"},
            "j.png"},
           {{"flow", "render", "rotation", "--seeds", line, "--duration", "0.2", "-o", "k.png"}, "k.png"},
           {{"align", "ball.ply", "mesh.ply", "-o", "al.ply", "--preview", "l.png"}, "l.png"}}) {
    const Outcome outcome = run(with(command, {"--width", "240", "--height", "120"}));
    ASSERT_EQ(outcome.code, 0) << command[0] << ": " << outcome.err;
    const PngPicture picture = read_png(path(file));
    EXPECT_EQ(picture.width, 240u) << file;
    EXPECT_EQ(picture.height, 120u) << file;
  }
  // The cropped parts are those of the picture, without the bar's background.
  ASSERT_EQ(run({"deform", kBallFile, "--handles", "still.json", "-o", "m.png", "--crop", "--width", "240", "--height",
                 "120"})
                .code,
            0);
  EXPECT_LT(read_png(path("m.png")).width, 240u);
}

TEST_F(PictureCommands, PreviewsLookWhereTheyAreTold) {
  // A box that is a quarter as wide when seen along its axis.
  const auto widths = [&](const std::vector<std::string>& more) {
    const auto png = drawn(with({"csg", "box(4,1,1)", "-o", "box.ply", "--preview", "out.png", "--width", "120",
                                 "--height", "60", "--crop", "--orthographic"},
                                more));
    return static_cast<double>(png.width) / static_cast<double>(png.height);
  };
  EXPECT_GT(widths({"--view", "front"}), 3);
  EXPECT_LT(widths({"--view", "right"}), 1.6);
  expect_failures(
      {{{"csg", "box(4,1,1)", "-o", "other.ply", "--zoom", "2"}, 2, {"--preview"}},
       {{"csg", "box(4,1,1)", "-o", "other.ply", "--preview", "no.png", "--crop=0,0,5000,5"}, 2, {"--crop"}}});
}

TEST_F(PictureCommands, PartsOfPictures) {
  write_ball("ball.ply", 1, {0, 0, 0});
  const PngPicture whole = drawn(with({"render", "ball.ply"}, kSmallFront));
  const PngPicture part = drawn(with({"render", "ball.ply", "--crop=10,20,30,40"}, kSmallFront));
  ASSERT_EQ(part.width, 30u);
  ASSERT_EQ(part.height, 40u);
  EXPECT_EQ(part.at(3, 4), whole.at(13, 24));
  const PngPicture content = drawn(with({"render", "ball.ply", "--crop"}, kSmallFront));
  EXPECT_EQ(drawn(with({"render", "--crop", "content", "ball.ply"}, kSmallFront)).width, content.width);
  EXPECT_NEAR(static_cast<double>(content.width), 72 * 0.87 + 2 * 2, 2);
  EXPECT_NEAR(static_cast<double>(content.height), 72 * 0.87 + 2 * 2, 2);
  EXPECT_EQ(drawn(with({"render", "ball.ply", "--crop", "content"}, kSmallFront)).width, content.width);
}

TEST_F(PictureCommands, AttributesAreColorsWithABar) {
  TriangleMesh ball = octasphere(4);
  std::vector<float> heights;
  for (const Vec3f& p : ball.vertices) heights.push_back(p.y);
  ball.attributes.set("height", heights);
  write_mesh(path("ball.ply"), ball);
  const std::vector<std::string> size = {"-o",
                                         "out.png",
                                         "--width",
                                         "240",
                                         "--height",
                                         "150",
                                         "--view",
                                         "front",
                                         "--color-by",
                                         "height",
                                         "--unit",
                                         "mm",
                                         "--value-range=-0.5,0.5",
                                         "--background",
                                         "white"};
  const PngPicture picture = drawn(with({"render", "ball.ply"}, size));
  ASSERT_EQ(picture.width, 240u);
  // Signed and symmetric: blue below, red above.
  std::size_t left = 0;
  while (left < 240 && picture.at(left, 75) == std::array<int, 4>{255, 255, 255, 255}) ++left;
  const std::size_t middle = left + 60;
  EXPECT_TRUE(is_blue(picture.at(middle, 75 + 45)));
  EXPECT_TRUE(is_red(picture.at(middle, 75 - 45)));
  const auto bare = drawn(with({"render", "ball.ply", "--no-bar"},
                               {"-o", "out.png", "--width", "240", "--height", "150", "--color-by", "height"}));
  EXPECT_EQ(bare.width, 240u);
  expect_failures({
      {{"render", "ball.ply", "-o", "no.png", "--color-by", "depth"}, 1, {"ball.ply", "depth", "height"}},
      {{"render", "ball.ply", "-o", "no.png", "--unit", "mm"}, 2, {"--unit"}},
      {{"render", "ball.ply", "-o", "no.png", "--color-range", "0,1"}, 2, {"--color-range"}},
      {{"render", "ball.ply", "-o", "no.png", "--color-by", "height", "--color-range", "1,0"}, 2, {"--color-range"}},
      {{"render", "ball.ply", "-o", "no.png", "--color", "redd"}, 2, {"--color", "redd", "green"}},
      {{"render", "ball.ply", "-o", "no.png", "--color", "red", "--color", "blue"}, 2, {"--color", "1 object"}},
      {{"render", "ball.ply", "-o", "no.png", "--opacity", "2"}, 2, {"--opacity", "0..1"}},
      {{"render", "ball.ply", "-o", "no.png", "--crop=1,2,3"}, 2, {"--crop", "1,2,3"}},
      {{"render", "ball.ply", "-o", "no.png", "--crop=1000,0,500,5"}, 2, {"--crop", "1280"}},
      {{"render", "ball.ply", "-o", "no.png", "--wire-width", "3"}, 2, {"--wire-width", "--wireframe"}},
      {{"render", "ball.ply", "-o", "no.png", "--clip-box=1,1,1,0,2,2"}, 2, {"--clip-box"}},
      {{"render", "ball.ply", "-o", "no.png", "--clip-box=7,7,7,8,8,8"}, 2, {"--clip-box"}},
      {{"render", "ball.ply", "-o", "no.png", "--scale-bar=mm"}, 2, {"--scale-bar", "--orthographic"}},
      {{"render", "ball.ply", "-o", "no.png", "--look-radius", "1"}, 2, {"--look-radius", "--look-at"}},
      {{"render", "ball.ply", "-o", "no.png", "--zoom", "0"}, 2, {"--zoom"}},
      {{"render", "ball.ply", "-o", "no.png", "--wireframe=under"}, 2, {"--wireframe"}},
      {{"render", "ball.ply", "-o", "no.png", "--frames", "4", "--crop"}, 2, {"--crop"}},
  });
}

}  // namespace
}  // namespace sansmesh::test
