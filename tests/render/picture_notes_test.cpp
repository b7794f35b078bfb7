#include "sansmesh/render/annotate/picture_notes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render/analytic_volumes.h"
#include "render/picture_levels.h"
#include "sansmesh/render/annotate/stroke_text.h"
#include "sansmesh/render/volume/volume_picture.h"

namespace sansmesh::inline v1 {
namespace {

constexpr Rgba kPaper{1, 1, 1, 1}, kBlack{0, 0, 0, 1};

double ink_of(const Image& image) {
  double sum = 0;
  for (const Rgba& p : image.pixels) sum += 1 - static_cast<double>(p[1]);
  return sum;
}

Image letter(std::string_view text) {
  Image image(40, 40, kPaper);
  draw_strokes(image, 10, 28, 18, text, kBlack);
  return image;
}

TEST(StrokeText, EveryCharacterDiffersFromEveryOther) {
  std::vector<std::pair<std::string, Image>> seen;
  for (char c = '!'; c <= '~'; ++c) seen.emplace_back(std::string(1, c), letter(std::string(1, c)));
  for (const char* c : {"°", "±", "²", "³", "µ", "·", "×", "−"}) seen.emplace_back(c, letter(c));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_GT(ink_of(seen[i].second), 1) << seen[i].first;
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_TRUE(seen[i].second.pixels != seen[k].second.pixels) << seen[i].first << ' ' << seen[k].first;
  }
  EXPECT_TRUE(letter("ж").pixels == letter("ю").pixels);  // a box for unsupported characters
  EXPECT_EQ(ink_of(letter(" ")), 0);
}

TEST(StrokeText, InkGrowsWithSizeAndStaysWithinItsWidth) {
  for (const double height : {9.0, 18.0, 36.0}) {
    Image image(400, 80, kPaper);
    draw_strokes(image, 20, 60, height, "Wq0", kBlack);
    int right = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        if (image.at(x, y)[1] < 0.9f) {
          right = std::max(right, x);
          EXPECT_GE(x, 17);
          EXPECT_GT(y, 60 - height - 0.2 * height);
          EXPECT_LT(y, 60 + 0.5 * height);
        }
    EXPECT_NEAR(right, 20 + stroke_width("Wq0", height), 0.12 * height + 1.5);
  }
  // Drawing beyond the picture has no effect.
  Image image(10, 10, kPaper);
  draw_strokes(image, -500, 1e6, 20, "far", kBlack);
  draw_line(image, std::nan(""), 0, 5, 5, 1, kBlack);
  EXPECT_EQ(ink_of(image), 0);
  draw_line(image, -1e5, 5, 1e5, 5, 2, kBlack);
  EXPECT_NEAR(ink_of(image), 20, 1e-3);
}

TEST(RoundTicks, AreRoundAndWithin) {
  for (const auto& [a, b] : {std::pair{0.0, 255.0}, {-3.7, 2.2}, {1e-9, 7e-9}, {-1e12, 4e12}, {0.19, 4.98}}) {
    const std::vector<double> ticks = round_ticks(a, b, 5);
    ASSERT_GE(ticks.size(), 3u);
    ASSERT_LE(ticks.size(), 9u);
    const double step = ticks[1] - ticks[0], mantissa = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
    EXPECT_TRUE(std::abs(mantissa - 1) < 1e-6 || std::abs(mantissa - 2) < 1e-6 || std::abs(mantissa - 5) < 1e-6)
        << step;
    EXPECT_GE(ticks.front(), a - 1e-9 * step);
    EXPECT_LE(ticks.back(), b + 1e-9 * step);
    EXPECT_LT(ticks.front() - a, step);
    EXPECT_LT(b - ticks.back(), step);
  }
  EXPECT_TRUE(round_ticks(1, 1, 5).empty());
  EXPECT_EQ(tick_text(0.25, 0.05), "0.25");
  EXPECT_EQ(tick_text(-40, 20), "−40");
  EXPECT_EQ(tick_text(0, 20), "0");
  EXPECT_EQ(tick_text(1.5e-7, 5e-8), "1.5e−7");
  EXPECT_EQ(tick_text(2e6, 1e6), "2e6");
}

TEST(PictureNotes, BarShowsTheColoursInOrder) {
  TransferFunction f;
  f.colors = {{-1, {0.2f, 0.1f, 0.5f}}, {3, {0.9f, 0.8f, 0.1f}}};
  f.opacities = {{-1, 0}, {3, 1}};
  const Image image = with_color_bar(Image(100, 300, kPaper), f, "velocity [m/s²]");
  EXPECT_EQ(image.width, 100 + color_bar_width(300, f, "velocity [m/s²]"));
  EXPECT_EQ(image.height, 300);
  const int x = 112;  // in the bar
  for (const double share : {0.1, 0.5, 0.9}) {
    const Rgba& p = image.at(x, static_cast<int>(240 - share * 180));
    const Vec3f c = f.color(-1 + 4 * share);
    EXPECT_NEAR(p[0], c.x, 0.01);
    EXPECT_NEAR(p[2], c.z, 0.01);
  }
  EXPECT_EQ(with_color_bar(Image(100, 50, kPaper), f, "").width, 100);
  // Lines only at marks within the range; the picture itself is not covered.
  const std::array<double, 2> marks{1, 7};
  const Image marked = with_color_bar(Image(100, 300, kPaper), f, "velocity [m/s²]", marks);
  for (int y = 0; y < 300; ++y) {
    const bool differs = marked.at(x, y) != image.at(x, y);
    EXPECT_EQ(differs, std::abs(y + 0.5 - 150) < 1.5) << y;
    for (int i = 0; i < 100; ++i) ASSERT_EQ(marked.at(i, y), kPaper);
  }
}

TEST(PictureNotes, BarStandsOnPaperWhateverReachesTheRim) {
  TransferFunction f;
  f.colors = {{-1, {0.2f, 0.1f, 0.5f}}, {3, {0.9f, 0.8f, 0.1f}}};
  f.opacities = {{-1, 0}, {3, 1}};
  const Image red(100, 300, Rgba{1, 0, 0, 1}), paper(100, 300, kPaper);
  const Image image = with_color_bar(red, f, "", {}, &paper);
  EXPECT_EQ(image.at(99, 290), (Rgba{1, 0, 0, 1}));
  for (int x = 100; x < image.width; ++x) EXPECT_EQ(image.at(x, 290), kPaper);
}

TEST(PictureNotes, BarOfOneValueSaysIt) {
  TransferFunction f;
  f.colors = {{3, {0.2f, 0.1f, 0.5f}}}, f.opacities = {{3, 0.5}};
  const Image image = with_color_bar(Image(100, 300, kPaper), f, "");
  EXPECT_NEAR(image.at(112, 100)[2], 0.5, 0.01);
  double inked = 0;  // right of the bar
  for (int y = 140; y < 160; ++y)
    for (int i = 122; i < image.width; ++i) inked += 1 - static_cast<double>(image.at(i, y)[1]);
  EXPECT_GT(inked, 5);
}

TEST(PictureNotes, StandAroundTheVolumeAndLeaveItAlone) {
  const test::FormulaVolume field = test::constant_volume(0.5);
  VolumePictureOptions options;
  options.picture.view.width = 220, options.picture.view.height = 200, options.picture.quality.samples = 1;
  options.picture.look.background = Background::solid({1, 1, 1});
  options.transfer = TransferFunction{"", {{0, {1, 0, 0}}, {1, {1, 0, 0}}}, {{0, 0.99}, {1, 0.99}}};
  options.shading = false;
  Progress progress;
  const VolumePicture picture({&field, nullptr, nullptr, {}}, progress);
  const Image plain = picture.render(options, progress);
  options.axes = options.color_bar = true;
  options.unit = "mm", options.color_title = "T [K]";
  const Image noted = picture.render(options, progress);
  EXPECT_GT(noted.width, plain.width);
  std::size_t covered = 0, changed = 0, inked = 0;
  for (int y = 0; y < plain.height; ++y)
    for (int x = 0; x < plain.width; ++x) {
      const bool differs = test::levels(plain.at(x, y)) != test::levels(noted.at(x, y));
      if (test::levels(plain.at(x, y))[1] < 10) {
        ++covered, changed += differs;
      } else {
        inked += differs;
      }
    }
  EXPECT_GT(covered, 5000u);
  EXPECT_LT(changed, covered / 40);  // where ticks touch its border
  EXPECT_GT(inked, 500u);
  options.title = "A cube\nof one value";
  EXPECT_TRUE(picture.render(options, progress).pixels != noted.pixels);
}

TEST(ValueBar, EndsArePointedWhereThereIsMore) {
  TransferFunction f;
  f.colors = {{0, {1, 0, 0}}, {1, {0, 0, 1}}};
  f.opacities = {{0, 1}, {1, 1}};
  const Image paper(60, 200, kPaper);
  const Image plain = with_color_bar(paper, f, {}), above = with_color_bar(paper, f, {}, {}, nullptr, {false, true}),
              both = with_color_bar(paper, f, {}, {}, nullptr, {true, true});
  EXPECT_EQ(above.width, plain.width);
  const auto colored = [](const Image& image, int first, int last) {
    int count = 0;
    for (int y = first; y < last; ++y)
      for (int x = 60; x < image.width; ++x) count += std::abs(image.at(x, y)[0] - image.at(x, y)[2]) > 0.5f;
    return count;
  };
  // The bar extends from a fifth to four fifths of the height.
  EXPECT_EQ(colored(plain, 0, 39), 0);
  EXPECT_EQ(colored(plain, 161, 200), 0);
  EXPECT_GT(colored(above, 0, 39), 15);
  EXPECT_EQ(colored(above, 161, 200), 0);
  EXPECT_GT(colored(both, 161, 200), 15);
  EXPECT_EQ(colored(above, 45, 155), colored(plain, 45, 155));
}

TEST(ScaleBar, IsAsLongAsItSays) {
  // A picture with a width of 8 in the world, 10 pixels per unit.
  Camera camera;
  camera.parallel = true;
  camera.right = {1, 0, 0}, camera.up = {0, 1, 0}, camera.backward = {0, 0, 1};
  camera.half_width = 0.5f, camera.half_height = 0.4f;
  for (const double length : {1.0, 0.1}) {
    Image image(800, 640, kPaper);
    draw_scale_bar(image, {{0, 0, 0}, 8}, camera, length, "mm");
    int first = 800, last = 0;
    for (int x = 0; x < 800; ++x)
      if (image.at(x, 640 - static_cast<int>(1.4 * 640 / 52.0))[1] < 0.6f)
        first = std::min(first, x), last = std::max(last, x);
    EXPECT_NEAR(last - first, 200, 4) << "2 of 8, or 0.2 of 0.8";
  }
  // In perspective there is no single scale.
  camera.parallel = false;
  Image image(800, 640, kPaper);
  draw_scale_bar(image, {{0, 0, 0}, 8}, camera, 1, "mm");
  EXPECT_EQ(ink_of(image), 0);
}

TEST(ScaleBar, CanBeReadOnLinesAndEdges) {
  Camera camera;
  camera.parallel = true;
  camera.right = {1, 0, 0}, camera.up = {0, 1, 0}, camera.backward = {0, 0, 1};
  camera.half_width = 0.5f, camera.half_height = 0.4f;
  Image image(800, 640, kPaper);
  for (int y = 0; y < 640; ++y)
    for (int x = 0; x < 800; x += 4) image.at(x, y) = kBlack;
  const Image before = image;
  draw_scale_bar(image, {{0, 0, 0}, 8}, camera, 1, "mm");
  const int y = 640 - static_cast<int>(1.9 * 640 / 52.0);  // between the bar and its length
  for (int x = 24; x < 200; x += 4) EXPECT_GT(image.at(x, y)[1], 0.7f) << x;
  EXPECT_EQ(image.at(400, y), before.at(400, y));
}

TEST(PictureNotes, WhatReachesTheEdgeDoesNotGoOnBesideThePicture) {
  RenderOptions options;
  options.view.width = 60, options.view.height = 120;
  const Image red(60, 120, Rgba{1, 0, 0, 1});
  const std::vector<LegendEntry> some = {{{0, 0, 1}, "a"}};
  for (const bool clear : {false, true}) {
    if (clear) options.look.background = Background::transparent();
    const Image paper = annotation_background(options);
    const Image list = with_legend(red, some, &paper);
    ASSERT_GT(list.width, 60);
    EXPECT_EQ(list.at(59, 3), red.at(59, 3));
    EXPECT_EQ(list.at(list.width - 1, 3), paper.at(0, 3));
    EXPECT_EQ(paper.at(0, 3)[3], clear ? 0 : 1);
    if (!clear) EXPECT_NEAR(paper.at(0, 3)[0], paper.at(0, 3)[2], 0.1) << "gray";
  }
}

TEST(Legend, NamesTooLongEndInDots) {
  const std::vector<LegendEntry> some = {{{1, 0, 0}, "a"}, {{0, 0, 1}, std::string(200, 'W')}};
  const Image paper(300, 200, kPaper);
  const Image list = with_legend(paper, some);
  EXPECT_EQ(list.width, 300 + legend_width(200, some));
  EXPECT_LT(legend_width(200, some), 200);
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 300; ++x) ASSERT_EQ(list.at(x, y), kPaper) << "beside, not on the picture";
  EXPECT_EQ(legend_width(99, some), 0);
}

TEST(PictureNotes, TitlesCanBeReadOnWhateverIsBehindThem) {
  for (const float behind : {0.05f, 0.95f}) {
    Image image(400, 300, Rgba{1 - behind, 1 - behind, 1 - behind, 1});
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 400; ++x) image.at(x, y) = {behind, behind, behind, 1};
    draw_title(image, "MMMM");
    float apart = 0;
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 400; ++x) apart = std::max(apart, std::abs(image.at(x, y)[1] - behind));
    EXPECT_GT(apart, 0.6f) << behind;
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
