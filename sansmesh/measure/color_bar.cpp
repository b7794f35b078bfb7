#include "sansmesh/measure/color_bar.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sansmesh/measure/distance_map.h"

namespace sansmesh {
namespace {

constexpr Rgba kInk{from_byte(32), from_byte(36), from_byte(43), 1};
constexpr int kWide = 5, kHigh = 7;  // of a glyph
constexpr int kLowest = 100;         // picture that gets a bar

/// Rows from top to bottom, the highest of five bits on the left.
struct Glyph {
  char character;
  std::array<std::uint8_t, kHigh> rows;
};

constexpr Glyph kGlyphs[] = {
    {'0', {0b01110, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110}},
    {'1', {0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110}},
    {'2', {0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111}},
    {'3', {0b11110, 0b00001, 0b00001, 0b01110, 0b00001, 0b00001, 0b11110}},
    {'4', {0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010}},
    {'5', {0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110}},
    {'6', {0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110}},
    {'7', {0b11111, 0b00001, 0b00010, 0b00100, 0b00100, 0b01000, 0b01000}},
    {'8', {0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110}},
    {'9', {0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100}},
    {'+', {0b00000, 0b00100, 0b00100, 0b11111, 0b00100, 0b00100, 0b00000}},
    {'-', {0b00000, 0b00000, 0b00000, 0b11111, 0b00000, 0b00000, 0b00000}},
    {'.', {0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b01100, 0b01100}},
    {'e', {0b00000, 0b00000, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110}},
};

struct Tick {
  double where;  ///< 0 at the lower end, 1 at the upper
  std::string label;
};

/// Sizes in pixels for a picture of some height.
struct Layout {
  int dot, line, gap, thick, high, widest = 0;
  double low;
  std::vector<Tick> ticks;

  Layout(int height, const ColorBar& bar)
      : dot(std::max(1, static_cast<int>(std::lround(height / 480.0)))),
        line(std::max(1, dot / 2)),
        gap(4 * dot),
        thick(12 * dot),
        high(static_cast<int>(0.6 * height) / 2 * 2 + 1),
        low(bar.both_sides ? -bar.range : 0) {
    for (int k = 0; k <= 4; ++k) {
      const double where = 0.25 * k, value = low + where * (bar.range - low);
      ticks.push_back({where, scale_number(value, bar.both_sides)});
      widest = std::max(widest, text_width(ticks.back().label, dot));
      if (!(bar.range > 0)) break;
    }
  }
};

/// Pixels [x0, x1) × [y0, y1), as far as they lie in the picture.
void fill(Image& image, int x0, int y0, int x1, int y1, const Rgba& color) {
  for (int y = std::max(0, y0); y < std::min(image.height, y1); ++y)
    for (int x = std::max(0, x0); x < std::min(image.width, x1); ++x) image.at(x, y) = color;
}

}  // namespace

int text_width(const std::string& text, int dot) {
  return text.empty() ? 0 : dot * (static_cast<int>(text.size()) * (kWide + 1) - 1);
}

void draw_text(Image& image, int x, int y, int dot, const std::string& text) {
  for (const char c : text) {
    for (const Glyph& glyph : kGlyphs) {
      if (glyph.character != c) continue;
      for (int j = 0; j < kHigh; ++j)
        for (int i = 0; i < kWide; ++i)
          if (glyph.rows[static_cast<std::size_t>(j)] >> (kWide - 1 - i) & 1)
            fill(image, x + i * dot, y + j * dot, x + (i + 1) * dot, y + (j + 1) * dot, kInk);
    }
    x += (kWide + 1) * dot;
  }
}

std::string scale_number(double value, bool with_sign) {
  const std::string text = fmt::format("{:.4g}", value);
  return with_sign && value > 0 ? "+" + text : text;
}

int color_bar_width(int height, const ColorBar& bar) {
  if (height < kLowest) return 0;
  const Layout layout(height, bar);
  return layout.thick + layout.widest + 5 * layout.gap;
}

Image beside_color_bar(const Image& picture, const ColorBar& bar) {
  if (picture.height < kLowest || picture.width < 1) return picture;
  Image image(picture.width + color_bar_width(picture.height, bar), picture.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) image.at(x, y) = picture.at(std::min(x, picture.width - 1), y);

  const Layout layout(picture.height, bar);
  const auto& [dot, line, gap, thick, high, widest, low, ticks] = layout;
  const int x0 = picture.width + gap, x1 = x0 + thick, right = x1 + 2 * gap + widest;
  const int y0 = (image.height - high) / 2, y1 = y0 + high;
  fill(image, x0 - line, y0 - line, x1 + line, y1 + line, kInk);
  const auto row_of = [&](double where) { return y1 - 1 - static_cast<int>(std::lround(where * (high - 1))); };
  for (int y = y0; y < y1; ++y) {
    const double value = low + (y1 - 1 - y) / (high - 1.0) * (bar.range - low);
    const auto [r, g, b] = distance_color(static_cast<float>(value), bar.range);
    fill(image, x0, y, x1, y + 1, {from_byte(r), from_byte(g), from_byte(b), 1});
  }
  for (const Tick& t : ticks) {
    const int y = row_of(t.where);
    fill(image, x1, y - line / 2, x1 + gap, y - line / 2 + line, kInk);
    draw_text(image, right - text_width(t.label, dot), y - kHigh * dot / 2, dot, t.label);
  }
  if (!bar.tolerance || !(*bar.tolerance < bar.range)) return image;
  for (const double value : {-*bar.tolerance, *bar.tolerance}) {
    if (value < low) continue;
    const int y = row_of((value - low) / (bar.range - low));
    fill(image, x0, y - line / 2, x1, y - line / 2 + line, kInk);
  }
  return image;
}

}  // namespace sansmesh
