#include "sansmesh/measure/color_bar.h"

#include <gtest/gtest.h>

#include <set>

#include "sansmesh/measure/distance_map.h"

namespace sansmesh {
namespace {

Image white(int width, int height) {
  Image image(width, height);
  for (auto& p : image.pixels) p = {1, 1, 1, 1};
  return image;
}

std::size_t dark(const Image& image) {
  std::size_t count = 0;
  for (const auto& p : image.pixels) count += p[0] < 0.25f && p[1] < 0.25f && p[2] < 0.25f;
  return count;
}

TEST(DrawText, EveryCharacterLooksDifferent) {
  std::set<std::vector<Rgba>> seen;
  for (const char c : std::string("0123456789+-.e ")) {
    Image image = white(5, 7);
    draw_text(image, 0, 0, 1, std::string(1, c));
    EXPECT_TRUE(seen.insert(image.pixels).second) << c;
  }
  Image image = white(40, 30);
  draw_text(image, 3, 4, 2, "1");
  EXPECT_EQ(dark(image), 4u * 10);
  EXPECT_EQ(text_width("12", 2), 22);
  EXPECT_EQ(text_width("", 2), 0);
}

TEST(DrawText, StaysInThePicture) {
  Image image = white(10, 10);
  draw_text(image, -3, -2, 3, "888888");
  draw_text(image, 9, 9, 3, "8");
  draw_text(image, 500, -500, 3, "8");
  EXPECT_EQ(image.pixels.size(), 100u);
}

TEST(ColorBar, ShowsTheColoursFromLowToHigh) {
  const ColorBar bar{.range = 0.25, .tolerance = 0.05};
  const Image image = beside_color_bar(white(640, 480), bar);
  EXPECT_EQ(image.width, 640 + color_bar_width(480, bar));
  EXPECT_EQ(image.height, 480);
  std::size_t blue = 0, red = 0;
  int lowest_red = 0, highest_blue = image.height;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto& p = image.at(x, y);
      if (p[0] > p[2] + 0.25f) ++red, lowest_red = std::max(lowest_red, y);
      if (p[2] > p[0] + 0.25f) ++blue, highest_blue = std::min(highest_blue, y);
    }
  EXPECT_GT(red, 500u);
  EXPECT_GT(blue, 500u);
  EXPECT_LT(lowest_red, highest_blue);
  EXPECT_GT(dark(image), 500u);
  // Nothing of the picture is covered.
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < 640; ++x) ASSERT_EQ(image.at(x, y)[0], 1);

  const Image one_side = beside_color_bar(white(640, 480), {.range = 2, .both_sides = false});
  for (const auto& p : one_side.pixels) ASSERT_LE(p[2], p[0] + 0.25f);
  EXPECT_EQ(beside_color_bar(white(50, 50), {}).width, 50);
  EXPECT_GT(dark(beside_color_bar(white(640, 480), {.range = 0})), 100u);
}

TEST(ColorBar, Numbers) {
  EXPECT_EQ(scale_number(0.125, true), "+0.125");
  EXPECT_EQ(scale_number(-1.5e-7, true), "-1.5e-07");
  EXPECT_EQ(scale_number(0, true), "0");
  EXPECT_EQ(scale_number(3, false), "3");
}

}  // namespace
}  // namespace sansmesh
