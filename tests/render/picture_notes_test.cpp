#include "sansmesh/render/picture_notes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render/analytic_volumes.h"
#include "render/picture_levels.h"
#include "sansmesh/render/stroke_text.h"
#include "sansmesh/render/volume_picture.h"

namespace sansmesh {
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
  EXPECT_TRUE(letter("ж").pixels == letter("ю").pixels);  // a box for what there is not
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
  // Beyond the picture nothing happens.
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
  const Image image = beside_value_bar(Image(100, 300, kPaper), f, "velocity [m/s²]");
  EXPECT_EQ(image.width, 100 + value_bar_width(300, f, "velocity [m/s²]"));
  EXPECT_EQ(image.height, 300);
  const int x = 112;  // in the bar
  for (const double share : {0.1, 0.5, 0.9}) {
    const Rgba& p = image.at(x, static_cast<int>(240 - share * 180));
    const Vec3f c = f.color(-1 + 4 * share);
    EXPECT_NEAR(p[0], c.x, 0.01);
    EXPECT_NEAR(p[2], c.z, 0.01);
  }
  EXPECT_EQ(beside_value_bar(Image(100, 50, kPaper), f, "").width, 100);
  // Lines at marks within the range, and nowhere else; nothing of the picture itself is covered.
  const std::array<double, 2> marks{1, 7};
  const Image marked = beside_value_bar(Image(100, 300, kPaper), f, "velocity [m/s²]", marks);
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
  const Image image = beside_value_bar(red, f, "", {}, &paper);
  EXPECT_EQ(image.at(99, 290), (Rgba{1, 0, 0, 1}));
  for (int x = 100; x < image.width; ++x) EXPECT_EQ(image.at(x, 290), kPaper);
}

TEST(PictureNotes, BarOfOneValueSaysIt) {
  TransferFunction f;
  f.colors = {{3, {0.2f, 0.1f, 0.5f}}}, f.opacities = {{3, 0.5}};
  const Image image = beside_value_bar(Image(100, 300, kPaper), f, "");
  EXPECT_NEAR(image.at(112, 100)[2], 0.5, 0.01);
  double inked = 0;  // right of the bar
  for (int y = 140; y < 160; ++y)
    for (int i = 122; i < image.width; ++i) inked += 1 - static_cast<double>(image.at(i, y)[1]);
  EXPECT_GT(inked, 5);
}

TEST(PictureNotes, StandAroundTheVolumeAndLeaveItAlone) {
  const test::FormulaVolume field = test::constant_volume(0.5);
  VolumePictureOptions options;
  options.width = 220, options.height = 200, options.samples = 1;
  options.background = RenderOptions::Background::solid;
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
  EXPECT_LT(changed, covered / 40);  // where ticks touch its rim
  EXPECT_GT(inked, 500u);
  options.title = "A cube\nof one value";
  EXPECT_TRUE(picture.render(options, progress).pixels != noted.pixels);
}

}  // namespace
}  // namespace sansmesh
